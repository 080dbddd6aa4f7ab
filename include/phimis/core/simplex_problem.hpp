// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_SIMPLEX_PROBLEM_HPP
#define PHIMIS_CORE_SIMPLEX_PROBLEM_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/mixture_sums.hpp>
#include <phimis/core/row_parts.hpp>

#include <cmath>
#include <cstddef>
#include <type_traits>

namespace phimis {

/// The map between fractions α with floors, frozen techniques, scaled pdfs and the plain simplex of the solver.
///
///     α = fixed + free · τ,   fixed_k: the floor, or the fraction of a frozen technique;   free = 1 − Σ fixed
///     β_k = α_k / Σ_l α_l/κ_l,   x_j = Σ β_k y_kj:   the mixture of κ_k p_k in the shares a_k ∝ α_k/κ_k
///
/// The fractions that respect the floors are a simplex whose corners are fixed + free · e_k. In the shares of the corners,
/// θ, floors are θ ≥ 0, and columns are mixtures at the corners: no solver has to know of floors.
///
/// Shapes   all[m]; θ has one coordinate for each technique that is not frozen.
class floored_simplex {
 public:
  PHIMIS_HOST_DEVICE static constexpr int doubles(int m) noexcept { return 3 * m; }

  /// kappa[m] stays the caller's.
  PHIMIS_HOST_DEVICE floored_simplex(int m, const double* kappa, double* memory, int* coordinates) noexcept
      : m_(m), kappa_(kappa), fixed_(memory), norm_(memory + m), beta_(memory + 2 * m), technique_(coordinates) {}

  /// held(k): whether a technique cannot move; fixed(k): its floor, or where it is held.
  template <class Held, class Fixed>
  PHIMIS_HOST_DEVICE void constrain(const Held& held, const Fixed& fixed) noexcept {
    free_ = 1;
    size_ = 0;
    double base = 0;
    for (int k = 0; k < m_; ++k) {
      fixed_[k] = static_cast<double>(fixed(k));
      free_ -= fixed_[k];
      base += fixed_[k] / kappa_[k];
      if (!held(k)) technique_[size_++] = k;
    }
    if (free_ < 0) free_ = 0;
    floored_ = base > 0;
    for (int i = 0; i < size_; ++i) norm_[i] = base + free_ / kappa_[technique_[i]];
  }

  PHIMIS_HOST_DEVICE int size() const noexcept { return size_; }
  PHIMIS_HOST_DEVICE double free() const noexcept { return free_; }
  PHIMIS_HOST_DEVICE bool has_freedom() const noexcept { return size_ > 1 && free_ > 0; }
  PHIMIS_HOST_DEVICE int technique(int i) const noexcept { return technique_[i]; }
  /// fixed[m], or null where all are 0.
  PHIMIS_HOST_DEVICE const double* fixed() const noexcept { return floored_ ? fixed_ : nullptr; }
  /// β[m] of the last θ.
  PHIMIS_HOST_DEVICE const double* beta() const noexcept { return beta_; }

  /// θ_i = τ_i norm_i / Σ_l α_l/κ_l of fractions, which are raised to the floors.
  template <class Fractions>
  PHIMIS_HOST_DEVICE void to_theta(const Fractions& alpha, double* theta) const noexcept {
    double sum = 0;
    for (int i = 0; i < size_; ++i) {
      const double above = static_cast<double>(alpha[technique_[i]]) - fixed_[technique_[i]];
      theta[i] = above > 0 ? above * norm_[i] : 0;
      sum += theta[i];
    }
    for (int i = 0; i < size_; ++i) theta[i] = sum > 0 ? theta[i] / sum : 1.0 / size_;
  }

  /// β of θ.
  PHIMIS_HOST_DEVICE void at(const double* theta) noexcept {
    double sum = 0;
    for (int i = 0; i < size_; ++i) sum += theta[i] / norm_[i];
    for (int k = 0; k < m_; ++k) beta_[k] = floored_ ? fixed_[k] * sum : 0;
    for (int i = 0; i < size_; ++i) beta_[technique_[i]] += free_ * theta[i] / norm_[i];
  }

