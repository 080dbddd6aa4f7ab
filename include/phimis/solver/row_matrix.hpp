// SPDX-License-Identifier: MIT
#ifndef PHIMIS_SOLVER_ROW_MATRIX_HPP
#define PHIMIS_SOLVER_ROW_MATRIX_HPP

#include <phimis/core/observation.hpp>
#include <phimis/core/pack.hpp>
#include <phimis/core/row_parts.hpp>
#include <phimis/core/rule.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <type_traits>
#include <vector>

namespace phimis {

/// Calls part(0), …, part(count − 1), in any order and on any threads, and returns when all have ended. Must not
/// throw: solvers do not.
using parallel_for = std::function<void(int count, const std::function<void(int)>& part)>;

/// Rows of observations that lie in matrices, in parts that may be read at the same time.
///
///     u_j = |f_j|,  w_j = 1/q_j,  y_kj = p_kj        where they lie; only w is new
///     u_j = |f_j|/Σp,  w_j = Σp/q_j,  y_kj = p_kj/Σp  copied
///
/// They are copied where an observation is none, a pdf is beyond 1e±50 or |f| beyond 1e200, or a sign would be lost.
///
/// Both have the same f/p and p_k/q.
///
/// Shapes  f[n], pdfs[n × m], q[n], which stay the caller's.
/// Errors  observations that are not finite, or have a negative pdf, are counted and left out.
class row_matrix {
 public:
  /// keeps_sign: whether u has the sign of f, as the variances want it.
  row_matrix(const Eigen::Ref<const Eigen::VectorXd>& f, const Eigen::Ref<const Eigen::MatrixXd>& pdfs,
             const Eigen::Ref<const Eigen::VectorXd>& q, bool keeps_sign, const parallel_for& run)
      : f_(f.data()),
        q_(q.data()),
        pdfs_(pdfs.data()),
        stride_(pdfs.outerStride()),
        n_(f.size()),
        m_(static_cast<int>(pdfs.cols())),
        keeps_sign_(keeps_sign),
        run_(run),
        w_(n_),
        parts_(static_cast<std::size_t>(parts_of(n_, m_))) {
    const auto count = static_cast<int>(parts_.size());
    in_parts(count, [this](int number) { look_at(number); });
    const bool plain = std::all_of(parts_.begin(), parts_.end(), [](const part& each) { return each.plain; });
    if (!plain) {
      u_.resize(n_);
      y_.resize(n_, m_);
      in_parts(count, [this](int number) { copy(number); });
    }
    for (const part& each : parts_) {
      if (plain) kept_ = n_;
      if (!plain) join(each);
      largest_ = std::max(largest_, each.largest);
      counters_.merge(each.counters);
    }
    columns_.reserve(static_cast<std::size_t>(m_));
    for (int k = 0; k < m_; ++k) columns_.push_back(plain ? pdfs_ + k * stride_ : y_.data() + k * n_);
    if (count > 1) found_.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(row_parts::doubles(m_)));
    core_parts_ = {count, found_.data(), row_parts::doubles(m_), this,
                   [](void* host, int parts, void (*run_part)(void*, int), void* work) {
                     static_cast<row_matrix*>(host)->in_parts(parts, [=](int number) { run_part(work, number); });
                   }};
  }
  row_matrix(const row_matrix&) = delete;
  row_matrix& operator=(const row_matrix&) = delete;

  /// Valid as long as this and the matrices are.
  column_pointers<double> view() const {
    return {u_.size() > 0 ? u_.data() : f_, w_.data(), columns_.data(), kept_, m_, &core_parts_};
  }
  double largest() const { return largest_; }  ///< |f|/Σp
  const rule_counters<double>& counters() const { return counters_; }

 private:
  using index = std::ptrdiff_t;

  struct part {
    index first = 0;
    index last = 0;
    index kept = 0;
    bool plain = true;  // rows may stay where they are
    double largest = 0;
    rule_counters<double> counters{};
  };

  /// One for every 2¹⁵ rows from 10⁵ on, as long as sums of parts take less memory than a quarter of the rows.
  static index parts_of(index n, index m) {
    return n < 100000 ? 1 : std::clamp<index>(std::min(n / 32768, n / (8 * (m + 1))), 1, 64);
  }

  template <class Part>
  void in_parts(int count, const Part& each) const {
    if (run_ && count > 1) return run_(count, each);
    for (int i = 0; i < count; ++i) each(i);
  }

  /// w, the largest |f|/Σp, and whether that is all there is to do.
  void look_at(int number) {
    const auto count = static_cast<index>(parts_.size());
    part& of = parts_[static_cast<std::size_t>(number)];
    of.first = n_ / count * number;
    of.last = number + 1 < count ? n_ / count * (number + 1) : n_;
    of.counters.observations = of.last - of.first;
    constexpr index tile = 64;
    index j = of.first;
    for (; of.last - j >= tile && of.plain; j += tile) look_at_rows<detail::pack<double>, tile>(j, of);
    for (; j < of.last && of.plain; ++j) look_at_rows<double, 1>(j, of);
  }

