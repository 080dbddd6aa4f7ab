// SPDX-License-Identifier: MIT
#ifndef PHIMIS_SOLVER_TABLE_HPP
#define PHIMIS_SOLVER_TABLE_HPP

#include <phimis/core/table.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace phimis {

/// Room for the rows of any number of observations; the growing counterpart of `fixed_table`.
template <class Real, int M>
class table {
 public:
  using real = Real;
  static constexpr int techniques = M;

  std::ptrdiff_t size() const noexcept { return static_cast<std::ptrdiff_t>(u_.size()); }

  /// Always true: it grows.
  bool push(const row<Real, M>& row) {
    u_.push_back(row.u);
    w_.push_back(row.w);
    for (std::size_t k = 0; k < M; ++k) y_[k].push_back(row.y[k]);
    return true;
  }

  row<Real, M> operator[](std::ptrdiff_t j) const noexcept {
    const auto i = static_cast<std::size_t>(j);
    row<Real, M> row{u_[i], w_[i], {}};
    for (std::size_t k = 0; k < M; ++k) row.y[k] = y_[k][i];
    return row;
  }

  columns<Real, M> view() const noexcept {
    columns<Real, M> view{u_.data(), w_.data(), {}, size()};
    for (std::size_t k = 0; k < M; ++k) view.y[k] = y_[k].data();
    return view;
  }

 private:
  std::vector<Real> u_;
  std::vector<Real> w_;
  std::array<std::vector<Real>, M> y_;
};

}  // namespace phimis

#endif  // PHIMIS_SOLVER_TABLE_HPP
