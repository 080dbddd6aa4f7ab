// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ANALYSIS_PROBLEM_HPP
#define PHIMIS_ANALYSIS_PROBLEM_HPP

#include <phimis/core/fractions.hpp>
#include <phimis/core/observation.hpp>
#include <phimis/error.hpp>
#include <phimis/interval.hpp>
#include <phimis/quadrature/panels.hpp>
#include <phimis/solver/table.hpp>
#include <phimis/technique/technique_set.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace phimis::analysis {

/// Whether a technique promises that its pdf integrates to one.
enum class normalisation { required, defective };

/// An integrand and M techniques on a bounded domain of the real line, tabulated at quadrature nodes: the oracle that
/// estimates are held against.
///
/// The nodes are those of a Gauss–Kronrod rule on panels that resolve f, every p_k, f²/p and p_k²f²/p³ of the equal
/// mixture to 1e-14. To the rules a node is an observation drawn with density 1/weight, so what minimises a divergence
/// on samples minimises it here.
///
/// Errors std::invalid_argument where a pdf is negative, not finite, or does not integrate to one within 1e-9 while
///        that is required; where f is not finite or 0 everywhere.
template <int M>
class problem {
 public:
  using pdfs = per_technique<double, M>;

  template <class Integrand, class Techniques>
  problem(Integrand integrand, Techniques techniques, interval domain, std::vector<double> breakpoints = {},
          normalisation promise = normalisation::required)
      : f_(integrand),
        pdfs_([techniques](double x) { return techniques.pdfs(x); }),
        domain_(domain),
        breakpoints_(std::move(breakpoints)) {
    static_assert(Techniques::techniques == M);
    tabulate();
    for (int k = 0; k < M; ++k) {
      const double mass = integral([k](double, const pdfs& p, double) { return p[k]; }).value;
      if (promise == normalisation::required) {
        require(std::fabs(mass - 1) <= 1e-9, "pdf " + std::to_string(k + 1), "must integrate to 1 over the domain",
                mass);
      } else {
        missing_[k] = 1 - mass;
      }
    }
    require(size_.value > 0, "integrand", "must not be 0 everywhere; its integral", size_.value);
  }

  /// The same problem with more breakpoints.
  problem split_at(const std::vector<double>& more) const {
    problem split = *this;
    split.breakpoints_.insert(split.breakpoints_.end(), more.begin(), more.end());
    split.tabulate();
    return split;
  }

  /// The same problem on panels that resolve one more function of f and the pdfs.
  problem refined_for(std::function<double(double, const pdfs&)> also) const {
    problem refined = *this;
    refined.also_ = std::move(also);
    refined.tabulate();
    return refined;
  }

  double f(double x) const { return f_(x); }
  pdfs pdfs_at(double x) const { return pdfs_(x); }
  const interval& domain() const noexcept { return domain_; }

  /// μ = ∫ f dx
  measured mean() const noexcept { return mean_; }

  /// 1 − ∫ p_k dx of each technique: the samples that are lost; 0 where pdfs promise to be normalised.
  const pdfs& missing_mass() const noexcept { return missing_; }

  /// ∫ |f| dx: what divergences divide by.
  double size() const noexcept { return size_.value; }

  /// ∫ h(f(x), pdfs(x), x) dx, with the difference to the embedded Gauss rule, and rounding, as its error.
  template <class Function>
  measured integral(const Function& h) const {
    constexpr double rounding = 4e-16;
    double sum = 0;
    double absolute = 0;
    double difference = 0;
    for (std::size_t panel = 0; panel < values_.size(); panel += kronrod_nodes().size()) {
      double coarse = 0;
      double fine = 0;
      for (std::size_t i = panel; i < panel + kronrod_nodes().size(); ++i) {
        const double value = h(values_[i], all_pdfs_[i], nodes_[i]);
        fine += weights_[i] * value;
        coarse += gauss_weights_[i] * value;
        absolute += weights_[i] * std::fabs(value);
      }
      sum += fine;
      difference += std::fabs(fine - coarse);
    }
    return {sum, difference + rounding * absolute};
  }

