// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_LINEAR_HEURISTIC_HPP
#define PHIMIS_CORE_LINEAR_HEURISTIC_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/linear_equations.hpp>
#include <phimis/core/moments.hpp>
#include <phimis/core/projection_sums.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/technique_sums.hpp>

#include <cstddef>
#include <type_traits>

namespace phimis {

/// What is done where the linear equations of the heuristic have a solution that is negative.
enum class negative_fractions {
  /// The most negative fraction becomes 0, its equation is dropped, and the rest is solved again, until none is negative.
  /// L Sec. 5.1, first technique.
  drop_most_negative,
  /// Each fraction becomes 0 in turn; of the solutions that are not negative, that of the least sample variance (L Eq. 19)
  /// is taken. Where there is none, two fractions become 0, and so on. It needs all samples again, and may take a mixture
  /// that is bad where its own few samples do not see it.  L Sec. 5.1, second technique.
  best_face,
  /// The best nonnegative fit of f by the pdfs, with nearly the weight 1/p(α) of the mixture that it finds: sums alone, as
  /// for the first, and better than both where it was measured (docs/policies.md).  Ours: see projection_sums.
  project
};

/// No room for samples: what the treatments take that keep sums alone.
struct no_table {};

namespace detail {

/// What a treatment keeps: the sums of the equations, and more for some.
template <class Real, int M, negative_fractions Treatment, class Table>
struct linear_memory {
  technique_sums<Real, M> sums;
};
template <class Real, int M>
struct linear_memory<Real, M, negative_fractions::project, no_table> {
  technique_sums<Real, M> sums;
  projection_sums<Real, M> projection;
};
template <class Real, int M, class Table>
struct linear_memory<Real, M, negative_fractions::best_face, Table> {
  static_assert(Table::techniques == M, "best_face keeps samples: it needs a table of as many techniques");
  technique_sums<Real, M> sums;
  Table samples[M];  // of each technique
  Real largest = 0;  // u
};

}  // namespace detail

/// The linear heuristic: fractions by linear equations from sums alone.
///
///     Σ_i α_i P_ik = ν F_k for every technique k,   Σ α_i = 1;   P_ik = Σ_j p_i(X_kj),   F_k = Σ_j f(X_kj)
///     α_1 = (P_22 F_1 − P_21 F_2) / (P_11 F_2 − P_21 F_2 − P_12 F_1 + P_22 F_1) for two techniques
///
/// With infinitely many samples it is the best fit of f by Σ a_k p_k in L2: exact where f lies in their span. Floors are
/// the edges of the simplex: a solution below one is treated as a negative fraction is, and at a floor the equation of
/// that technique is dropped. A technique that is frozen has no equation.
///
/// Source   L Eqs. 13, 14, 17–19, Sec. 5.1.
/// Table    of best_face: fixed_table or table, one for each technique. A sample that finds no room is in the sums alone.
/// Requires a sample of every technique that can move, or the fractions stay; treatments other than `project` solve
///          nothing where pdfs are linearly dependent. Costs are not known to this rule.
/// Errors   solutions with a negative fraction are counted in `counters().left`. Where a treatment finds no fractions
///          (not_converged), and without information, they stay as they were.
/// Cost     an observation: two divisions, and with `project` M more and what projection_sums costs. An update: M³
///          operations; `best_face` reads all samples for each of M faces, or of 2^M where few have a solution. Memory: M² + M
///          numbers, with `project` M²(M + 3)/2 more, with `best_face` every sample.
/// - |f| stands for f.
/// - The equations depend on the parametrisation of x, as L2 does; the fit of `project` does not.
/// - The prior adds prior/n · P_kk (α_k − π_k) to equation k.
template <class Real, int M, negative_fractions Treatment = negative_fractions::project, class Table = no_table>
class linear_heuristic : public rule_base<Real, M, detail::linear_memory<Real, M, Treatment, Table>> {
  using memory_type = detail::linear_memory<Real, M, Treatment, Table>;

  static_assert((Treatment == negative_fractions::best_face) != std::is_same<Table, no_table>::value,
                "best_face needs a table of samples, the other treatments take none");
  static_assert(M >= 2, "linear_heuristic needs two techniques to choose from");
  static_assert(M <= 30, "faces are counted in the bits of an int");

 public:
  PHIMIS_HOST_DEVICE linear_heuristic() noexcept : linear_heuristic(rule_options<Real, M>{}) {}
  PHIMIS_HOST_DEVICE explicit linear_heuristic(const rule_options<Real, M>& options) noexcept
      : rule_base<Real, M, memory_type>(options) {}