  /// α_k of θ; exactly the floor where θ is 0. False, and nothing is written, where κ is so wide that there is none.
  template <class Fractions>
  [[nodiscard]] PHIMIS_HOST_DEVICE bool to_fractions(const double* theta, Fractions& alpha) const noexcept {
    double sum = 0;
    for (int i = 0; i < size_; ++i) sum += theta[i] / norm_[i];
    if (!(sum > 0) || !is_finite(sum)) return false;
    for (int i = 0; i < size_; ++i) {
      const int k = technique_[i];
      using real = std::remove_reference_t<decltype(alpha[k])>;
      alpha[k] = static_cast<real>(fixed_[k] + free_ * (theta[i] / norm_[i] / sum));
    }
    return true;
  }

  /// The gradient in θ of a gradient in β.
  PHIMIS_HOST_DEVICE void pull_back(const double* raw, double* gradient) const noexcept {
    double base = 0;
    for (int k = 0; k < m_ && floored_; ++k) base += fixed_[k] * raw[k];
    for (int i = 0; i < size_; ++i) gradient[i] = (base + free_ * raw[technique_[i]]) / norm_[i];
  }

  /// The Hessian in θ over a support of one in β, whose last row is that of `fixed` where there is one.
  PHIMIS_HOST_DEVICE void pull_back(const double* raw, const int* support, int size, double* hessian) const noexcept {
    const int order = size + (floored_ ? 1 : 0);
    for (int a = 0; a < size; ++a) {
      for (int b = 0; b < size; ++b) {
        double value = free_ * free_ * raw[a * order + b];
        if (floored_) value += free_ * (raw[a * order + size] + raw[b * order + size]) + raw[size * order + size];
        hessian[a * size + b] = value / (norm_[support[a]] * norm_[support[b]]);
      }
    }
  }

 private:
  int m_;
  int size_ = 0;
  bool floored_ = false;
  double free_ = 1;
  const double* kappa_;
  double* fixed_;
  double* norm_;
  double* beta_;
  int* technique_;
};

/// What a divergence asks for on rows, with a prior: the problem that `simplex_newton` solves.
///
///     min Σ_j w_j x_j φ(unit u_j/x_j) + prior · Σ_k a_k φ(mean π_k/a_k) + price · Σ_k c_k a_k,   a_k = β_k/κ_k
///
/// Shapes   kappa[m]; prior shares π[m], on the simplex, in the coordinates a; costs[m].
template <class Divergence, class Real>
class divergence_on_simplex {
 public:
  static constexpr bool convex = true;
  static constexpr bool may_vanish = !has_exponent<Divergence>::value;
  PHIMIS_HOST_DEVICE static constexpr int doubles(int m) noexcept { return 2 * m + 1 + (m + 1) * (m + 1); }

  PHIMIS_HOST_DEVICE divergence_on_simplex(const Divergence& divergence, const column_pointers<Real>& rows,
                                           floored_simplex& on, const double* kappa, bool normalised, double unit,
                                           double mean, double prior, const double* prior_shares, double* memory,
                                           int* indices) noexcept
      : divergence_(divergence),
        rows_(rows),
        on_(on),
        kappa_(kappa),
        normalised_(normalised),
        unit_(unit),
        mean_(mean),
        scale_(scale_beside(prior)),
        prior_(scale_ * prior),
        shares_(prior_shares),
        lambda_(memory),
        raw_(lambda_ + 1),
        raw_sizes_(raw_ + rows.m),
        hessian_(raw_sizes_ + rows.m),
        techniques_(indices) {}

  /// Adds price · Σ_k c_k a_k to the objective.
  PHIMIS_HOST_DEVICE void charge(double price, const Real* costs) noexcept {
    price_ = scale_ * price;
    costs_ = costs;
  }

  /// Reads one block of rows in so many: a coarse problem, whose solution is a start.
  PHIMIS_HOST_DEVICE void read_every(int every) noexcept { every_ = every; }

  PHIMIS_HOST_DEVICE double power() const noexcept {
    if (price_ > 0) return 0;
    if constexpr (has_exponent<Divergence>::value) {
      return divergence_.exponent();
    } else {
      return 0;
    }
  }

