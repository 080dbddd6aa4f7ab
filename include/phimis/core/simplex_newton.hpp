// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_SIMPLEX_NEWTON_HPP
#define PHIMIS_CORE_SIMPLEX_NEWTON_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/limits.hpp>

#include <cmath>

namespace phimis {

/// How well a point of the simplex satisfies the conditions of optimality.
///
///     G_k = ν where θ_k > 0,   G_k ≤ ν where θ_k = 0,   ν = Σ θ_k G_k
struct simplex_solution {
  double lambda = 0;                   ///< the scale of G
  double residual = infinity<double>;  ///< the largest violation on all coordinates, over λ
  double gap = infinity<double>;  ///< max_k G_k − ν, over λ: a convex objective is within gap · λ of its minimum
  int iterations = 0;
  int evaluations = 0;
};

/// Memory of the solver for m coordinates: what a caller without a heap puts on its stack.
PHIMIS_HOST_DEVICE constexpr int simplex_doubles(int m) noexcept { return (2 * m + 9) * m; }
PHIMIS_HOST_DEVICE constexpr int simplex_indices(int m) noexcept { return 2 * m; }

/// Newton's method on the simplex {θ ≥ 0, Σ θ = 1} with an active set that drops and takes back coordinates.
///
/// Each iteration minimises the quadratic model on the simplex: coordinates that the model would make negative are
/// dropped, dropped ones with a positive multiplier are taken back, until neither is left. The step ends where the
/// slope of the objective along it has not turned; for a convex objective that is descent without a value. Where no
/// quadratic step descends, and at the opening, the multiplicative step θ_k ← θ_k (G_k/ν)^{1/β} is taken, which never
/// ascends. The model is regularised in the scale of its diagonal, so that duplicate and silent coordinates, and fewer
/// rows than coordinates, leave it solvable.
///
/// Problem   double gradient(const double* θ, double* G): writes G = −∇, returns its scale λ, and keeps θ;
///           void hessian(const int* support, int size, double* H): H[size][size] there, positive semi-definite if convex;
///           double power(): β, or 0 where the multiplicative step is not known to descend;
///           convex: a constant; if false, double value() there.
/// Source    the outer method is that of Kim, Carbonetto, Stephens & Anitescu 2020 for γ = 1; here for every score, with
///           block pivoting inside (Portugal, Júdice & Vicente 1994) and without evaluating the objective.
/// Errors    none; the residual tells.
/// Cost      an iteration: one gradient or a few, one Hessian over the support, O(m³).
template <class Problem>
class simplex_newton {
 public:
  PHIMIS_HOST_DEVICE simplex_newton(Problem& on, int m, double* memory, int* indices) noexcept
      : on_(on),
        m_(m),
        gradient_(memory),
        trial_(gradient_ + m),
        trial_gradient_(trial_ + m),
        step_(trial_gradient_ + m),
        best_(step_ + m),
        rhs_(best_ + m),
        ones_(rhs_ + m),
        scale_(ones_ + m),
        target_(scale_ + m),
        hessian_(target_ + m),
        factor_(hessian_ + m * m),
        support_(indices),
        free_(indices + m) {}

  /// Moves θ to a minimum, with so many multiplicative steps at first. Stops at the tolerance, or above it where rounding
  /// stops all progress.
  [[gnu::noinline]] PHIMIS_HOST_DEVICE simplex_solution minimise(double* theta, double tolerance,
                                                                 int opening = 2) noexcept {
    simplex_solution now;
    if (!enter(theta, now)) return now;
    simplex_solution best;
    int stale = 0;
    constexpr int most = 500;
    for (; now.iterations < most; ++now.iterations) {
      certify(theta, now);
      stale = now.residual < best.residual / 2 ? 0 : stale + 1;
      if (now.residual < best.residual) {
        best = now;
        for (int k = 0; k < m_; ++k) best_[k] = theta[k];
      }
      const bool at_rounding = best.residual <= 1e4 * tolerance && stale >= 3;
      if (best.residual <= tolerance || at_rounding || m_ == 1) break;
      const bool opens = now.iterations < opening && on_.power() > 0;
      if (!opens && newton_step(theta, now)) continue;
      if (!multiplicative_step(theta, now)) break;
    }
    for (int k = 0; k < m_; ++k) theta[k] = best_[k];
    best.iterations = now.iterations;
    best.evaluations = now.evaluations;
    return best;
  }

