// SPDX-License-Identifier: MIT
#ifndef PHIMIS_SOLVER_LEAST_SQUARES_HPP
#define PHIMIS_SOLVER_LEAST_SQUARES_HPP

#include <phimis/core/fractions.hpp>
#include <phimis/core/value.hpp>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace phimis {

namespace detail {

/// Matrices of M rows: without a heap as long as they are small.
template <int M>
using square_matrix = Eigen::Matrix<double, (M <= 16 ? M : Eigen::Dynamic), (M <= 16 ? M : Eigen::Dynamic)>;
template <int M>
using column_vector = Eigen::Matrix<double, (M <= 16 ? M : Eigen::Dynamic), 1>;

}  // namespace detail

/// Coefficients β of least squares, of how many independent columns, and what they leave.
template <class Value, int M>
struct least_squares_solution {
  per_technique<Value, M> beta{};
  int rank = 0;
  Value residual_norm = value_traits<Value>::zero();  ///< √Σ_j |y_j − Σ_k β_k x_jk|²
};

/// A linear regression of any number of rows, kept as the triangle of its QR decomposition.
///
///     min_β Σ_j |y_j − Σ_k β_k x_jk|²
///
/// Rows enter by Givens rotations, so that the condition of the columns is never squared, as in normal equations.
/// y may be a colour: rotations are linear in it. Trivially copyable where Value is; states merge in any grouping.
///
/// Source   Golub & Van Loan, Matrix Computations, Secs. 5.2 and 6.5.
/// Cost     M² operations and M square roots a row.
template <class Value, int M>
class least_squares {
  using traits = value_traits<Value>;
  using real = typename traits::real;

 public:
  /// Adds the row x, y. Requires finite numbers.
  void add(per_technique<double, M> x, const Value& y) {
    ++rows_;
    const double size = static_cast<double>(traits::magnitude(y));
    if (!(unit_ > 0) && size > 0) unit_ = std::ldexp(1.0, std::max(std::ilogb(size), -1000));
    rotate(x, y, 0);
  }

  void merge(const least_squares& other) {
    const least_squares theirs = other;  // which may be this
    if (!(unit_ > 0)) unit_ = theirs.unit_;
    const real ratio = theirs.unit_ > 0 ? static_cast<real>(theirs.unit_ / unit_) : real(1);
    squares_ = squares_ + theirs.squares_ * ratio * ratio;
    for (int k = 0; k < M; ++k) {
      per_technique<double, M> x{};
      for (int l = k; l < M; ++l) x[l] = theirs.triangle_[k][l];
      rotate(x, theirs.rotated_[k], k);
    }
    rows_ += theirs.rows_;
  }

  std::int64_t rows() const noexcept { return rows_; }

  /// The solution of least norm, in columns of length one, without the columns that are left out. A column within 1e-10 of
  /// what others span, as a duplicate or one of zeros, or one too many for the rows, adds nothing to the rank.
  least_squares_solution<Value, M> solve(const per_technique<bool, M>& left_out = {}) const {
    constexpr double tolerance = 1e-10;
    detail::square_matrix<M> scaled = detail::square_matrix<M>::Zero(M, M);
    per_technique<double, M> length{};
    for (int l = 0; l < M; ++l) {
      for (int k = 0; k <= l && !left_out[l]; ++k) length[l] = std::hypot(length[l], triangle_[k][l]);
      for (int k = 0; k <= l && length[l] > 0; ++k) scaled(k, l) = triangle_[k][l] / length[l];
    }
    Eigen::CompleteOrthogonalDecomposition<detail::square_matrix<M>> decomposition(M, M);
    decomposition.setThreshold(tolerance);
    decomposition.compute(scaled);
    const detail::square_matrix<M> inverse = decomposition.pseudoInverse();
    least_squares_solution<Value, M> result;
    result.rank = static_cast<int>(decomposition.rank());
    for (int k = 0; k < M; ++k) {
      result.beta[k] = traits::zero();
      for (int l = 0; l < M && length[k] > 0; ++l) {
        result.beta[k] = result.beta[k] + rotated_[l] * static_cast<real>(inverse(k, l) / length[k]);
      }
    }
    Value squares = squares_;
    for (int k = 0; k < M; ++k) {
      Value rest = rotated_[k];
      for (int l = k; l < M; ++l) rest = rest - result.beta[l] * static_cast<real>(triangle_[k][l]);
      squares = squares + in_units(rest) * in_units(rest);
    }
    result.residual_norm = traits::root(squares) * static_cast<real>(unit_ > 0 ? unit_ : 1);
    return result;
  }

 private:
  /// Rotates a row into the triangle; what is left of y belongs to no column.
  void rotate(per_technique<double, M>& x, Value y, int from) {
    for (int k = from; k < M; ++k) {
      if (x[k] == 0) continue;
      const double h = std::hypot(triangle_[k][k], x[k]);
      const double c = triangle_[k][k] / h;
      const double s = x[k] / h;
      triangle_[k][k] = h;
      for (int l = k + 1; l < M; ++l) {
        const double above = triangle_[k][l];
        triangle_[k][l] = c * above + s * x[l];
        x[l] = c * x[l] - s * above;
      }
      const Value above = rotated_[k];
      rotated_[k] = above * static_cast<real>(c) + y * static_cast<real>(s);
      y = y * static_cast<real>(c) - above * static_cast<real>(s);
    }
    squares_ = squares_ + in_units(y) * in_units(y);
  }

  Value in_units(const Value& y) const { return unit_ > 0 ? Value(y * static_cast<real>(1 / unit_)) : y; }

  double triangle_[M][M] = {};
  per_technique<Value, M> rotated_ = zeros();
  Value squares_ =
      traits::zero();  // of what no column reaches, in units of a power of two near the first y that is not 0
  double unit_ = 0;
  std::int64_t rows_ = 0;

  static per_technique<Value, M> zeros() {
    per_technique<Value, M> all{};
    for (int k = 0; k < M; ++k) all[k] = traits::zero();
    return all;
  }
};

}  // namespace phimis

#endif  // PHIMIS_SOLVER_LEAST_SQUARES_HPP
