// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_SIMPLEX_NEWTON_HPP
#define PHIMIS_CORE_SIMPLEX_NEWTON_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/simplex_model.hpp>

#include <cmath>

namespace phimis {

/// How well a point of the simplex satisfies the conditions of optimality.
///
///     G_k = ν where θ_k > 0,   G_k ≤ ν where θ_k = 0,   ν = Σ θ_k G_k
struct simplex_solution {
  double lambda = 0;                   ///< the scale of G
  double residual = infinity<double>;  ///< the largest violation on all coordinates, over λ, or S_k if that is larger
  double gap = infinity<double>;  ///< max_k G_k − ν, over λ: a convex objective is within gap · λ of its minimum
  int iterations = 0;
  int evaluations = 0;
};

/// Memory of the solver for m coordinates: what a caller without a heap puts on its stack.
PHIMIS_HOST_DEVICE constexpr int simplex_doubles(int m) noexcept {
  return (m + 9) * m + detail::simplex_model::doubles(m);
}
PHIMIS_HOST_DEVICE constexpr int simplex_indices(int m) noexcept { return 3 * m; }

/// Newton's method on the simplex {θ ≥ 0, Σ θ = 1} with an active set that drops and takes back coordinates.
///
/// Each iteration goes to the minimum of the quadratic model on the simplex, as far as the slope of the objective along
/// the way has not turned; for a convex objective that is descent without a value. Where no such step descends, and at the
/// opening, the multiplicative step θ_k ← θ_k (G_k/ν)^{1/β} is taken, which never ascends.
///
/// Problem   double gradient(const double* θ, double* G, double* S): writes G = −∇ and the sizes of its terms, returns its
///           scale λ, and keeps θ;
///           void hessian(const int* support, int size, double* H): H[size][size] there, positive semi-definite if convex;
///           double power(): β, or 0 where the multiplicative step is not known to descend;
///           convex: a constant; if false, double value() there;
///           may_vanish: a constant, that all terms are 0 at an optimum and nowhere else. Powers underflow.
/// Source    the outer method is that of Kim, Carbonetto, Stephens & Anitescu 2020 for γ = 1; here for every score, and
///           without evaluating the objective.
/// Errors    none; the residual tells.
/// Cost      an iteration: one gradient or a few, O(m³), and a Hessian over the support unless the last one serves again;
///           about 1000 gradients at most.
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
        at_(best_ + m),
        excess_(at_ + m),
        model_step_(excess_ + m),
        sizes_(model_step_ + m),
        hessian_(sizes_ + m),
        support_(indices),
        kept_(indices + m),
        model_(m, hessian_ + m * m, indices + 2 * m) {}

  /// Moves θ to a minimum, with so many multiplicative steps at first. Stops at the tolerance, or above it where rounding,
  /// that of the numbers of which G is a sum, stops all progress.
  [[gnu::noinline]] PHIMIS_HOST_DEVICE simplex_solution minimise(double* theta, double tolerance, int opening = 2,
                                                                 double rounding = epsilon<double>) noexcept {
    rounding_ = rounding;
    last_residual_ = 0;
    simplex_solution now;
    for (int k = 0; k < m_; ++k) best_[k] = theta[k];
    if (!enter(theta, now)) {
      for (int k = 0; k < m_; ++k) theta[k] = best_[k];
      return now;
    }
    simplex_solution best;
    for (int k = 0; k < m_; ++k) best_[k] = theta[k];
    int stale = 0;
    constexpr int most = 300;
    constexpr int most_evaluations = 1000;
    for (; now.iterations < most && now.evaluations < most_evaluations; ++now.iterations) {
      certify(theta, now);
      stale = now.residual < best.residual / 2 ? 0 : stale + 1;
      if (now.residual < best.residual) {
        best = now;
        for (int k = 0; k < m_; ++k) best_[k] = theta[k];
      }
      const int patience = best.residual <= 64 * tolerance ? 1 : 3;
      const bool at_rounding = best.residual <= 1e4 * tolerance && stale >= patience;
      if (best.residual <= tolerance || at_rounding || m_ == 1) break;
      const bool opens = now.iterations < opening && on_.power() != 0;
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
    const double lambda = on_.gradient(at, gradient, sizes_);
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
      // Where terms cancel, G_k is known no better than its largest.
      const double scale = now.lambda > sizes_[k] ? now.lambda : sizes_[k];
      double violation = scale > 0 ? (theta[k] > 0 ? std::fabs(excess) : excess) / scale : infinity<double>;
      if (Problem::may_vanish && scale == 0 && excess == 0) violation = 0;
      if (violation > worst) worst = violation;
    }
    now.residual = worst;
    now.gap = now.lambda > 0 ? above / now.lambda : worst;
  }