 private:
  PHIMIS_HOST_DEVICE bool evaluate(const double* at, double* gradient, simplex_solution& now) noexcept {
    ++now.evaluations;
    const double lambda = on_.gradient(at, gradient);
    bool finite = is_finite(lambda);
    for (int k = 0; k < m_; ++k) finite = finite && is_finite(gradient[k]);
    if (finite) now.lambda = lambda;
    return finite;
  }

  /// The first evaluation: a start where the objective is infinite moves inwards.
  PHIMIS_HOST_DEVICE bool enter(double* theta, simplex_solution& now) noexcept {
    for (int attempt = 0; attempt < 60; ++attempt) {
      if (evaluate(theta, gradient_, now)) return true;
      for (int k = 0; k < m_; ++k) theta[k] = (theta[k] + 1.0 / m_) / 2;
    }
    return false;
  }

  PHIMIS_HOST_DEVICE void certify(const double* theta, simplex_solution& now) noexcept {
    nu_ = mean_of(theta, gradient_);
    double worst = 0;
    double above = 0;
    for (int k = 0; k < m_; ++k) {
      const double excess = gradient_[k] - nu_;
      if (excess > above) above = excess;
      const double violation = theta[k] > 0 ? std::fabs(excess) : excess;
      if (violation > worst) worst = violation;
    }
    const double scale = now.lambda > 0 ? now.lambda : 1;
    now.residual = worst / scale;
    now.gap = above / scale;
  }

  PHIMIS_HOST_DEVICE static double larger(double a, double b) noexcept { return a > b ? a : b; }

  PHIMIS_HOST_DEVICE bool newton_step(double* theta, simplex_solution& now) noexcept {
    size_ = 0;
    for (int k = 0; k < m_; ++k) {
      if (theta[k] > 0 || gradient_[k] > nu_) support_[size_++] = k;
    }
    on_.hessian(support_, size_, hessian_);
    // Each coordinate in the scale of its own curvature; a flat one in that of the most curved.
    double most_curved = 0;
    for (int a = 0; a < size_; ++a) most_curved = larger(most_curved, std::fabs(hessian_[a * size_ + a]));
    if (!(most_curved > 0)) most_curved = 1;
    for (int a = 0; a < size_; ++a) {
      const double curvature = std::fabs(hessian_[a * size_ + a]);
      scale_[a] = 1 / std::sqrt(is_finite(1 / curvature) ? curvature : most_curved);
    }
    for (int k = 0; k < m_; ++k) step_[k] = 0;
    // A model that is nearly flat may fail to descend; the less it is trusted, the surer it does.
    for (least_delta_ = 1e-12; least_delta_ < 1e3; least_delta_ *= 1e3) {
      if (quadratic_step(theta) && search(theta, now)) return true;
    }
    return false;
  }