  PHIMIS_HOST_DEVICE void observe(const observation<Real, M>& sample) {
    const int k = sample.technique;
    PHIMIS_EXPECTS(k >= 0 && k < M);
    row<Real, M> row;  // which drop_most_negative only checks
    if (!this->admit(sample, row)) return;
    this->memory().sums.add(sample);
    if constexpr (Treatment == negative_fractions::project) this->memory().projection.add(row);
    if constexpr (Treatment == negative_fractions::best_face) keep(k, row);
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    const movable_techniques<M> on(this->options_);
    const linear_equations<M> equations = equations_of_sums();
    double total = 0;
    for (int k = 0; k < M; ++k) total += equations.f[k];
    if (!(total > 0) || !on.any()) return this->end(rule_status::no_information);

    double tau[M];
    const bool solved = equations.solve(on, on.all(), tau);
    if (solved) count_left(on.at(tau));
    if (!solved || !on.feasible(tau)) {
      bool treated = false;
      if constexpr (Treatment == negative_fractions::drop_most_negative) {
        treated = solved && equations.drop_most_negative(on, tau);
      } else if constexpr (Treatment == negative_fractions::best_face) {
        const auto variance = [this](const phimis::fractions<double, M>& alpha) { return sample_variance(alpha); };
        treated = equations.complete(on) && equations.best_face(on, variance, tau);
      } else {
        treated = this->memory().projection.fit(on, this->options_.start, this->options_.prior, admitted(), tau);
      }
      if (!treated) return this->end(solved ? rule_status::not_converged : rule_status::no_information);
    }
    const phimis::fractions<double, M> alpha = on.at(tau);
    for (int k = 0; k < M; ++k) this->state_.fractions[k] = static_cast<Real>(alpha[k]);
    return this->end(rule_status::updated);
  }

  /// Adds the observations of another state, in any grouping; fractions stay until the next update.
  PHIMIS_HOST_DEVICE void merge(const linear_heuristic& other) {
    this->state_.counters.merge(other.state_.counters);
    this->memory().sums.merge(other.memory().sums);
    if constexpr (Treatment == negative_fractions::project)
      this->memory().projection.merge(other.memory().projection);
    if constexpr (Treatment == negative_fractions::best_face) {
      for (int k = 0; k < M; ++k) {
        const std::ptrdiff_t theirs = other.memory().samples[k].size();  // `other` may be this
        for (std::ptrdiff_t j = 0; j < theirs; ++j) keep(k, other.memory().samples[k][j]);
      }
    }
  }

 private:
  static constexpr double rounding = static_cast<double>(epsilon<Real>);

  PHIMIS_HOST_DEVICE double admitted() const noexcept {
    return static_cast<double>(this->counters().observations - this->counters().nonfinite);
  }

  PHIMIS_HOST_DEVICE void keep(int technique, const row<Real, M>& row) {
    if (!this->memory().samples[technique].push(row)) {
      ++this->state_.counters.dropped;
    } else if (row.u > this->memory().largest) {
      this->memory().largest = row.u;
    }
  }

  PHIMIS_HOST_DEVICE void count_left(const phimis::fractions<double, M>& alpha) noexcept {
    for (int k = 0; k < M; ++k) {
      if (!(alpha[k] < 0)) continue;
      ++this->state_.counters.left;
      return;
    }
  }

  PHIMIS_HOST_DEVICE linear_equations<M> equations_of_sums() const noexcept {
    linear_equations<M> result{};
    result.rounding = rounding;
    const technique_sums<Real, M>& sums = this->memory().sums;
    const double n = admitted();
    for (int k = 0; k < M; ++k) {
      result.f[k] = sums.f(k);
      const double pull = n > 0 ? static_cast<double>(this->options_.prior) / n * sums.p(k, k) : 0;
      for (int i = 0; i < M; ++i) {
        result.p[i][k] = sums.p(i, k) + pull * ((i == k ? 1 : 0) - static_cast<double>(this->options_.start[k]));
      }
    }
    return result;
  }

  /// L Eq. 19, from each technique's own samples; in a unit that all mixtures share.
  PHIMIS_HOST_DEVICE double sample_variance(const phimis::fractions<double, M>& alpha) const noexcept {
    const double unit = static_cast<double>(this->memory().largest);
    double variance = 0;
    for (int k = 0; k < M; ++k) {
      const Table& samples = this->memory().samples[k];
      const std::ptrdiff_t n = samples.size();
      if (!(alpha[k] > 0) || n == 0) continue;
      moments<double> t;
      for (std::ptrdiff_t j = 0; j < n; ++j) {
        const row<Real, M> row = samples[j];
        double x = 0;
        for (int i = 0; i < M; ++i) x += alpha[i] * static_cast<double>(row.y[i]);
        t.add(row.u > 0 ? static_cast<double>(row.u) / unit / x : 0);
      }
      variance += alpha[k] * t.squares / static_cast<double>(n);
    }
    return variance;
  }
};

}  // namespace phimis

#endif  // PHIMIS_CORE_LINEAR_HEURISTIC_HPP
