// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_PACK_HPP
#define PHIMIS_CORE_PACK_HPP

#include <phimis/core/config.hpp>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace phimis::detail {

// A few rows side by side in one register: arithmetic on a pack is arithmetic on each lane. g++ and clang++ know such
// types; for other compilers and on devices a pack is one number, and the same code is a plain loop.
#if defined(__GNUC__) && !defined(__CUDACC__) && !defined(__HIPCC__)
#if defined(__AVX__)
inline constexpr int pack_bytes = 32;
#else
inline constexpr int pack_bytes = 16;
#endif
template <class Real>
struct pack_type {
  typedef Real type __attribute__((vector_size(pack_bytes)));
};
#else
template <class Real>
struct pack_type {
  typedef Real type;
};
#endif

template <class Real>
using pack = typename pack_type<Real>::type;

template <class Real>
inline constexpr std::ptrdiff_t pack_width = sizeof(pack<Real>) / sizeof(Real);

/// The numbers at p, p + 1, …: as many as V has lanes.
template <class V, class Real>
PHIMIS_HOST_DEVICE V load(const Real* p) noexcept {
  V v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

template <class V, class Real>
PHIMIS_HOST_DEVICE void store(Real* p, const V& v) noexcept {
  std::memcpy(p, &v, sizeof v);
}

template <class Real, class V>
PHIMIS_HOST_DEVICE double sum_of_lanes(const V& v) noexcept {
  if constexpr (std::is_same<V, Real>::value) {
    return static_cast<double>(v);
  } else {
    double sum = 0;
    for (std::size_t l = 0; l < sizeof(V) / sizeof(Real); ++l) sum += static_cast<double>(v[l]);
    return sum;
  }
}

/// √ of every lane. The builtins do what a loop would, were std::sqrt not bound to set errno.
template <class Real, class V>
PHIMIS_HOST_DEVICE V square_root(const V& v) noexcept {
  if constexpr (std::is_same<V, Real>::value) {
    return std::sqrt(v);
  } else {
#if defined(__AVX__)
    if constexpr (sizeof(Real) == 8) return V(__builtin_ia32_sqrtpd256(v));
    if constexpr (sizeof(Real) == 4) return V(__builtin_ia32_sqrtps256(v));
#elif defined(__SSE2__)
    if constexpr (sizeof(Real) == 8) return V(__builtin_ia32_sqrtpd(v));
    if constexpr (sizeof(Real) == 4) return V(__builtin_ia32_sqrtps(v));
#else
    V roots = v;
    for (std::size_t l = 0; l < sizeof(V) / sizeof(Real); ++l) roots[l] = std::sqrt(v[l]);
    return roots;
#endif
  }
}

/// Adds up rows from `first` up to `last`. terms.add<V>(j, sums) adds row j, and as many after it as V has lanes, to N sums of type V.
///
/// Lanes are independent sums, so no order is changed that a compiler would have to prove harmless; blocks of rows are
/// added in double, so that rounding grows with the block, not with n.
template <int N, class Real, class Terms>
PHIMIS_HOST_DEVICE void sum_rows(std::ptrdiff_t first, std::ptrdiff_t last, const Terms& terms,
                                 double (&total)[N]) noexcept {
  using V = std::conditional_t<Terms::packed, pack<Real>, Real>;
  constexpr std::ptrdiff_t width = Terms::packed ? pack_width<Real> : 1;
  constexpr std::ptrdiff_t block = 64 * width;
  std::ptrdiff_t j = first;
  while (last - j >= width) {
    const std::ptrdiff_t end = last - j < block ? last - width : j + block - width;
    V sums[N] = {};
    for (; j <= end; j += width) terms.template add<V>(j, sums);
    for (int i = 0; i < N; ++i) total[i] += sum_of_lanes<Real>(sums[i]);
  }
  if (j < last) {
    Real rest[N] = {};
    for (; j < last; ++j) terms.template add<Real>(j, rest);
    for (int i = 0; i < N; ++i) total[i] += static_cast<double>(rest[i]);
  }
}

}  // namespace phimis::detail

#endif  // PHIMIS_CORE_PACK_HPP