  /// The step to the minimum of the quadratic model on the simplex: step_. False where it does not descend.
  PHIMIS_HOST_DEVICE bool quadratic_step(const double* theta) noexcept {
    double* const d = target_;  // of each in the support
    int count = 0;
    for (int a = 0; a < size_; ++a) {
      d[a] = -theta[support_[a]];
      free_[count++] = a;
    }
    const int block_passes = 8;
    const int most = block_passes + 3 * size_;
    for (int pass = 0; pass < most; ++pass) {
      double multiplier = 0;
      if (count == 0 || !solve_free(count, d, multiplier)) return false;
      const bool single = pass >= block_passes;
      // Drop what is negative.
      int kept = 0;
      int worst = -1;
      for (int i = 0; i < count; ++i) {
        const int a = free_[i];
        if (theta[support_[a]] + d[a] < 0 &&
            (worst < 0 || theta[support_[a]] + d[a] < theta[support_[worst]] + d[worst])) {
          worst = a;
        }
      }
      for (int i = 0; i < count; ++i) {
        const int a = free_[i];
        if (single ? a == worst : theta[support_[a]] + d[a] < 0) {
          d[a] = -theta[support_[a]];
        } else {
          free_[kept++] = a;
        }
      }
      if (kept < count) {
        count = kept;
        continue;
      }
      // Take back what the model would raise.
      int best = -1;
      double most_wanted = 0;
      const int before = count;
      for (int a = 0; a < size_; ++a) {
        bool is_free = false;
        for (int i = 0; i < before && !is_free; ++i) is_free = free_[i] == a;
        if (is_free) continue;
        double wish = gradient_[support_[a]] - nu_ - multiplier;
        for (int b = 0; b < size_; ++b) wish -= hessian_[a * size_ + b] * d[b];
        if (!(wish > 1e-14 * std::fabs(nu_))) continue;
        if (single) {
          if (wish * scale_[a] > most_wanted) {
            most_wanted = wish * scale_[a];
            best = a;
          }
        } else {
          free_[count++] = a;
        }
      }
      if (best >= 0) free_[count++] = best;
      if (count == before) break;
    }
    double slope = 0;
    for (int a = 0; a < size_; ++a) {
      const int k = support_[a];
      step_[k] = d[a] < -theta[k] ? -theta[k] : d[a];
      slope += step_[k] * (gradient_[k] - nu_);
    }
    return slope > 0;
  }

  /// Solves the model on the free coordinates, the others at 0: (H_FF + δ) d_F = G_F − ν − H_FD d_D − multiplier, Σ d = 0.
  PHIMIS_HOST_DEVICE bool solve_free(int count, double* d, double& multiplier) noexcept {
    double moved = 0;
    for (int a = 0; a < size_; ++a) moved += d[a];
    for (int i = 0; i < count; ++i) moved -= d[free_[i]];
    for (int i = 0; i < count; ++i) d[free_[i]] = 0;
    for (int i = 0; i < count; ++i) {
      const int a = free_[i];
      double value = gradient_[support_[a]] - nu_;
      for (int b = 0; b < size_; ++b) {
        if (d[b] != 0) value -= hessian_[a * size_ + b] * d[b];
      }
      rhs_[i] = value * scale_[a];
      ones_[i] = scale_[a];
    }
    double delta = least_delta_;
    while (!factorise(count, delta)) {
      delta *= delta < 1e-3 ? 1000 : 3;  // rounding needs little, a model that is not convex some
      if (delta > 1e30) return false;
    }
    solve(count, rhs_);
    solve(count, ones_);
    double sum = 0;
    double total = 0;
    for (int i = 0; i < count; ++i) {
      sum += rhs_[i] * scale_[free_[i]];
      total += ones_[i] * scale_[free_[i]];
    }
    multiplier = (sum + moved) / total;
    for (int i = 0; i < count; ++i) d[free_[i]] = (rhs_[i] - multiplier * ones_[i]) * scale_[free_[i]];
    return is_finite(multiplier);
  }

  /// Cholesky's factor of the scaled model, row by row.
  PHIMIS_HOST_DEVICE bool factorise(int count, double delta) noexcept {
    for (int i = 0; i < count; ++i) {
      const int a = free_[i];
      for (int j = 0; j <= i; ++j) {
        const int b = free_[j];
        double value = hessian_[a * size_ + b] * scale_[a] * scale_[b] + (i == j ? delta : 0);
        for (int l = 0; l < j; ++l) value -= factor_[i * m_ + l] * factor_[j * m_ + l];
        if (i != j) {
          factor_[i * m_ + j] = value / factor_[j * m_ + j];
        } else if (value > delta / 16 && is_finite(value)) {
          factor_[i * m_ + i] = std::sqrt(value);
        } else {
          return false;
        }
      }
    }
    return true;
  }

