// SPDX-License-Identifier: MIT
#ifndef PHIMIS_SOLVER_MINIMISE_HPP
#define PHIMIS_SOLVER_MINIMISE_HPP

#include <phimis/concepts.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/minimise_rows.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/error.hpp>
#include <phimis/solver/row_matrix.hpp>
#include <phimis/validate.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace phimis {

/// What `minimise` may be told. Vectors of length m; an empty one is its default.
struct minimise_options {
  Eigen::VectorXd start{};    ///< where to start, and the centre of the prior; equal by default
  Eigen::VectorXd floors{};   ///< least fractions; 0 by default
  Eigen::VectorXd costs{};    ///< of a sample of each technique; 1 by default
  std::vector<int> frozen{};  ///< techniques, from 0, whose fraction stays at the start's
  double prior = 0;           ///< weight of the start, in observations
  double tolerance = 0;       ///< of the residual, at which to stop; below it, as far as rounding lets it
  control_variate variate = control_variate::on;
  /// Threads of the host, from 10⁵ observations on; none by default. The result is the same to the last bit. Must not throw.
  parallel_for run{};
};

/// The best fractions, and the certificate that they are.
struct minimum {
  Eigen::VectorXd fractions;
  rule_status status = rule_status::no_information;
  int iterations = 0;
  int evaluations = 0;             ///< of the gradient; of three techniques or more also those of a sixteenth of many rows
  double lambda = 0;               ///< Σ_j p_j/q_j |s(t_j)|, in a unit of f that the solver chose
  double residual = 0;             ///< of the conditions of optimality on all coordinates, over λ
  double gap = 0;                  ///< the objective is within gap · λ of its minimum, where it is convex
  rule_counters<double> counters;  ///< of the observations
};

namespace detail {

inline Eigen::VectorXd or_default(const Eigen::VectorXd& given, Eigen::Index m, double value, const char* name) {
  if (given.size() == 0) return Eigen::VectorXd::Constant(m, value);
  require(given.size() == m, name, "must have one entry for each of " + std::to_string(m) + " techniques",
          given.size());
  return given;
}

}  // namespace detail

/// The fractions of any number of techniques that minimise a divergence on observations.
///
///     min_α Σ_j (p_j/q_j) φ(g_j/p_j) + prior · D(π, α),   α_k ≥ floor_k,   Σ α_k = 1
///
///     auto best = phimis::minimise(phimis::kullback_leibler{}, f, pdfs, q);
///
/// The rules' `exact_minimiser` for data that lie in matrices and for a number of techniques that is known when it runs. A
/// technique without density at any observation gets its floor, unless the prior has a share for it. So does one that has no share
/// of a prior under a reversed divergence: anything else would be infinitely far from the start.
///
/// Shapes   f[n], pdfs[n × m], q[n]: the density that each observation was drawn from.
/// Errors   std::invalid_argument for wrong shapes and options out of range. Observations that are not finite are
///          counted and left out.
/// Cost     memory for n numbers, for n (m + 3) where rows are copied (`row_matrix`); an iteration reads all two or three times.
template <divergence Divergence>
minimum minimise(const Divergence& divergence, const Eigen::Ref<const Eigen::VectorXd>& f,
                 const Eigen::Ref<const Eigen::MatrixXd>& pdfs, const Eigen::Ref<const Eigen::VectorXd>& q,
                 const minimise_options& options = {}) {
  validate(divergence);
  const Eigen::Index n = f.size();
  const Eigen::Index m = pdfs.cols();
  require(m >= 1 && m <= 10000, "pdfs", "must have a column for each technique, 1 to 10000", m);
  require(pdfs.rows() == n, "pdfs", "must have a row for each of " + std::to_string(n) + " values of f", pdfs.rows());
  require(q.size() == n, "q", "must have an entry for each of " + std::to_string(n) + " values of f", q.size());
  require(n >= 1, "f", "must have at least one observation", n);
  Eigen::VectorXd start = detail::or_default(options.start, m, 1.0 / static_cast<double>(m), "start");
  const Eigen::VectorXd floors = detail::or_default(options.floors, m, 0, "floors");
  const Eigen::VectorXd costs = detail::or_default(options.costs, m, 1, "costs");
  const auto count = static_cast<std::size_t>(m);
  const auto frozen = std::make_unique<bool[]>(count);
  for (const int k : options.frozen) {
    require(k >= 0 && k < m, "frozen", "must be techniques from 0 to " + std::to_string(m - 1), k);
    frozen[static_cast<std::size_t>(k)] = true;
  }
  validate<double>(std::span(start.data(), count), std::span(floors.data(), count), std::span(costs.data(), count),
                   std::span(frozen.get(), count), options.prior);
  validate_costs<double>(divergence, std::span(costs.data(), count));
  require(is_density(options.tolerance), "tolerance", "must be finite and not negative", options.tolerance);
  if ((start - floors).minCoeff() < 0) {
    Eigen::VectorXd least = floors;  // of each fraction; a frozen one has no floor
    for (Eigen::Index k = 0; k < m; ++k) {
      if (frozen[static_cast<std::size_t>(k)]) least[k] = start[k];
    }
    const Eigen::VectorXd above = (start - least).cwiseMax(0);
    if (above.sum() > 0 && (start - least).minCoeff() < 0) {
      start = least + std::max(1 - least.sum(), 0.0) * above / above.sum();
    }
  }
  minimum result{.fractions = start, .counters = {}};
  const row_matrix rows(f, pdfs, q, detail::is_variance<Divergence>::value, options.run);
  result.counters = rows.counters();
  if (result.counters.zero > 0 && infinite_at_zero(divergence)) {
    result.status = rule_status::infinite_divergence;
    return result;
  }
  if (!(rows.largest() > 0)) return result;

  std::vector<double> memory(static_cast<std::size_t>(minimise_doubles<Divergence>(static_cast<int>(m))));
  std::vector<int> indices(static_cast<std::size_t>(minimise_indices(static_cast<int>(m))));
  const minimisation<double> wanted{.start = start.data(),
                                    .from = start.data(),
                                    .floors = floors.data(),
                                    .costs = costs.data(),
                                    .frozen = frozen.get(),
                                    .prior = options.prior,
                                    .tolerance = options.tolerance,
                                    .variate = options.variate};
  const row_minimum found = minimise_rows<0>(divergence, rows.view(), rows.largest(), wanted, memory.data(),
                                             indices.data(), result.fractions.data());
  result.status = found.status;
  result.iterations = found.solution.iterations;
  result.evaluations = found.solution.evaluations;
  result.lambda = found.solution.lambda;
  result.residual = found.solution.residual;
  result.gap = found.solution.gap;
  return result;
}

}  // namespace phimis

#endif  // PHIMIS_SOLVER_MINIMISE_HPP
