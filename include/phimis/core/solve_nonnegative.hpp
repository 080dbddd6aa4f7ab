// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_SOLVE_NONNEGATIVE_HPP
#define PHIMIS_CORE_SOLVE_NONNEGATIVE_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/solve_dense.hpp>

#include <cmath>

namespace phimis {

namespace detail {

template <int M>
class lawson_hanson {
 public:
  PHIMIS_HOST_DEVICE lawson_hanson(const double (&g)[M][M], const double (&b)[M], int n, double (&x)[M],
                                   double rounding) noexcept
      : g_(g), b_(b), x_(x), n_(n), rounding_(rounding) {}

  PHIMIS_HOST_DEVICE bool solve() noexcept {
    for (int i = 0; i < n_; ++i) x_[i] = 0;
    for (int pass = 0; pass < 4 * M + 8; ++pass) {
      const int entering = most_wanted();
      if (entering < 0) return true;
      enter(entering);
    }
    return false;
  }

 private:
  /// The unknown at 0 that wants to grow most, in the unit of its own column; −1 where none does.
  PHIMIS_HOST_DEVICE int most_wanted() const noexcept {
    int best = -1;
    double most = 0;
    for (int i = 0; i < n_; ++i) {
      if (positive_[i] || refused_[i] || !(g_[i][i] > 0)) continue;
      double wish = b_[i];
      double size = std::fabs(b_[i]);
      for (int k = 0; k < n_; ++k) {
        wish -= g_[i][k] * x_[k];
        size += std::fabs(g_[i][k] * x_[k]);
      }
      const double relative = wish / std::sqrt(g_[i][i]);
      if (wish > 4 * M * rounding_ * size && relative > most) {
        most = relative;
        best = i;
      }
    }
    return best;
  }

  /// Lets one more unknown be positive; unknowns that become 0 on the way to the solution stay there.
  PHIMIS_HOST_DEVICE void enter(int entering) noexcept {
    positive_[entering] = true;
    for (bool first = true;; first = false) {
      double target[M];
      const bool solved = solve_positive(target);
      double step = 1;
      int leaving = -1;
      for (int i = 0; i < n_ && solved; ++i) {
        if (!positive_[i] || target[i] > 0) continue;
        const double way = x_[i] > 0 ? x_[i] / (x_[i] - target[i]) : 0;
        if (leaving < 0 || way < step) {
          step = way;
          leaving = i;
        }
      }
      if (!solved || (first && leaving == entering)) {
        positive_[entering] = false;
        refused_[entering] = true;
        return;
      }
      for (int i = 0; i < n_; ++i) {
        if (positive_[i]) x_[i] += step * (target[i] - x_[i]);
      }
      if (leaving < 0) break;
      x_[leaving] = 0;
      positive_[leaving] = false;
    }
    for (int i = 0; i < n_; ++i) refused_[i] = false;
  }

  /// The solution without constraints in the unknowns that may be positive.
  PHIMIS_HOST_DEVICE bool solve_positive(double (&target)[M]) const noexcept {
    int support[M];
    int size = 0;
    for (int i = 0; i < n_; ++i) {
      if (positive_[i]) support[size++] = i;
    }
    double a[M][M];
    double right[M];
    double solution[M];
    for (int k = 0; k < size; ++k) {
      for (int i = 0; i < size; ++i) a[k][i] = g_[support[k]][support[i]];
      right[k] = b_[support[k]];
    }
    if (!solve_dense<M>(a, right, size, solution, rounding_)) return false;
    for (int k = 0; k < size; ++k) target[support[k]] = solution[k];
    return true;
  }

  const double (&g_)[M][M];
  const double (&b_)[M];
  double (&x_)[M];
  int n_;
  double rounding_;
  bool positive_[M] = {};
  bool refused_[M] = {};
};

}  // namespace detail

/// Nonnegative least squares in its normal equations.  min_x ½ x'Gx − b'x,  x ≥ 0
///
/// An unknown whose column depends, to rounding, on those that are positive already stays 0: duplicates need no care.
///
/// Source   Lawson & Hanson 1974, ch. 23.
/// Shapes   g[M][M] symmetric, positive semi-definite; b[M]; the first n ≤ M of each.
/// Errors   false where the conditions of optimality did not come to hold; x is feasible all the same.
/// Cost     about n solves of at most n equations.
template <int M>
PHIMIS_HOST_DEVICE bool solve_nonnegative(const double (&g)[M][M], const double (&b)[M], int n, double (&x)[M],
                                          double rounding = epsilon<double>) noexcept {
  return detail::lawson_hanson<M>(g, b, n, x, rounding).solve();
}

}  // namespace phimis

#endif  // PHIMIS_CORE_SOLVE_NONNEGATIVE_HPP
