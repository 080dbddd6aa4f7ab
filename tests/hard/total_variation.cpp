// SPDX-License-Identifier: MIT
// Total variation, whose score is a step: random problems, each against a bound that is computed here.
//
// With g = f/μ̂ and s − s(0) = 1 where g > p, else 0, the objective is −Σ min(p_j, g_j)/q_j, a linear program. Any numbers
// 0 ≤ s_j ≤ 1 bound it from below,
//
//     −Σ min(p_j, g_j)/q_j ≥ −max_k Σ s_j p_kj/q_j − Σ (1 − s_j) g_j/q_j   for all α,
//
// since min(p, g) ≤ s p + (1 − s) g. Good ones are the scores of √((t − 1)² + ε²)/2. For two and three techniques
// the minimum is where m − 1 rows have g = p, or fractions are 0: all such points are tried. A difference is relative to
// Σ g_j/q_j = n, the largest that the sum can be.
#include "catch.hpp"
#include "random_problems.hpp"

#include <phimis/solver/minimise.hpp>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using phimis::control_variate;
using phimis::rule_status;

std::uint64_t seed_of_run() {
  const char* given = std::getenv("PHIMIS_SEED");
  return given ? std::strtoull(given, nullptr, 10) : 1;
}

struct step_problem {
  MatrixXd columns;  // p_k/q
  VectorXd g;        // f/(μ̂ q)

  explicit step_problem(const random_problem& on)
      : columns(on.q.cwiseInverse().asDiagonal() * on.pdfs), g(on.f.cwiseQuotient(on.q)) {
    g /= g.mean();
  }

  double objective(const VectorXd& alpha) const {
    return -(columns * alpha).cwiseMin(g).sum() / static_cast<double>(g.size());
  }

  /// A lower bound of the objective, the best of several roundings of the step at these fractions.
  double bound(const VectorXd& alpha) const {
    double best = -1;
    const VectorXd p = columns * alpha;
    for (const double width : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
      VectorXd s(g.size());
      for (int j = 0; j < g.size(); ++j) {
        if (!(p[j] > 0)) {
          s[j] = g[j] > 0 ? 1 : 0;
          continue;
        }
        const double off = g[j] / p[j] - 1;
        s[j] = std::clamp(0.5 + (off - width * width) / (2 * std::hypot(off, width)), 0.0, 1.0);
      }
      const double value = -(columns.transpose() * s).maxCoeff() - (VectorXd::Ones(g.size()) - s).dot(g);
      best = std::max(best, value / static_cast<double>(g.size()));
    }
    return best;
  }

  double minimum_of_two() const {
    double least = std::min(objective(VectorXd::Unit(2, 0)), objective(VectorXd::Unit(2, 1)));
    for (int j = 0; j < g.size(); ++j) {
      const double alpha = (g[j] - columns(j, 1)) / (columns(j, 0) - columns(j, 1));
      if (alpha > 0 && alpha < 1) least = std::min(least, objective(VectorXd{{alpha, 1 - alpha}}));
    }
    return least;
  }

  double minimum_of_three() const {
    const auto n = static_cast<int>(g.size());
    // Rows g = p, then the faces α_k = 0, then Σ α = 1.
    MatrixXd lines(n + 3, 3);
    lines << columns, MatrixXd::Identity(3, 3);
    VectorXd values(n + 3);
    values << g, VectorXd::Zero(3);
    double least = 0;
    for (int i = 0; i < n + 3; ++i) {
      for (int j = 0; j < i; ++j) {
        Eigen::Matrix3d equations;
        equations << lines.row(i), lines.row(j), Eigen::RowVector3d::Ones();
        const Eigen::FullPivLU<Eigen::Matrix3d> factors(equations);
        if (!factors.isInvertible()) continue;
        const VectorXd alpha = factors.solve(Eigen::Vector3d(values[i], values[j], 1));
        if (alpha.minCoeff() < -1e-12) continue;
        least = std::min(least, objective(alpha.cwiseMax(0) / alpha.cwiseMax(0).sum()));
      }
    }
    return least;
  }
};