  PHIMIS_HOST_DEVICE double gradient(const double* theta, double* gradient, double* sizes) noexcept {
    on_.at(theta);
    with_mixture_sums(divergence_, rows_, on_.beta(), unit_, normalised_, every_,
                      [&](const auto& sums) { sums.gradient(lambda_); });
    for (int i = 0; i < 2 * rows_.m + 1 && scale_ < 1; ++i) lambda_[i] *= scale_;
    const double weight = prior_ / every_;
    for (int k = 0; k < rows_.m && weight > 0; ++k) {
      const double a = on_.beta()[k] / kappa_[k];
      const score<double> s = prior_score(divergence_, mean_, shares_[k], a);
      raw_[k] += weight * s.value / kappa_[k];
      raw_sizes_[k] += weight * std::fabs(s.value) / kappa_[k];
      *lambda_ += weight * a * std::fabs(s.value);
    }
    for (int k = 0; k < rows_.m && price_ > 0; ++k) raw_[k] -= price_ * static_cast<double>(costs_[k]) / kappa_[k];
    on_.pull_back(raw_, gradient);
    on_.pull_back(raw_sizes_, sizes);
    return *lambda_;
  }

  PHIMIS_HOST_DEVICE void hessian(const int* support, int size, double* hessian) noexcept {
    for (int a = 0; a < size; ++a) techniques_[a] = on_.technique(support[a]);
    with_mixture_sums(divergence_, rows_, on_.beta(), unit_, normalised_, every_,
                      [&](const auto& sums) { sums.hessian(techniques_, size, on_.fixed(), hessian_); });
    const int order = size + (on_.fixed() != nullptr ? 1 : 0);
    for (int i = 0; i < order * order && scale_ < 1; ++i) hessian_[i] *= scale_;
    add_prior(size);
    on_.pull_back(hessian_, support, size, hessian);
  }

  /// The unit in which the largest |s| at θ is near 1: powers of f/p then neither overflow nor vanish.
  PHIMIS_HOST_DEVICE void choose_unit(const double* theta) noexcept {
    if (power() == 0) return;
    const double reference = ratio(theta, power() > 0);
    if (reference > 0 && is_finite(1 / reference)) {
      unit_ /= reference;
      mean_ /= reference;
    }
    if (prior_ > 0) limit_mean<Real>(unit_, mean_, power() < 0);
  }

  /// The largest f/p at θ, or the smallest that is not 0, in the unit.
  PHIMIS_HOST_DEVICE double ratio(const double* theta, bool largest) noexcept {
    on_.at(theta);
    double found = 0;
    with_mixture_sums(divergence_, rows_, on_.beta(), unit_, normalised_, every_,
                      [&](const auto& sums) { found = sums.reference(largest); });
    return found;
  }

 private:
  PHIMIS_HOST_DEVICE void add_prior(int size) noexcept {
    if (!(prior_ > 0)) return;
    const double* const fixed = on_.fixed();
    const int order = size + (fixed != nullptr ? 1 : 0);
    for (int k = 0; k < rows_.m; ++k) {
      const double a = on_.beta()[k] / kappa_[k];
      if (!(a > 0)) continue;
      const double curvature =
          prior_ / every_ * prior_score(divergence_, mean_, shares_[k], a).slope / a / (kappa_[k] * kappa_[k]);
      int at = -1;
      for (int i = 0; i < size; ++i) {
        if (techniques_[i] == k) at = i;
      }
      if (at >= 0) hessian_[at * order + at] += curvature;
      if (fixed == nullptr) continue;
      hessian_[size * order + size] += fixed[k] * fixed[k] * curvature;
      if (at < 0) continue;
      hessian_[at * order + size] += fixed[k] * curvature;
      hessian_[size * order + at] += fixed[k] * curvature;
    }
  }

  const Divergence& divergence_;
  const column_pointers<Real>& rows_;
  floored_simplex& on_;
  const double* kappa_;
  bool normalised_;
  double unit_;
  double mean_;
  double scale_;  // of the whole objective
  double prior_;
  double price_ = 0;
  int every_ = 1;
  const Real* costs_ = nullptr;
  const double* shares_;
  double* lambda_;  // and what `gradient` of the sums writes behind it
  double* raw_;
  double* raw_sizes_;
  double* hessian_;
  int* techniques_;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_SIMPLEX_PROBLEM_HPP
