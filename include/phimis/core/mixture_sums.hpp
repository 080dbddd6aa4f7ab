// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_MIXTURE_SUMS_HPP
#define PHIMIS_CORE_MIXTURE_SUMS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/mixture_scores.hpp>
#include <phimis/core/pack.hpp>
#include <phimis/core/power_terms.hpp>
#include <phimis/core/row_parts.hpp>

#include <cstddef>
#include <type_traits>

namespace phimis {

namespace detail {

/// Sums over rows at a mixture x_j = Σ β_k y_kj, block by block: each block's scores stay in cache while all techniques
/// read them.
template <class Real, class Scores>
class mixture_block_sums {
 public:
  /// every: 1, or that only one block in so many is read.
  PHIMIS_HOST_DEVICE mixture_block_sums(const column_pointers<Real>& rows, const double* beta, double unit,
                                        const Scores& scores, int every) noexcept
      : rows_(rows), beta_(beta), unit_(static_cast<Real>(unit)), scores_(scores), every_(every) {}

  /// sums[2m + 1]: λ, then G_k = Σ_j w_j y_kj s(t_j), then S_k, the size of its terms: Σ_j w_j y_kj |s(t_j)| of a power
  PHIMIS_HOST_DEVICE void gradient(double* sums) const noexcept {
    const int m = rows_.m;
    sum_parts(rows_, Scores::changes_sign ? 2 * m + 1 : m + 1, sums,
              [&](std::ptrdiff_t from, std::ptrdiff_t to, double* own) {
                for_blocks(from, to, [&](auto lane, std::ptrdiff_t first, int count) {
                  using V = decltype(lane);
                  score_block<Real> block;
                  own[0] += fill<V>(first, count, block);
                  add_dots<V>(first, block.a, count, own + 1);
                  if constexpr (Scores::changes_sign) add_dots<V>(first, block.c, count, own + 1 + m);
                });
              });
    for (int k = 0; k < m && !Scores::changes_sign; ++k)
      sums[1 + m + k] = sums[1 + k] < 0 ? -sums[1 + k] : sums[1 + k];
  }

  /// H_kl = Σ_j w_j y_kj y_lj t_j s'(t_j)/x_j over a support; the last coordinate is Σ fixed_k y_k where `fixed` is given.
  PHIMIS_HOST_DEVICE void hessian(const int* support, int size, const double* fixed, double* hessian) const noexcept {
    const int order = size + (fixed != nullptr ? 1 : 0);
    sum_parts(rows_, order * order, hessian, [&](std::ptrdiff_t from, std::ptrdiff_t to, double* own) {
      for_blocks(from, to, [&](auto lane, std::ptrdiff_t first, int count) {
        using V = decltype(lane);
        score_block<Real> block;
        fill<V>(first, count, block);
        Real base[block_rows];
        if (fixed != nullptr) mix<V>(fixed, Real(0), first, count, base);
        const auto column = [&](int a) { return a < size ? rows_.y[support[a]] + first : base; };
        for (int a = 0; a < order; a += 2) {
          const int a1 = a + 1 < order ? a + 1 : a;
          Real scaled[2][block_rows];
          multiply<V>(column(a), block.b, count, scaled[0]);
          multiply<V>(column(a1), block.b, count, scaled[1]);
          for (int b = a; b < order; b += 4) {
            const Real* const y[4] = {column(b), column(b + 1 < order ? b + 1 : b), column(b + 2 < order ? b + 2 : b),
                                      column(b + 3 < order ? b + 3 : b)};
            double sums[8];
            products<V>(scaled[0], scaled[1], y, count, sums);
            for (int i = 0; i < 4 && b + i < order; ++i) {
              own[a * order + b + i] += sums[i];
              if (a1 > a) own[a1 * order + b + i] += sums[4 + i];
            }
          }
        }
      });
    });
    for (int a = 0; a < order; ++a) {
      for (int b = 0; b < a; ++b) hessian[a * order + b] = hessian[b * order + a];
    }
  }

  /// The |t| of the largest |s| among rows with u ≠ 0; 0 without any.
  PHIMIS_HOST_DEVICE double reference(bool largest) const noexcept {
    double found = 0;
    const auto keep = [largest](double& best, double t) {
      if (t > 0 && (!(best > 0) || (largest ? t > best : t < best))) best = t;
    };
    for_parts(
        rows_, &found,
        [&](std::ptrdiff_t from, std::ptrdiff_t to, double* own) {
          *own = 0;
          for_blocks(from, to, [&](auto lane, std::ptrdiff_t first, int count) {
            Real x[block_rows];
            mix<decltype(lane)>(beta_, tiny, first, count, x);
            for (int i = 0; i < count; ++i) {
              const Real u = rows_.u[first + i] < 0 ? -rows_.u[first + i] : rows_.u[first + i];
              if (u > 0) keep(*own, static_cast<double>(unit_ * u / x[i]));
            }
          });
        },
        [&](int, const double* own) { keep(found, *own); });
    return found;
  }