  PHIMIS_HOST_DEVICE bool newton_step(double* theta, simplex_solution& now) noexcept {
    int size = 0;
    int old = 0;
    bool within = true;  // the support of the Hessian
    for (int k = 0; k < m_; ++k) {
      if (!(theta[k] > 0) && !(gradient_[k] > nu_)) continue;
      at_[size] = theta[k];
      excess_[size] = gradient_[k] - nu_;
      while (old < size_ && support_[old] < k) ++old;
      within = within && old < size_ && support_[old] == k;
      kept_[size] = old;
      support_[size++] = k;
    }
    // It costs as much as m/2 gradients: it serves again as long as each step gains a digit, or nearly.
    const bool again = Problem::convex && within && now.residual < last_residual_ / 8;
    last_residual_ = now.residual;
    for (int a = 0; a < size && again && size < size_; ++a) {
      for (int b = 0; b < size; ++b) hessian_[a * size + b] = hessian_[kept_[a] * size_ + kept_[b]];
    }
    size_ = size;
    if (again) {
      model_.keep(hessian_, size);
      if (step_of_model(theta, now, 0)) return true;
      if (!evaluate(theta, gradient_, now)) return false;  // what failed left its point behind
    }
    on_.hessian(support_, size, hessian_);
    // No coordinate alone is to go a thousand times as far as the simplex is long: a nearly flat one would drown the others. Where it is
    // not convex, the diagonal may be negative while every edge of the simplex is curved.
    for (int a = 0; a < size && Problem::convex; ++a) {
      const double least = 1e-3 * std::fabs(excess_[a]);
      if (hessian_[a * size + a] < least) hessian_[a * size + a] = least;
    }
    model_.keep(hessian_, size);
    double value = 0;  // at θ: a trial that fails leaves its own behind
    if constexpr (!Problem::convex) value = on_.value();
    return step_of_model(theta, now, value);
  }

  PHIMIS_HOST_DEVICE bool step_of_model(double* theta, simplex_solution& now, double value) noexcept {
    // A model that is nearly flat may fail to descend; the less it is trusted, the surer it does.
    for (double delta = 1e-12; delta < 1e3; delta *= 1e3) {
      if (!model_.step(at_, excess_, 50 * rounding_ * std::fabs(nu_), delta, model_step_)) continue;
      for (int k = 0; k < m_; ++k) step_[k] = 0;
      for (int a = 0; a < size_; ++a) step_[support_[a]] = model_step_[a];
      if (search(theta, value, now)) return true;
    }
    return false;
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
  PHIMIS_HOST_DEVICE bool search(double* theta, double value, simplex_solution& now) noexcept {
    const double start = slope_along(theta, gradient_);
    double noise = 0;
    for (int k = 0; k < m_; ++k) noise += 32 * rounding_ * now.lambda * std::fabs(step_[k]);
    double length = 1;
    for (int attempt = 0; attempt < 24; ++attempt) {
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
      // A power below 1 of a coordinate that was 0 turns the slope after 1e-26 of the way.
      const double least = (attempt < 2 ? 0.6 : attempt < 8 ? 0.1 : 1e-3) * length;
      const double largest = (attempt < 4 ? 0.9 : 0.4) * length;
      length = secant < least ? least : secant > largest ? largest : secant;
    }
    return false;
  }

  PHIMIS_HOST_DEVICE bool multiplicative_step(double* theta, simplex_solution& now) noexcept {
    const double beta = on_.power();
    if (!(nu_ * beta > 0)) return false;
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
  double* at_;  // θ, excess and step of each in the support
  double* excess_;
  double* model_step_;
  double* sizes_;
  double* hessian_;
  int* support_;  // of the Hessian
  int* kept_;     // where its rows were in the last
  detail::simplex_model model_;
  int size_ = 0;              // of the support
  double last_residual_ = 0;  // before the last Newton step
  double nu_ = 0;
  double rounding_ = 0;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_SIMPLEX_NEWTON_HPP