  PHIMIS_HOST_DEVICE void solve(int count, double* x) const noexcept {
    for (int i = 0; i < count; ++i) {
      for (int l = 0; l < i; ++l) x[i] -= factor_[i * m_ + l] * x[l];
      x[i] /= factor_[i * m_ + i];
    }
    for (int i = count - 1; i >= 0; --i) {
      for (int l = i + 1; l < count; ++l) x[i] -= factor_[l * m_ + i] * x[l];
      x[i] /= factor_[i * m_ + i];
    }
  }

  /// The slope of −objective along step_; Σ step is 0 but for rounding, which the mean of G would multiply.
  PHIMIS_HOST_DEVICE double slope_along(const double* at, const double* gradient) const noexcept {
    const double mean = mean_of(at, gradient);
    double slope = 0;
    for (int k = 0; k < m_; ++k) slope += (gradient[k] - mean) * step_[k];
    return slope;
  }

  /// Σ θ_k G_k
  PHIMIS_HOST_DEVICE double mean_of(const double* theta, const double* gradient) const noexcept {
    double mean = 0;
    for (int k = 0; k < m_; ++k) mean += theta[k] * gradient[k];
    return mean;
  }

  /// Goes along step_ as far as the slope does not turn by more than a tenth.
  PHIMIS_HOST_DEVICE bool search(double* theta, simplex_solution& now) noexcept {
    const double start = slope_along(theta, gradient_);
    double value = 0;
    if constexpr (!Problem::convex) value = on_.value();
    double noise = 0;
    for (int k = 0; k < m_; ++k) noise += 32 * epsilon<double> * now.lambda * std::fabs(step_[k]);
    double length = 1;
    for (int attempt = 0; attempt < 40; ++attempt) {
      double sum = 0;
      for (int k = 0; k < m_; ++k) {
        trial_[k] = theta[k] + length * step_[k];
        if (trial_[k] < 0 || (length == 1 && step_[k] == -theta[k])) trial_[k] = 0;
        sum += trial_[k];
      }
      for (int k = 0; k < m_; ++k) trial_[k] /= sum;
      const bool finite = evaluate(trial_, trial_gradient_, now);
      const double slope = finite ? slope_along(trial_, trial_gradient_) : -infinity<double>;
      bool descends = finite && slope >= -0.1 * start - noise;
      if constexpr (!Problem::convex) {
        descends = finite && on_.value() <= value + 1e-14 * now.lambda;
      }
      if (descends) {
        for (int k = 0; k < m_; ++k) {
          theta[k] = trial_[k];
          gradient_[k] = trial_gradient_[k];
        }
        return true;
      }
      // The secant of the slopes; where the objective soars towards the end of the step, that says too little.
      const double secant = finite && slope < 0 ? length * start / (start - slope) : 0;
      const double least = (attempt < 2 ? 0.6 : 0.1) * length;
      const double largest = 0.9 * length;
      length = secant < least ? least : secant > largest ? largest : secant;
    }
    return false;
  }

  PHIMIS_HOST_DEVICE bool multiplicative_step(double* theta, simplex_solution& now) noexcept {
    const double beta = on_.power();
    if (!(beta > 0) || !(nu_ > 0)) return false;
    double sum = 0;
    for (int k = 0; k < m_; ++k) {
      trial_[k] = theta[k] > 0 ? theta[k] * std::pow(gradient_[k] / nu_, 1 / beta) : 0;
      sum += trial_[k];
    }
    if (!(sum > 0) || !is_finite(sum)) return false;
    for (int k = 0; k < m_; ++k) trial_[k] /= sum;
    if (!evaluate(trial_, trial_gradient_, now)) return false;
    for (int k = 0; k < m_; ++k) {
      theta[k] = trial_[k];
      gradient_[k] = trial_gradient_[k];
    }
    return true;
  }

  Problem& on_;
  int m_;
  double* gradient_;
  double* trial_;
  double* trial_gradient_;
  double* step_;
  double* best_;
  double* rhs_;
  double* ones_;
  double* scale_;   // of each in the support: 1/√H_aa
  double* target_;  // step of each in the support
  double* hessian_;
  double* factor_;
  int* support_;
  int* free_;  // positions in the support
  int size_ = 0;
  double least_delta_ = 0;
  double nu_ = 0;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_SIMPLEX_NEWTON_HPP