 private:
  static constexpr Real tiny = sizeof(Real) == 8 ? Real(1e-300) : Real(1e-37);
  static constexpr int together = 4;  // columns read at once: a block's sums stay in registers

  template <class Body>
  PHIMIS_HOST_DEVICE void for_blocks(std::ptrdiff_t from, std::ptrdiff_t to, const Body& body) const noexcept {
    using V = pack<Real>;
    constexpr std::ptrdiff_t width = pack_width<Real>;
    std::ptrdiff_t j = from;
    while (to - j >= width) {
      const std::ptrdiff_t rest = to - j;
      const std::ptrdiff_t count = rest < block_rows ? rest / width * width : block_rows;
      body(V{}, j, static_cast<int>(count));
      j += count + (every_ - 1) * block_rows;
    }
    if (j < to) body(Real{}, j, static_cast<int>(to - j));
  }

  /// Σ weight_k y_k + least
  template <class V>
  PHIMIS_HOST_DEVICE void mix(const double* weights, Real least, std::ptrdiff_t first, int count,
                              Real* x) const noexcept {
    constexpr int width = static_cast<int>(sizeof(V) / sizeof(Real));
    for (int i = 0; i < count; i += width) store<V>(x + i, V{} + least);
    const Real* y[together];
    Real weight[together];
    int pending = 0;
    for (int k = 0; k < rows_.m; ++k) {
      if (weights[k] == 0) continue;
      y[pending] = rows_.y[k] + first;
      weight[pending++] = static_cast<Real>(weights[k]);
      if (pending < together) continue;
      add_columns<V, together>(y, weight, count, x);
      pending = 0;
    }
    for (int i = 0; i < pending; ++i) add_columns<V, 1>(y + i, weight + i, count, x);
  }

  /// x += Σ weight_k y_k of so many columns
  template <class V, int Columns>
  PHIMIS_HOST_DEVICE static void add_columns(const Real* const* y, const Real* weight, int count, Real* x) noexcept {
    constexpr int width = static_cast<int>(sizeof(V) / sizeof(Real));
    for (int i = 0; i < count; i += width) {
      V sum = load<V>(x + i);
      for (int k = 0; k < Columns; ++k) sum += weight[k] * load<V>(y[k] + i);
      store<V>(x + i, sum);
    }
  }

  /// The scores of a block, and its part of λ.
  template <class V>
  PHIMIS_HOST_DEVICE double fill(std::ptrdiff_t first, int count, score_block<Real>& block) const noexcept {
    using W = std::conditional_t<Scores::packed, V, Real>;
    constexpr int width = static_cast<int>(sizeof(W) / sizeof(Real));
    Real x[block_rows];
    mix<V>(beta_, tiny, first, count, x);
    W lambda{};
    for (int i = 0; i < count; i += width) {
      W a;
      W b;
      W c;
      lambda += scores_.template score<W, Real>(load<W>(rows_.w + first + i), unit_ * load<W>(rows_.u + first + i),
                                                load<W>(x + i), a, b, c);
      store<W>(block.a + i, a);
      store<W>(block.b + i, b);
      if constexpr (Scores::changes_sign) store<W>(block.c + i, c);
    }
    return sum_of_lanes<Real>(lambda);
  }

  /// sums[k] += Σ_j y_kj a_j of every technique
  template <class V>
  PHIMIS_HOST_DEVICE void add_dots(std::ptrdiff_t first, const Real* a, int count, double* sums) const noexcept {
    int k = 0;
    for (; k + together <= rows_.m; k += together) add_dots<V, together>(rows_.y + k, first, a, count, sums + k);
    for (; k < rows_.m; ++k) add_dots<V, 1>(rows_.y + k, first, a, count, sums + k);
  }

  template <class V, int Columns>
  PHIMIS_HOST_DEVICE static void add_dots(const Real* const* y, std::ptrdiff_t first, const Real* a, int count,
                                          double* sums) noexcept {
    constexpr int width = static_cast<int>(sizeof(V) / sizeof(Real));
    V sum[Columns] = {};
    for (int i = 0; i < count; i += width) {
      const V factor = load<V>(a + i);
      for (int k = 0; k < Columns; ++k) sum[k] += factor * load<V>(y[k] + first + i);
    }
    for (int k = 0; k < Columns; ++k) sums[k] += sum_of_lanes<Real>(sum[k]);
  }

