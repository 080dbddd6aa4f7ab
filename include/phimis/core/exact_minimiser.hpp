// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_EXACT_MINIMISER_HPP
#define PHIMIS_CORE_EXACT_MINIMISER_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/minimisation.hpp>
#include <phimis/core/minimise_rows.hpp>
#include <phimis/core/row_parts.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/table.hpp>

#include <cstddef>

namespace phimis {

namespace detail {

template <class Table>
struct minimiser_memory {
  Table table{};
  typename Table::real largest = 0;  // |u|
  bool zeros = false;
  int evaluations = 0;
  double residual = 0;
  double gap = 0;
};

}  // namespace detail

/// The fractions that minimise a divergence on all observations ever made, solved to a KKT certificate.
///
///     min_α Σ_j (p_j/q_j) φ(g_j/p_j) + prior · D(π, α),   α_k ≥ floor_k,   Σ α_k = 1
///
/// Table     where rows are kept: fixed_table, or table, which grows.
/// Requires  each observation with the density q_j that it was drawn from, however long ago.
/// Errors    `status()`; `residual()` is the KKT residual on all coordinates relative to λ, `gap()` bounds what the
///           objective has left, in units of λ; infinite where it is not convex. A technique that no observation has a density of keeps its fraction.
/// Cost      as `pair_minimisation` for two techniques, `row_minimisation` for more; for these, on the stack,
///           8 · minimise_doubles(M) bytes: 9 kB for 16 techniques.
///
/// Source T Eqs. 16, 18, 25; costs as in `row_minimisation`.
template <class Divergence, class Table>
class exact_minimiser : public rule_base<typename Table::real, Table::techniques, detail::minimiser_memory<Table>> {
  static_assert(Table::techniques >= 2, "exact_minimiser needs two techniques to choose from");

 public:
  using Real = typename Table::real;
  static constexpr int M = Table::techniques;

  PHIMIS_HOST_DEVICE exact_minimiser() noexcept : exact_minimiser(Divergence{}) {}
  PHIMIS_HOST_DEVICE explicit exact_minimiser(const Divergence& divergence, const rule_options<Real, M>& options = {},
                                              phimis::control_variate variate = control_variate::on) noexcept
      : rule_base<Real, M, detail::minimiser_memory<Table>>(options), divergence_(divergence), variate_(variate) {}

  PHIMIS_HOST_DEVICE const Divergence& divergence() const noexcept { return divergence_; }
  PHIMIS_HOST_DEVICE const Table& table() const noexcept { return this->memory().table; }
  PHIMIS_HOST_DEVICE double residual() const noexcept { return this->memory().residual; }
  PHIMIS_HOST_DEVICE double gap() const noexcept { return this->memory().gap; }
  PHIMIS_HOST_DEVICE int evaluations() const noexcept { return this->memory().evaluations; }

  PHIMIS_HOST_DEVICE void observe(const observation<Real, M>& sample) {
    row<Real, M> row;
    if (!this->admit(sample, row)) return;
    if (detail::is_variance<Divergence>::value && sample.f < 0) row.u = -row.u;
    keep(row);
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    if (this->memory().zeros && infinite_at_zero(divergence_)) {
      return this->end(rule_status::infinite_divergence);
    }
    if (!(this->memory().largest > 0)) return this->end(rule_status::no_information);
    const auto& options = this->options_;
    const phimis::fractions<Real, M> from = this->state_.fractions;
    minimisation<Real> wanted{};
    wanted.start = options.start.value;
    wanted.from = from.value;
    wanted.floors = options.floors.value;
    wanted.costs = options.costs.value;
    wanted.frozen = options.frozen.value;
    wanted.prior = options.prior;
    wanted.variate = variate_;
    wanted.silent = silent_technique::kept;
    const row_minimum found = minimise(wanted);
    if (found.status != rule_status::no_information) {
      this->memory().residual = found.solution.residual;
      this->memory().gap = found.solution.gap;
      this->memory().evaluations = found.solution.evaluations;
    }
    return this->end(found.status);
  }

  /// Adds the observations of another state; fractions stay until the next update.
  PHIMIS_HOST_DEVICE void merge(const exact_minimiser& other) {
    this->state_.counters.merge(other.state_.counters);
    const std::ptrdiff_t theirs = other.memory().table.size();  // `other` may be this
    for (std::ptrdiff_t j = 0; j < theirs; ++j) keep(other.memory().table[j]);
  }

 private:
  PHIMIS_HOST_DEVICE void keep(const row<Real, M>& row) {
    if (!this->memory().table.push(row)) {
      ++this->state_.counters.dropped;
      return;
    }
    const Real size = row.u < 0 ? -row.u : row.u;
    if (size > this->memory().largest) this->memory().largest = size;
    if (!(size > 0)) this->memory().zeros = true;
  }

  PHIMIS_HOST_DEVICE row_minimum minimise(const minimisation<Real>& wanted) noexcept {
    const columns<Real, M> rows = this->memory().table.view();
    double memory[minimise_doubles<Divergence>(M)];
    int indices[minimise_indices(M)];
    const column_pointers<Real> pointers{rows.u, rows.w, rows.y, rows.n, M};
    return minimise_rows<M>(divergence_, pointers, this->memory().largest, wanted, memory, indices,
                            this->state_.fractions.value);
  }

  Divergence divergence_;
  phimis::control_variate variate_;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_EXACT_MINIMISER_HPP