  /// The nodes as rows of a rule.
  table<double, M> rows() const {
    return rows_of(weights_, [](double, double u) { return u; });
  }

  /// The nodes as rows in which u has the sign of f.
  table<double, M> signed_rows() const { return signed_rows_of(weights_); }

  /// The same with the weights of the embedded Gauss rule: what it makes of a result tells the error of quadrature.
  table<double, M> embedded_rows() const { return signed_rows_of(gauss_weights_); }

  const std::vector<double>& nodes() const noexcept { return nodes_; }

 private:
  table<double, M> signed_rows_of(const std::vector<double>& weights) const {
    return rows_of(weights, [](double f, double u) { return std::copysign(u, f); });
  }

  template <class Adjust>
  table<double, M> rows_of(const std::vector<double>& weights, const Adjust& adjust) const {
    table<double, M> rows;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!(weights[i] > 0)) continue;
      observation<double, M> node{values_[i], all_pdfs_[i], 1 / weights[i], 0};
      row<double, M> row;
      if (!to_row(node, row)) continue;
      row.u = adjust(values_[i], row.u);
      rows.push(row);
    }
    return rows;
  }

  void tabulate() {
    const auto shapes = [&](double x) {
      const double value = f_(x);
      const pdfs p = pdfs_(x);
      std::array<double, 2 * M + 4> values{};
      double mixture = 0;
      for (int k = 0; k < M; ++k) {
        require(!(p[k] < 0), "pdf " + std::to_string(k + 1), "must not be negative; it is at x", x);
        mixture += p[k] / M;
      }
      const double square = mixture > 0 ? value * value / mixture : 0;
      for (std::size_t k = 0; k < M; ++k) {
        const double share = mixture > 0 ? p[static_cast<int>(k)] / mixture : 0;
        values[k] = p[static_cast<int>(k)];
        values[M + k] = share * share * square;
      }
      values[2 * M] = value;
      values[2 * M + 1] = square;
      values[2 * M + 2] = std::fabs(value);  // a kink where f changes sign
      if (also_) values[2 * M + 3] = also_(value, p);
      return values;
    };
    const std::vector<double> edges = smooth_panels(shapes, domain_, breakpoints_);
    nodes_.clear();
    weights_.clear();
    gauss_weights_.clear();
    values_.clear();
    all_pdfs_.clear();
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      const double half = (edges[i + 1] - edges[i]) / 2;
      const double middle = edges[i] + half;
      for (const kronrod_node& node : kronrod_nodes()) {
        const double x = middle + half * node.x;
        nodes_.push_back(x);
        weights_.push_back(half * node.weight);
        gauss_weights_.push_back(half * node.gauss_weight);
        values_.push_back(f_(x));
        all_pdfs_.push_back(pdfs_(x));
      }
    }
    mean_ = integral([](double value, const pdfs&, double) { return value; });
    size_ = integral([](double value, const pdfs&, double) { return std::fabs(value); });
  }

  std::function<double(double)> f_;
  std::function<pdfs(double)> pdfs_;
  std::function<double(double, const pdfs&)> also_;
  interval domain_;
  std::vector<double> breakpoints_;
  std::vector<double> nodes_;
  std::vector<double> weights_;
  std::vector<double> gauss_weights_;
  std::vector<double> values_;
  std::vector<pdfs> all_pdfs_;
  pdfs missing_{};
  measured mean_{};
  measured size_{};
};

template <class Integrand, technique... Techniques>
problem(Integrand, technique_set<Techniques...>, interval) -> problem<sizeof...(Techniques)>;
template <class Integrand, technique... Techniques>
problem(Integrand, technique_set<Techniques...>, interval, std::vector<double>) -> problem<sizeof...(Techniques)>;
template <class Integrand, technique... Techniques>
problem(Integrand, technique_set<Techniques...>, interval, std::vector<double>, normalisation)
    -> problem<sizeof...(Techniques)>;

}  // namespace phimis::analysis

#endif  // PHIMIS_ANALYSIS_PROBLEM_HPP