/// Whether the minimum was found; where it was not, the status and the residual must say so.
template <class D>
bool check(const D& divergence, const random_problem& on, const step_problem& exact, double least) {
  phimis::minimise_options options;
  options.start = on.start;
  options.variate = control_variate::off;
  const phimis::minimum found = phimis::minimise(divergence, on.f, on.pdfs, on.q, options);
  INFO(on.rows() << " rows, " << on.techniques() << " techniques, status " << static_cast<int>(found.status) << ", "
                 << found.evaluations << " evaluations, residual " << found.residual << ", gap " << found.gap);
  REQUIRE(found.fractions.size() == on.pdfs.cols());
  CHECK(found.fractions.minCoeff() >= 0);
  CHECK(std::fabs(found.fractions.sum() - 1) <= 1e-15 * on.techniques());
  const double above = exact.objective(found.fractions) - least;
  INFO("above the minimum by " << above);
  CHECK(above >= -1e-12);
  if (found.status == rule_status::not_converged) {
    CHECK(found.residual > 1e-10);
    return false;
  }
  CHECK(found.status == rule_status::updated);
  // What the solver promises, and the rounding of two sums.
  CHECK(above <= found.gap * found.lambda / on.rows() + 1e-14);
  return true;
}

/// Small, of all techniques' masses near 1, without what is wide. Starts, too, are cut to so many techniques.
random_problem some_problem(std::uint64_t seed, int techniques) {
  constexpr problem_kind kinds[] = {
      problem_kind::bumps,         problem_kind::dirichlet,  problem_kind::sparse,
      problem_kind::duplicates,    problem_kind::vertex,     problem_kind::zeros,
      problem_kind::zero_variance, problem_kind::fewer_rows, problem_kind::dominant_row};
  random_problem on = make_problem(kinds[seed % 9], seed, 30, 1000);
  if (techniques > 0) {
    while (on.techniques() < techniques) {
      seed += 9;
      on = make_problem(kinds[seed % 9], seed, 30, 1000);
    }
    const Eigen::Index rows = std::min<Eigen::Index>(on.pdfs.rows(), techniques == 3 ? 60 : 1000);
    on.pdfs = on.pdfs.topLeftCorner(rows, techniques).eval();
    on.f = on.f.head(rows).eval();
    on.q = on.q.head(rows).eval();
    if (on.start.size() > 0) on.start = on.start.head(techniques).eval();
    if (on.start.size() > 0 && on.start.sum() > 0) on.start /= on.start.sum();
    if (!(on.start.sum() > 0)) on.start.resize(0);
    for (int j = 0; j < rows; ++j) {
      if (!(on.pdfs.row(j).maxCoeff() > 0)) on.f[j] = 0;
    }
  }
  if (!(on.f.maxCoeff() > 0)) {  // or there would be nothing to learn
    on.pdfs(0, 0) = 1;
    on.f[0] = 1;
  }
  return on;
}

}  // namespace

// A row that dominates few others may leave nothing of the last digits of a rounded kink: of three techniques once in 1200
// problems, of many in none to two of sixty (PHIMIS_SEED=1 to 5). Then the status must say so, which `check` checks.
TEST_CASE("Total variation of two techniques is minimised to the vertex of its linear program") {
  int unsolved = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    INFO("PHIMIS_SEED=" << seed_of_run() << " problem " << i);
    const random_problem on = some_problem(seed_of_run() * 1000000 + i, 2);
    const step_problem exact(on);
    unsolved += check(phimis::total_variation{}, on, exact, exact.minimum_of_two()) ? 0 : 1;
  }
  CHECK(unsolved == 0);
}

TEST_CASE("Total variation of three techniques is minimised to the vertex of its linear program") {
  int unsolved = 0;
  for (std::uint64_t i = 0; i < 30; ++i) {
    INFO("PHIMIS_SEED=" << seed_of_run() << " problem " << i);
    const random_problem on = some_problem(seed_of_run() * 2000000 + i, 3);
    const step_problem exact(on);
    unsolved += check(phimis::total_variation{}, on, exact, exact.minimum_of_three()) ? 0 : 1;
    unsolved += check(phimis::pearson_vajda{1}, on, exact, exact.minimum_of_three()) ? 0 : 1;
  }
  CHECK(unsolved <= 2);  // one problem, both divergences
}

TEST_CASE("Total variation of many techniques is minimised to within a dual bound, or says that it is not") {
  int unsolved = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    INFO("PHIMIS_SEED=" << seed_of_run() << " problem " << i);
    const random_problem on = some_problem(seed_of_run() * 3000000 + i, 0);
    const step_problem exact(on);
    phimis::minimise_options options;
    options.variate = control_variate::off;
    const VectorXd at = phimis::minimise(phimis::total_variation{}, on.f, on.pdfs, on.q, options).fractions;
    // At a vertex of two techniques the score of a single row decides, which a rounded step misses by up to 1/n.
    const double least = on.techniques() == 2 ? exact.minimum_of_two() : exact.bound(at);
    unsolved += check(phimis::total_variation{}, on, exact, least) ? 0 : 1;
  }
  CHECK(unsolved <= 2);
}
