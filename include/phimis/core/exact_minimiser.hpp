// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_EXACT_MINIMISER_HPP
#define PHIMIS_CORE_EXACT_MINIMISER_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/minimise_rows.hpp>
#include <phimis/core/pack.hpp>
#include <phimis/core/pair_sums.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/solve_pair.hpp>
#include <phimis/core/table.hpp>

#include <cstddef>
#include <type_traits>

namespace phimis {

/// The fractions that minimise a divergence on all observations ever made, solved to a KKT certificate.
///
///     min_α Σ_j (p_j/q_j) φ(g_j/p_j) + prior · D(π, α),   α_k ≥ floor_k,   Σ α_k = 1
///
/// Table     where rows are kept: fixed_table, or table, which grows.
/// Requires  two techniques; each observation with the density q_j that it was drawn from, however long ago.
/// Errors    `status()`; `residual()` is the KKT residual relative to λ, 0 where a score steps across zero within the last
///           digit of α.
/// Cost      an update reads all rows once for each evaluation of `solve_pair` and once more, with one division a row.
///
/// Source T Eqs. 16, 18, 25; design: bracketed Newton on a monotone function, end points first.
template <class Divergence, class Table>
class exact_minimiser : public rule_base<typename Table::real, 2> {
  static_assert(Table::techniques == 2, "exact_minimiser solves for two techniques");

 public:
  using Real = typename Table::real;

  PHIMIS_HOST_DEVICE exact_minimiser() noexcept : exact_minimiser(Divergence{}) {}
  PHIMIS_HOST_DEVICE explicit exact_minimiser(const Divergence& divergence, const rule_options<Real, 2>& options = {},
                                              phimis::control_variate variate = control_variate::on) noexcept
      : rule_base<Real, 2>(options), divergence_(divergence), variate_(variate) {}

  PHIMIS_HOST_DEVICE const Divergence& divergence() const noexcept { return divergence_; }
  PHIMIS_HOST_DEVICE const Table& table() const noexcept { return table_; }
  PHIMIS_HOST_DEVICE double residual() const noexcept { return residual_; }
  PHIMIS_HOST_DEVICE int evaluations() const noexcept { return evaluations_; }

  PHIMIS_HOST_DEVICE void observe(const observation<Real, 2>& sample) {
    row<Real, 2> row;
    if (!this->admit(sample, row)) return;
    if (local && sample.f < 0) row.u = -row.u;  // V[F] is the one objective that f and |f| do not share
    keep(row);
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    if (zeros_ && infinite_at_zero(divergence_)) {
      return this->status_ = rule_status::infinite_divergence;
    }
    if (!(largest_ > 0)) return this->status_ = rule_status::no_information;
    const prepared on = prepare();
    if (!(on.mass[0] > 0) || !(on.mass[1] > 0)) return this->status_ = rule_status::no_information;

    // The solver's fractions are those of the normalised pdfs: a_k ∝ α_k/κ_k.
    const double floor1 = static_cast<double>(this->options_.floors[0]);
    const double floor2 = static_cast<double>(this->options_.floors[1]);
    const pair_fractions low = to_solver(on, floor1, 1 - floor1);
    const pair_fractions high = to_solver(on, 1 - floor2, floor2);
    const pair_fractions start = to_solver(on, this->fractions_);
    const pair_fractions prior = to_solver(on, this->options_.start);
    const problem evaluate{*this, on, prior};
    constexpr double rounding = static_cast<double>(epsilon<Real>);
    const pair_solution solution =
        solve_pair(evaluate, low, high, start, 4 * rounding, local ? objective::any : objective::convex);
    evaluations_ = solution.evaluations;
    residual_ = solution.residual;
    // A step of s that crosses zero within the last digit of α is a root of a φ with a kink.
    const bool converged = residual_ <= 1e4 * rounding;
    if (!converged && detail::is_kinked<Divergence>::value && solution.bracketed) residual_ = 0;

    if (solution.alpha.first == low.first && solution.alpha.second == low.second) {
      set_fractions(floor1, 1 - floor1);
    } else if (solution.alpha.first == high.first && solution.alpha.second == high.second) {
      set_fractions(1 - floor2, floor2);
    } else {
      const double first = solution.alpha.first * on.kappa[0];
      const double second = solution.alpha.second * on.kappa[1];
      set_fractions(first / (first + second), second / (first + second));
    }
    if (!converged && residual_ > 0) return this->status_ = rule_status::not_converged;
    return this->status_ = local ? rule_status::local : rule_status::updated;
  }

  /// Adds the observations of another state; fractions stay until the next update.
  PHIMIS_HOST_DEVICE void merge(const exact_minimiser& other) {
    this->counters_.merge(other.counters_);
    const std::ptrdiff_t theirs = other.table_.size();  // `other` may be this
    for (std::ptrdiff_t j = 0; j < theirs; ++j) keep(other.table_[j]);
  }

 private:
  PHIMIS_HOST_DEVICE void keep(const row<Real, 2>& row) {
    if (!table_.push(row)) {
      ++this->counters_.dropped;
      return;
    }
    const Real size = row.u < 0 ? -row.u : row.u;
    if (size > largest_) largest_ = size;
    if (!(size > 0)) zeros_ = true;
  }