  template <class V>
  PHIMIS_HOST_DEVICE static void multiply(const Real* y, const Real* b, int count, Real* out) noexcept {
    constexpr int width = static_cast<int>(sizeof(V) / sizeof(Real));
    for (int i = 0; i < count; i += width) store<V>(out + i, load<V>(y + i) * load<V>(b + i));
  }

  /// The dot products of two columns with four.
  template <class V>
  PHIMIS_HOST_DEVICE static void products(const Real* z0, const Real* z1, const Real* const (&y)[4], int count,
                                          double (&out)[8]) noexcept {
    constexpr int width = static_cast<int>(sizeof(V) / sizeof(Real));
    V s0{}, s1{}, s2{}, s3{}, s4{}, s5{}, s6{}, s7{};
    for (int i = 0; i < count; i += width) {
      const V a = load<V>(z0 + i);
      const V b = load<V>(z1 + i);
      const V y0 = load<V>(y[0] + i);
      const V y1 = load<V>(y[1] + i);
      const V y2 = load<V>(y[2] + i);
      const V y3 = load<V>(y[3] + i);
      s0 += a * y0;
      s1 += a * y1;
      s2 += a * y2;
      s3 += a * y3;
      s4 += b * y0;
      s5 += b * y1;
      s6 += b * y2;
      s7 += b * y3;
    }
    out[0] = sum_of_lanes<Real>(s0);
    out[1] = sum_of_lanes<Real>(s1);
    out[2] = sum_of_lanes<Real>(s2);
    out[3] = sum_of_lanes<Real>(s3);
    out[4] = sum_of_lanes<Real>(s4);
    out[5] = sum_of_lanes<Real>(s5);
    out[6] = sum_of_lanes<Real>(s6);
    out[7] = sum_of_lanes<Real>(s7);
  }

  const column_pointers<Real>& rows_;
  const double* beta_;
  Real unit_;
  const Scores& scores_;
  int every_;
};

/// w |y| factor
template <class Real>
struct product_terms {
  static constexpr bool packed = true;
  const Real* w;
  const Real* y;
  Real factor;

  template <class V>
  PHIMIS_HOST_DEVICE void add(std::ptrdiff_t j, V (&sums)[1]) const noexcept {
    const V v = load<V>(w + j) * (load<V>(y + j) * factor);
    sums[0] += v < V{} ? -v : v;
  }
};

/// Σ_j w_j y_kj of every technique, and returns Σ_j w_j |u_j| unit.
template <class Real>
PHIMIS_HOST_DEVICE double masses(const column_pointers<Real>& rows, Real unit, double* mass) noexcept {
  const auto sum = [&](std::ptrdiff_t from, std::ptrdiff_t to, const Real* y, Real factor) {
    double total[1] = {};
    sum_rows<1, Real>(from, to, product_terms<Real>{rows.w, y, factor}, total);
    return total[0];
  };
  sum_parts(rows, rows.m, mass, [&](std::ptrdiff_t from, std::ptrdiff_t to, double* own) {
    for (int k = 0; k < rows.m; ++k) own[k] = sum(from, to, rows.y[k], Real(1));
  });
  double size = 0;
  sum_parts(rows, 1, &size,
            [&](std::ptrdiff_t from, std::ptrdiff_t to, double* own) { *own = sum(from, to, rows.u, unit); });
  return size;
}

}  // namespace detail

/// Hands the sums of a divergence at a mixture to `use`: γ = ½, 1, 2 run without a power function. Of one block of rows in
/// `every`.
template <class Divergence, class Real, class Use>
PHIMIS_HOST_DEVICE void with_mixture_sums(const Divergence& divergence, const column_pointers<Real>& rows,
                                          const double* beta, double unit, bool normalised, int every,
                                          const Use& use) noexcept {
  const auto run = [&](const auto& scores) {
    using Scores = std::decay_t<decltype(scores)>;
    use(detail::mixture_block_sums<Real, Scores>(rows, beta, unit, scores, every));
  };
  const bool is_power = detail::with_power(divergence, [&](const auto& power, double exponent) {
    run(detail::power_block<std::decay_t<decltype(power)>>{power, exponent});
  });
  if constexpr (detail::needs_any_score<Divergence>::value) {
    if (!is_power) run(detail::any_block<Divergence>{divergence, normalised ? 0 : score_at_zero(divergence)});
  }
}

}  // namespace phimis

#endif  // PHIMIS_CORE_MIXTURE_SUMS_HPP