  // Bits of a number, or of a pack of them.
  template <class V>
  using bits = std::conditional_t<std::is_same_v<V, double>, std::uint64_t, detail::pack<std::uint64_t>>;
  static constexpr std::uint64_t sign = std::uint64_t(1) << 63;

  // Of numbers without a sign the bits are ordered as they are, and come after them where they are not finite; so checks
  // are differences, whose highest bit is set where they fail, with -ffast-math, too.
  template <class V>
  static bits<V> bits_of(double limit) {
    std::uint64_t raw = 0;
    std::memcpy(&raw, &limit, sizeof raw);
    return bits<V>{} + raw;
  }

  /// So many rows, a pack at a time.
  template <class V, index Rows>
  void look_at_rows(index from, part& of) {
    using detail::load;
    using detail::store;
    using B = bits<V>;
    constexpr index width = sizeof(V) / sizeof(double);
    double sum[Rows] = {};
    B bad{};
    for (int k = 0; k < m_; ++k) {
      const double* const p = pdfs_ + k * stride_ + from;
      for (index i = 0; i < Rows; i += width) {
        store<V>(sum + i, load<V>(sum + i) + load<V>(p + i));
        bad |= load<B>(p + i);
      }
    }
    const B lost = B{} + (keeps_sign_ ? 0 : sign);
    const B low = bits_of<V>(least);
    const B high = bits_of<V>(most);
    const B highest = bits_of<V>(most_of_f);
    V largest{};
    V zero{};
    for (index i = from; i < from + Rows; i += width) {
      const B f = load<B>(f_ + i);
      const B size_bits = f & ~sign;
      const B q_bits = load<B>(q_ + i);
      const B all_bits = load<B>(sum + (i - from));
      const V size = load<V>(&size_bits);
      const V q = load<V>(q_ + i);
      const V one = V{} + 1;
      const V reached = size > 0 ? load<V>(sum + (i - from)) : one;  // where f is 0 so may the pdfs be
      bad |= (f & lost) | (highest - size_bits);
      bad |= q_bits | (high - q_bits) | (q_bits - low);
      bad |= all_bits | (high - all_bits) | (load<B>(&reached) - low);
      const V inverse = 1 / (q * reached);  // one division for two quotients: both lie within 1e±50, or rows are copied
      const V ratio = size * (q * inverse);
      store<V>(w_.data() + i, reached * inverse);
      largest = ratio > largest ? ratio : largest;
      zero += size > 0 ? V{} : one;
    }
    for (index l = 0; l < width; ++l) {
      of.plain = of.plain && (load<std::uint64_t>(reinterpret_cast<const unsigned char*>(&bad) + 8 * l) & sign) == 0;
      of.largest = std::max(of.largest, load<double>(reinterpret_cast<const unsigned char*>(&largest) + 8 * l));
    }
    of.counters.zero += static_cast<std::int64_t>(detail::sum_of_lanes<double>(zero));
  }
  static constexpr double least = 1e-50;
  static constexpr double most = 1e50;
  static constexpr double most_of_f = 1e200;

  void copy(int number) {
    part& of = parts_[static_cast<std::size_t>(number)];
    of.largest = 0;
    of.counters = {};
    std::vector<double> given(static_cast<std::size_t>(m_)), taken(static_cast<std::size_t>(m_));
    for (index j = of.first; j < of.last; ++j) {
      const index to = of.first + of.kept;
      for (int k = 0; k < m_; ++k) given[static_cast<std::size_t>(k)] = pdfs_[j + k * stride_];
      ++of.counters.observations;
      if (!to_row(f_[j], given.data(), m_, q_[j], u_[to], w_[to], taken.data())) {
        ++of.counters.nonfinite;
        continue;
      }
      for (int k = 0; k < m_; ++k) y_(to, k) = taken[static_cast<std::size_t>(k)];
      of.largest = std::max(of.largest, u_[to]);
      if (!(u_[to] > 0)) ++of.counters.zero;
      if (keeps_sign_ && f_[j] < 0) u_[to] = -u_[to];
      ++of.kept;
    }
  }

  /// Moves a part's rows behind those of the parts before it.
  void join(const part& of) {
    if (of.first != kept_) {
      std::copy_n(u_.data() + of.first, of.kept, u_.data() + kept_);
      std::copy_n(w_.data() + of.first, of.kept, w_.data() + kept_);
      for (int k = 0; k < m_; ++k) {
        std::copy_n(y_.data() + k * n_ + of.first, of.kept, y_.data() + k * n_ + kept_);
      }
    }
    kept_ += of.kept;
  }

  const double* f_;
  const double* q_;
  const double* pdfs_;
  index stride_;
  index n_;
  int m_;
  bool keeps_sign_;
  const parallel_for& run_;
  Eigen::VectorXd u_{};
  Eigen::VectorXd w_;
  Eigen::MatrixXd y_{};
  std::vector<part> parts_;
  std::vector<const double*> columns_{};
  std::vector<double> found_{};
  row_parts core_parts_{};
  index kept_ = 0;
  double largest_ = 0;
  rule_counters<double> counters_{};
};

}  // namespace phimis

#endif  // PHIMIS_SOLVER_ROW_MATRIX_HPP
