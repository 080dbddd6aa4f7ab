// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_TABLE_HPP
#define PHIMIS_CORE_TABLE_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/observation.hpp>

#include <cstddef>

namespace phimis {

/// Rows of M techniques by column, in memory that belongs to somebody else.
///
/// Shapes u[n], w[n], y[M][n], as in `row`.
template <class Real, int M>
struct columns {
  const Real* u;
  const Real* w;
  const Real* y[M];
  std::ptrdiff_t n;
};

/// Room for the rows of Capacity observations, without a heap. What comes after it is full is refused.
template <class Real, int M, int Capacity>
class fixed_table {
 public:
  using real = Real;
  static constexpr int techniques = M;

  PHIMIS_HOST_DEVICE std::ptrdiff_t size() const noexcept { return size_; }

  /// False where the table is full.
  PHIMIS_HOST_DEVICE bool push(const row<Real, M>& row) noexcept {
    if (size_ == Capacity) return false;
    u_[size_] = row.u;
    w_[size_] = row.w;
    for (int k = 0; k < M; ++k) y_[k][size_] = row.y[k];
    ++size_;
    return true;
  }

  PHIMIS_HOST_DEVICE row<Real, M> operator[](std::ptrdiff_t j) const noexcept {
    row<Real, M> row{u_[j], w_[j], {}};
    for (int k = 0; k < M; ++k) row.y[k] = y_[k][j];
    return row;
  }

  PHIMIS_HOST_DEVICE columns<Real, M> view() const noexcept {
    columns<Real, M> view{u_, w_, {}, size_};
    for (int k = 0; k < M; ++k) view.y[k] = y_[k];
    return view;
  }

 private:
  std::ptrdiff_t size_ = 0;
  Real u_[Capacity];
  Real w_[Capacity];
  Real y_[M][Capacity];
};

}  // namespace phimis

#endif  // PHIMIS_CORE_TABLE_HPP