  struct prepared {
    double mass[2];   // Σ_j p_kj/q_j
    double kappa[2];  // 1, or n/mass: what each pdf is multiplied by
    double unit;      // multiplies u
    double mean;      // Σ_j f_j/q_j / n in that unit
  };

  /// Terms of the masses and of the mean.
  struct mass_terms {
    static constexpr bool packed = true;
    columns<Real, 2> rows;
    Real inverse;

    template <class V>
    PHIMIS_HOST_DEVICE void add(std::ptrdiff_t j, V (&sums)[3]) const noexcept {
      const V w = detail::load<V>(rows.w + j);
      sums[0] += w * detail::load<V>(rows.y[0] + j);
      sums[1] += w * detail::load<V>(rows.y[1] + j);
      sums[2] += w * (detail::load<V>(rows.u + j) * inverse);
    }
  };

  /// Sums over rows at a point, and the prior's two rows: one for each technique, in which only it has density.
  struct problem {
    const exact_minimiser& rule;
    const prepared& on;
    pair_fractions prior;

    PHIMIS_HOST_DEVICE pair_sums operator()(const pair_fractions& at) const noexcept {
      const pair_point<Real> point{{static_cast<Real>(at.first), static_cast<Real>(at.second)},
                                   {static_cast<Real>(on.kappa[0]), static_cast<Real>(on.kappa[1])},
                                   static_cast<Real>(on.unit),
                                   static_cast<double>(rule.table_.size()),
                                   rule.variate_ == control_variate::on};
      pair_sums sums = sum_pair(rule.divergence_, rule.table_.view(), point);
      const double weight = static_cast<double>(rule.options_.prior);
      if (weight > 0) {
        const auto s1 = prior_score(prior.first, at.first);
        const auto s2 = prior_score(prior.second, at.second);
        sums.zeta += weight * (s1.value - s2.value);
        if (s1.slope > 0) sums.slope += weight * s1.slope / at.first;
        if (s2.slope > 0) sums.slope += weight * s2.slope / at.second;
        sums.lambda += weight * (at.first * (s1.value < 0 ? -s1.value : s1.value) +
                                 at.second * (s2.value < 0 ? -s2.value : s2.value));
      }
      return sums;
    }

    /// Of a technique with the share π of the start, at the share α; s(0) where the start has none.
    PHIMIS_HOST_DEVICE score<double> prior_score(double pi, double alpha) const noexcept {
      const double t = on.mean * pi / alpha;
      if constexpr (local) {
        return pi > 0 ? score_at(chi_squared{}, t) : score<double>{0, 0};
      } else {
        return pi > 0 ? score_at(rule.divergence_, t) : score<double>{score_at_zero(rule.divergence_), 0};
      }
    }
  };

  PHIMIS_HOST_DEVICE prepared prepare() noexcept {
    const columns<Real, 2> rows = table_.view();
    constexpr Real smallest = 4 * smallest_normal<Real>;
    const Real inverse = 1 / (largest_ > smallest ? largest_ : smallest);
    double total[3] = {};
    detail::sum_rows<3, Real>(rows.n, mass_terms{rows, inverse}, total);
    const double n = static_cast<double>(rows.n);
    prepared on{{total[0], total[1]}, {1, 1}, static_cast<double>(inverse), total[2] / n};
    if (variate_ == control_variate::on) {
      for (int k = 0; k < 2; ++k) on.kappa[k] = n / on.mass[k];
    }
    if (needs_mean()) {
      on.unit /= on.mean;
      on.mean = 1;
    }
    return on;
  }

  /// Only powers of t are free of the unit of f; the others want t = g/p, g = f/μ̂.
  PHIMIS_HOST_DEVICE bool needs_mean() const noexcept {
    if constexpr (local) {
      return false;
    } else if constexpr (has_exponent<Divergence>::value) {
      return divergence_.exponent() == 0;
    } else {
      return true;
    }
  }

  PHIMIS_HOST_DEVICE static pair_fractions to_solver(const prepared& on,
                                                     const phimis::fractions<Real, 2>& of) noexcept {
    return to_solver(on, static_cast<double>(of[0]), static_cast<double>(of[1]));
  }
  PHIMIS_HOST_DEVICE static pair_fractions to_solver(const prepared& on, double first, double second) noexcept {
    const double a1 = first / on.kappa[0];
    const double a2 = second / on.kappa[1];
    return {a1 / (a1 + a2), a2 / (a1 + a2)};
  }

  PHIMIS_HOST_DEVICE void set_fractions(double first, double second) noexcept {
    this->fractions_[0] = static_cast<Real>(first);
    this->fractions_[1] = static_cast<Real>(second);
  }

  static constexpr bool local = std::is_same<Divergence, multi_sample_variance>::value;

  Divergence divergence_;
  phimis::control_variate variate_;
  Table table_{};
  Real largest_ = 0;  // |u|
  bool zeros_ = false;
  double residual_ = 0;
  int evaluations_ = 0;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_EXACT_MINIMISER_HPP
