// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_LINEAR_EQUATIONS_HPP
#define PHIMIS_CORE_LINEAR_EQUATIONS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/movable_techniques.hpp>
#include <phimis/core/solve_dense.hpp>

#include <cmath>

namespace phimis {

/// The equations of the linear heuristic.  Σ_i α_i P_ik = ν F_k for every k that moves,  Σ α_i = 1
///
/// Source   L Eqs. 13, 14, 17.
/// Shapes   p[i][k] = P_ik, f[k] = F_k; a k with P_kk = 0 has no equation.
template <int M>
struct linear_equations {
  double p[M][M];
  double f[M];
  double rounding;  ///< of p and f

  /// Whether every technique that moves has an equation: samples, where its pdf is not 0.
  PHIMIS_HOST_DEVICE bool complete(const movable_techniques<M>& on) const noexcept {
    for (int i = 0; i < on.size; ++i) {
      if (!(p[on.technique[i]][on.technique[i]] > 0)) return false;
    }
    return true;
  }

  /// The solution on a face, τ = 0 off it. False where an equation is missing, or they are singular.
  PHIMIS_HOST_DEVICE bool solve(const movable_techniques<M>& on, unsigned face, double (&tau)[M]) const noexcept {
    double a[M][M];
    double b[M];
    double x[M];
    int member[M];
    int size = 0;
    for (int i = 0; i < on.size; ++i) {
      tau[i] = 0;
      if ((face >> i & 1u) != 0) member[size++] = i;
    }
    for (int r = 0; r < size; ++r) {
      const int k = on.technique[member[r]];
      if (!(p[k][k] > 0)) return false;
      double base = 0;
      for (int i = 0; i < M; ++i) base += on.fixed[i] * p[i][k];
      for (int c = 0; c < size; ++c) a[r][c] = base + on.free * p[on.technique[member[c]]][k];
      b[r] = f[k];
    }
    double terms = 0;  // the size of what is summed
    if (size == 1) {
      x[0] = 1;
    } else if (size == 2) {
      // L Eq. 17: each numerator by itself, so that neither fraction is 1 minus a rounded one.
      x[0] = a[1][1] * b[0] - a[0][1] * b[1];
      x[1] = a[0][0] * b[1] - a[1][0] * b[0];
      terms = (std::fabs(a[1][1]) + std::fabs(a[1][0])) * b[0] + (std::fabs(a[0][1]) + std::fabs(a[0][0])) * b[1];
    } else if (!solve_dense<M>(a, b, size, x, rounding)) {
      return false;
    }
    double sum = 0;
    for (int r = 0; r < size; ++r) {
      sum += x[r];
      terms = std::fmax(terms, std::fabs(x[r]));
    }
    if (!(std::fabs(sum) > 4 * M * rounding * terms) || !is_finite(sum)) return false;
    for (int r = 0; r < size; ++r) {
      tau[member[r]] = x[r] / sum;
      if (!is_finite(tau[member[r]])) return false;
    }
    return true;
  }

  /// From a solution with negative fractions: the most negative becomes 0, until none is.  L Sec. 5.1
  PHIMIS_HOST_DEVICE bool drop_most_negative(const movable_techniques<M>& on, double (&tau)[M]) const noexcept {
    unsigned face = on.all();
    while (!on.feasible(tau)) {
      int worst = 0;
      for (int i = 1; i < on.size; ++i) {
        if (tau[i] < tau[worst]) worst = i;
      }
      face &= ~(1u << worst);
      if (!solve(on, face, tau)) return false;
    }
    return true;
  }

  /// The solution of least cost on the largest faces that have one without negative fractions, short of the whole.
  template <class Cost>
  PHIMIS_HOST_DEVICE bool best_face(const movable_techniques<M>& on, const Cost& cost,
                                    double (&tau)[M]) const noexcept {
    bool found = false;
    double least = 0;
    for (int size = on.size - 1; size >= 1 && !found; --size) {
      for (unsigned face = 1; face < on.all(); ++face) {
        int bits = 0;
        for (unsigned rest = face; rest != 0; rest &= rest - 1) ++bits;
        double trial[M];
        if (bits != size || !solve(on, face, trial) || !on.feasible(trial)) continue;
        const double now = cost(on.at(trial));
        if (found && !(now < least)) continue;
        found = true;
        least = now;
        for (int i = 0; i < on.size; ++i) tau[i] = trial[i];
      }
    }
    return found;
  }
};

}  // namespace phimis

#endif  // PHIMIS_CORE_LINEAR_EQUATIONS_HPP
