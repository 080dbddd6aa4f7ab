// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ESTIMATOR_CONTROL_FIT_HPP
#define PHIMIS_ESTIMATOR_CONTROL_FIT_HPP

#include <phimis/core/estimator.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/value.hpp>
#include <phimis/estimator/control_coefficients.hpp>
#include <phimis/solver/least_squares.hpp>

#include <cmath>
#include <cstdint>

namespace phimis {

/// Whether coefficients are drawn to those that change nothing, as far as samples leave them open.
enum class shrinkage { on, off };

/// The coefficients that are best at given fractions α, by weighted least squares on samples of any batches.
///
///     min_β Σ_j (f_j − Σ_k β_k p_kj)² / (q_j p(α, x_j))
///
/// the sample's picture of the variance of one sample at α, ∫ (f − β·p)²/p(α) dx. At q_j = p(α, x_j) it is the regression
/// of f/q on p/q, whose normal equations are those of Optimal MIS (`optimal_mis`); at the α that minimises it, too, it is
/// joint optimisation (`joint_minimiser`). Since Σ α_k p_k/p(α) = 1 a regression needs no constant.
///
/// - A technique with α_k = 0 is left out: where only it has density no sample would subtract its pdf.
/// - Where samples hardly tell pdfs apart, a narrow lobe that none of them met may: a large δ_k would then ruin what meets it.
///   With shrinkage β = c α + δ, and δ is drawn to 0 by up to one sample a technique: by the share of the spread of f/p(α) that
///   the regression leaves. Where pdfs span f, that is nothing.
/// - With fewer than `least` = 4M samples β is 0, as too noisy to help; and for good after a lost sample (f = 0 where every
///   pdf is 0), which shows that pdfs are defective.
///
/// Source   Owen & Zhou 2000; Kondapaneni et al. 2019, Eqs. of the direct estimator; He & Owen 2014.
/// Errors   none. A value that is not finite enters as 0, as in every estimate; a sample whose pdfs or q are no densities is
///          left out. Whatever is collinear, duplicates, columns of zeros, is left to the solution of least norm.
template <class Value, int M>
class control_fit {
  using real = typename value_traits<Value>::real;

 public:
  static constexpr int least = 4 * M;

  explicit control_fit(const fractions<double, M>& alpha) noexcept : alpha_(alpha) {}

  void add(const Value& f, const per_technique<double, M>& pdfs, double q) {
    double sum = 0;
    for (int k = 0; k < M; ++k) {
      if (!is_density(pdfs[k])) return;
      sum += pdfs[k];
    }
    if (!is_density(q) || !is_finite(sum)) return;
    const bool finite = value_traits<Value>::finite(f);
    if (!(q > 0) || !(sum > 0)) {
      if (finite && !(value_traits<Value>::magnitude(f) > 0)) ++lost_;
      return;
    }
    // In units of Σp, as rows of rules are.
    per_technique<double, M + 1> x{};
    for (int k = 0; k < M; ++k) {
      x[k] = alpha_[k] > 0 ? pdfs[k] / sum : 0;
      x[M] += alpha_[k] * x[k];
    }
    const double root = std::sqrt(sum / q / x[M]);
    if (!(x[M] > 0) || !is_finite(root)) return;  // what α does not reach is nothing to it
    for (int k = 0; k <= M; ++k) x[k] *= root;
    const Value y = f * static_cast<real>(root / sum);
    rows_.add(x, finite && value_traits<Value>::finite(y) ? y : value_traits<Value>::zero());
  }

  /// Adds the samples of another fit at the same fractions, or close to them.
  void merge(const control_fit& other) {
    rows_.merge(other.rows_);
    lost_ += other.lost_;
  }

  std::int64_t samples() const noexcept { return rows_.rows(); }
  std::int64_t lost() const noexcept { return lost_; }

  control_coefficients<Value, M> solve(shrinkage shrink = shrinkage::on) const {
    if (samples() < least || lost_ > 0) return {};
    per_technique<bool, M + 1> all_but_constant{};
    per_technique<bool, M + 1> only_constant{};
    for (int k = 0; k < M; ++k) only_constant[k] = true;
    all_but_constant[M] = true;
    auto found = rows_.solve(all_but_constant);
    control_coefficients<Value, M> control{.rank = found.rank, .residual_norm = found.residual_norm};
    const real left = value_traits<Value>::magnitude(found.residual_norm);
    if (shrink == shrinkage::on && left > 0) {
      const real spread = value_traits<Value>::magnitude(rows_.solve(only_constant).residual_norm);
      least_squares<Value, M + 1> shrunk = rows_;
      for (int k = 0; k < M; ++k) {
        per_technique<double, M + 1> x{};
        x[k] = spread > left ? static_cast<double>(left / spread) : 1;
        shrunk.add(x, value_traits<Value>::zero());
      }
      found = shrunk.solve();
    }
    for (int k = 0; k < M; ++k) {
      control.beta[k] = found.beta[k] + found.beta[M] * static_cast<real>(alpha_[k]);
      if (!value_traits<Value>::finite(control.beta[k])) return {};
    }
    return control;
  }

 private:
  fractions<double, M> alpha_;
  least_squares<Value, M + 1> rows_;  // the last column is the constant
  std::int64_t lost_ = 0;
};

/// Standard error of an estimate whose β was fitted to its own n samples: that of the samples' spread, times
/// √((n − 1)/(n − rank)) for what the fit took of it; unknown with no more samples than coefficients.
template <class Value, int M>
Value fitted_standard_error(const estimator<Value, M>& of, sampling_model model, int rank) {
  using real = typename value_traits<Value>::real;
  const double n = static_cast<double>(of.samples());
  if (rank <= 1) return of.standard_error(model);
  if (!(n > rank)) return value_traits<Value>::unknown();
  return of.standard_error(model) * static_cast<real>(std::sqrt((n - 1) / (n - rank)));
}

/// Degrees of freedom of that standard error: of n − 1 the fit took rank − 1.
template <class Value, int M>
double fitted_degrees_of_freedom(const estimator<Value, M>& of, sampling_model model, int rank) {
  const double n = static_cast<double>(of.samples());
  const double own = static_cast<double>(of.degrees_of_freedom(model));
  if (rank <= 1) return own;
  return n > rank ? own * (n - rank) / (n - 1) : 0;
}

}  // namespace phimis

#endif  // PHIMIS_ESTIMATOR_CONTROL_FIT_HPP
