// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_ROW_PARTS_HPP
#define PHIMIS_CORE_ROW_PARTS_HPP

#include <phimis/core/config.hpp>

#include <cstddef>

namespace phimis {

/// Rows in parts that a host may read at the same time.
///
/// What the parts find is put together in their order: results do not depend on who read which, and when.
struct row_parts {
  int count;
  double* found;  ///< count × most numbers
  int most;       ///< numbers that a part may find
  void* host;
  /// Calls part(work, 0), …, part(work, count − 1) on any threads, and returns when all have ended.
  void (*run)(void* host, int count, void (*part)(void* work, int index), void* work);

  /// The most that is found on rows of m techniques.
  PHIMIS_HOST_DEVICE static constexpr int doubles(int m) noexcept { return 2 * (m + 1) * (m + 1); }
};

/// Rows that are read together: what is computed of them stays in cache, and of many rows some blocks tell where to start.
inline constexpr int block_rows = 64;

/// Rows by column, for a number of techniques that is known when it runs. Shapes u[n], w[n], y[m][n].
template <class Real>
struct column_pointers {
  const Real* u;
  const Real* w;
  const Real* const* y;
  std::ptrdiff_t n;
  int m;
  const row_parts* parts = nullptr;  ///< null: all rows in turn
};

/// find(first, last, found) writes `size` numbers about the rows from first up to last; put(part, found) puts those of a part to
/// what was found before it.
template <class Real, class Find, class Put>
PHIMIS_HOST_DEVICE void for_parts(const column_pointers<Real>& rows, double* found, const Find& find,
                                  const Put& put) noexcept {
  if (rows.parts == nullptr || rows.parts->count < 2) {
    find(std::ptrdiff_t(0), rows.n, found);
    return;
  }
  struct job {
    const column_pointers<Real>& rows;
    const Find& find;

    PHIMIS_HOST_DEVICE static void part(void* work, int index) {
      const job& of = *static_cast<const job*>(work);
      const row_parts& parts = *of.rows.parts;
      const std::ptrdiff_t first = of.rows.n / parts.count * index;
      const std::ptrdiff_t last = index + 1 < parts.count ? of.rows.n / parts.count * (index + 1) : of.rows.n;
      of.find(first, last, parts.found + static_cast<std::ptrdiff_t>(index) * parts.most);
    }
  } work{rows, find};
  const row_parts& parts = *rows.parts;
  parts.run(parts.host, parts.count, &job::part, &work);
  for (int i = 0; i < parts.count; ++i) put(i, parts.found + static_cast<std::ptrdiff_t>(i) * parts.most);
}

/// `for_parts` of sums: add(first, last, sums) adds to sums[size].
template <class Real, class Add>
PHIMIS_HOST_DEVICE void sum_parts(const column_pointers<Real>& rows, int size, double* sums,
                                  const Add& add) noexcept {
  for_parts(
      rows, sums,
      [&](std::ptrdiff_t first, std::ptrdiff_t last, double* own) {
        for (int i = 0; i < size; ++i) own[i] = 0;
        add(first, last, own);
      },
      [&](int part, const double* own) {
        for (int i = 0; i < size; ++i) sums[i] = part == 0 ? own[i] : sums[i] + own[i];
      });
}

}  // namespace phimis

#endif  // PHIMIS_CORE_ROW_PARTS_HPP
