// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_SOLVE_DENSE_HPP
#define PHIMIS_CORE_SOLVE_DENSE_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/limits.hpp>

#include <cmath>

namespace phimis {

/// The solution of n ≤ M linear equations.  Σ_i a[k][i] x[i] = b[k]
///
/// Elimination with row pivoting. Rows and columns are first brought to a largest entry of 1, so that neither the unit of
/// an equation nor that of an unknown decides what is singular.
///
/// Shapes   a[M][M], b[M], of which the first n; both are overwritten.
/// Errors   false where a pivot is lost in the rounding that the entries have, or the solution is not finite.
/// Cost     n³/3 multiplications.
template <int M>
PHIMIS_HOST_DEVICE bool solve_dense(double (&a)[M][M], double (&b)[M], int n, double (&x)[M],
                                    double rounding = epsilon<double>) noexcept {
  double unit[M];  // of the unknowns
  for (int k = 0; k < n; ++k) {
    double largest = 0;
    for (int i = 0; i < n; ++i) largest = std::fmax(largest, std::fabs(a[k][i]));
    if (!(largest > 0) || !is_finite(1 / largest)) return false;
    for (int i = 0; i < n; ++i) a[k][i] /= largest;
    b[k] /= largest;
  }
  for (int i = 0; i < n; ++i) {
    unit[i] = 0;
    for (int k = 0; k < n; ++k) unit[i] = std::fmax(unit[i], std::fabs(a[k][i]));
    if (!(unit[i] > 0) || !is_finite(1 / unit[i])) return false;
    for (int k = 0; k < n; ++k) a[k][i] /= unit[i];
  }
  for (int c = 0; c < n; ++c) {
    int pivot = c;
    for (int k = c + 1; k < n; ++k) {
      if (std::fabs(a[k][c]) > std::fabs(a[pivot][c])) pivot = k;
    }
    if (!(std::fabs(a[pivot][c]) > 4 * M * rounding)) return false;
    for (int i = c; i < n; ++i) {
      const double other = a[pivot][i];
      a[pivot][i] = a[c][i];
      a[c][i] = other;
    }
    const double other = b[pivot];
    b[pivot] = b[c];
    b[c] = other;
    for (int k = c + 1; k < n; ++k) {
      const double factor = a[k][c] / a[c][c];
      for (int i = c + 1; i < n; ++i) a[k][i] -= factor * a[c][i];
      b[k] -= factor * b[c];
    }
  }
  for (int c = n - 1; c >= 0; --c) {
    double value = b[c];
    for (int i = c + 1; i < n; ++i) value -= a[c][i] * x[i];
    x[c] = value / a[c][c];
  }
  for (int i = 0; i < n; ++i) {
    x[i] /= unit[i];
    if (!is_finite(x[i])) return false;
  }
  return true;
}

}  // namespace phimis

#endif  // PHIMIS_CORE_SOLVE_DENSE_HPP
