// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_RANDOM_PROBLEMS_HPP
#define PHIMIS_TESTS_RANDOM_PROBLEMS_HPP

#include "random.hpp"
#include "subnormals.hpp"

#include <phimis/core/divergence.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

/// What makes a random problem hard for a minimiser.
enum class problem_kind {
  bumps,            ///< Gaussian bumps, samples of their equal mixture, f near a mixture of a few
  dirichlet,        ///< pdfs are independent gamma numbers: many are near 0
  sparse,           ///< a row is reached by few techniques
  disjoint,         ///< every row by one
  zeros,            ///< f = 0 in most rows, some of which no technique reaches
  dead,             ///< techniques that reach no row
  duplicates,       ///< techniques that are the same
  near_duplicates,  ///< techniques that differ by 1e-3 to 1e-15
  dependent,        ///< techniques that are mixtures of others: the minimiser is not unique
  fewer_rows,       ///< n < m
  wide_f,           ///< f times 1e-30 to 1e30
  wide_pdfs,        ///< pdfs times 1e-30 to 1e30, each by itself
  wide_measure,     ///< pdfs, q and f of a row times the same 1e-30 to 1e30
  wide_q,           ///< q times 1e-30 to 1e30
  wide_everything,  ///< f, pdfs and q, each by itself
  vertex,           ///< one technique is f but for little noise
  dominant_row,     ///< one row has all but 1e-3 to 1e-30 of f
  zero_variance     ///< f is a mixture
};

/// A minimisation problem: n rows of f, q and m pdfs. Empty start and floors are the defaults.
struct random_problem {
  Eigen::VectorXd f;
  Eigen::MatrixXd pdfs;
  Eigen::VectorXd q;
  Eigen::VectorXd start{};
  Eigen::VectorXd floors{};

  int rows() const { return static_cast<int>(pdfs.rows()); }
  int techniques() const { return static_cast<int>(pdfs.cols()); }
};

namespace detail {

inline double normal(random_numbers& random) {
  const double radius = std::sqrt(-2 * std::log(1 - random()));
  return radius * std::cos(6.283185307179586 * random());
}

/// Of shape 0 < a < 1: by Ahrens & Dieter's rejection.
inline double gamma_number(random_numbers& random, double a) {
  for (;;) {
    const double p = (1 + a / 2.718281828459045) * random();
    const double e = -std::log(1 - random());
    const double x = p <= 1 ? std::pow(p, 1 / a) : -std::log((1 + a / 2.718281828459045 - p) / a);
    if (p <= 1 ? x <= e : (a - 1) * std::log(x) >= -e) return x > 1e-30 ? x : 0;
  }
}

/// Fractions of which about `share` are not 0; at least one is not.
inline Eigen::VectorXd some_fractions(random_numbers& random, int m, double share) {
  Eigen::VectorXd fractions(m);
  for (int k = 0; k < m; ++k) fractions[k] = random() < share ? -std::log(1 - random()) : 0;
  fractions[random.below(m)] += 1e-3 + random();
  return fractions / fractions.sum();
}

/// Bumps on the line: x is drawn from a technique at random, q is their equal mixture.
inline random_problem bumps(random_numbers& random, int n, int m) {
  std::vector<double> centre(static_cast<std::size_t>(m));
  std::vector<double> width(static_cast<std::size_t>(m));
  for (double& c : centre) c = random();
  for (double& w : width) w = random.over_decades(0.01, 1);
  random_problem on{Eigen::VectorXd(n), Eigen::MatrixXd(n, m), Eigen::VectorXd(n)};
  for (int j = 0; j < n; ++j) {
    const auto from = static_cast<std::size_t>(random.below(m));
    const double x = centre[from] + width[from] * normal(random);
    for (int k = 0; k < m; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double z = (x - centre[i]) / width[i];
      // Zero where it would be below 1e-30.
      on.pdfs(j, k) = z * z < 138 ? std::exp(-z * z / 2) / (2.5066282746310002 * width[i]) : 0;
    }
  }
  on.q = on.pdfs.rowwise().mean();
  return on;
}

inline random_problem dirichlet(random_numbers& random, int n, int m) {
  random_problem on{Eigen::VectorXd(n), Eigen::MatrixXd(n, m), Eigen::VectorXd(n)};
  const double shape = random.over_decades(0.1, 0.99);
  for (int k = 0; k < m; ++k) {
    for (int j = 0; j < n; ++j) on.pdfs(j, k) = gamma_number(random, shape);
  }
  on.q = on.pdfs * some_fractions(random, m, 1);
  return on;
}

/// Each row is reached by `reach` techniques at most; each technique reaches a row.
inline random_problem sparse(random_numbers& random, int n, int m, int reach) {
  random_problem on{Eigen::VectorXd(n), Eigen::MatrixXd::Zero(n, m), Eigen::VectorXd(n)};
  for (int j = 0; j < n; ++j) {
    on.pdfs(j, j < m ? j : random.below(m)) = random.over_decades(0.01, 10);
    for (int i = 1; i < reach; ++i) on.pdfs(j, random.below(m)) = random.over_decades(0.01, 10);
  }
  on.q = on.pdfs.rowwise().mean();
  return on;
}

inline void multiply_by_decades(random_numbers& random, Eigen::Ref<Eigen::VectorXd> values, double decades) {
  for (auto& value : values) value *= random.over_decades(std::pow(10, -decades), std::pow(10, decades));
}

}  // namespace detail

/// The problem of a kind that has this seed. Most are small: n up to `most_rows`, log-uniformly to the fourth power. What is
/// wide is so over twice as many decades.
inline random_problem make_problem(problem_kind kind, std::uint64_t seed, double decades = 30,
                                   int most_rows = 100000) {
  random_numbers random(seed);
  int m = static_cast<int>(std::lround(random.over_decades(2, 64)));
  int n = static_cast<int>(50 * std::pow(most_rows / 50.0, std::pow(random(), 4)));
  while (double(n) * m * m > 4e6 && m > 4) m /= 2;  // the Hessian of a large problem must not cost a minute
  if (kind == problem_kind::fewer_rows) {
    m = std::max(m, 3);
    n = 1 + random.below(m - 1);
  }

  random_problem on;
  switch (kind) {
    case problem_kind::dirichlet:
      on = detail::dirichlet(random, n, m);
      break;
    case problem_kind::sparse:
      on = detail::sparse(random, n, m, 3);
      break;
    case problem_kind::disjoint:
      on = detail::sparse(random, n, m, 1);
      break;
    default:
      on = random() < 0.6 ? detail::bumps(random, n, m) : detail::dirichlet(random, n, m);
  }

  // What changes pdfs comes before f, which is made of them.
  const auto any_two = [&] {
    const int first = random.below(m);
    return std::pair{first, (first + 1 + random.below(m - 1)) % m};
  };
  if (kind == problem_kind::duplicates || kind == problem_kind::near_duplicates) {
    for (int i = 0; i < 1 + m / 4; ++i) {
      const auto [from, to] = any_two();
      on.pdfs.col(to) = on.pdfs.col(from);
      if (kind == problem_kind::duplicates) continue;
      const double apart = random.over_decades(1e-15, 1e-3);
      for (int j = 0; j < n; ++j) on.pdfs(j, to) *= 1 + apart * detail::normal(random);
    }
    on.pdfs = on.pdfs.cwiseMax(0).eval();
    on.q = on.pdfs.rowwise().mean();
  }
  if (kind == problem_kind::dependent) {
    for (int i = 0; i < 1 + m / 4; ++i) {
      const int to = random.below(m);
      Eigen::VectorXd of = detail::some_fractions(random, m, 0.3);
      of[to] = 0;
      if (of.sum() > 0) on.pdfs.col(to) = (on.pdfs * (of / of.sum())).eval();
    }
    on.q = on.pdfs.rowwise().mean();
  }
  if (kind == problem_kind::wide_pdfs || kind == problem_kind::wide_everything) {
    for (int k = 0; k < m; ++k) detail::multiply_by_decades(random, on.pdfs.col(k), decades);
    on.q = on.pdfs.rowwise().mean();
  }

  on.f = on.pdfs * detail::some_fractions(random, m, random.over_decades(0.05, 1));
  if (kind == problem_kind::vertex) on.f = on.pdfs.col(random.below(m));
  if (kind != problem_kind::zero_variance) {
    const double noise = kind == problem_kind::vertex ? random.over_decades(1e-6, 0.1) : random.over_decades(0.01, 2);
    for (auto& value : on.f) value *= std::exp(noise * detail::normal(random));
  }

  if (kind == problem_kind::zeros) {
    const double share = random.between(0.3, 0.99);
    for (int j = 1; j < n; ++j) {
      if (random() < share) on.f[j] = 0;
      if (on.f[j] == 0 && random() < 0.1) on.pdfs.row(j).setZero();
    }
  }
  if (kind == problem_kind::wide_f || kind == problem_kind::wide_everything) {
    detail::multiply_by_decades(random, on.f, decades);
  }
  if (kind == problem_kind::wide_q || kind == problem_kind::wide_everything) {
    detail::multiply_by_decades(random, on.q, decades);
  }
  if (kind == problem_kind::wide_measure) {
    for (int j = 0; j < n; ++j) {
      const double unit = random.over_decades(std::pow(10, -decades), std::pow(10, decades));
      on.pdfs.row(j) *= unit;
      on.f[j] *= unit;
      on.q[j] *= unit;
    }
  }
  if (kind == problem_kind::dominant_row) on.f[random.below(n)] *= random.over_decades(1e3, 1e30);
  if (kind == problem_kind::dead) {
    for (int i = 0; i < 1 + m / 4; ++i) on.pdfs.col(random.below(m - 1)).setZero();  // the last stays
    on.q = on.pdfs.rowwise().mean();
  }
  if (subnormals_are_zero()) {
    // The solver is given zeros; long double, which knows more, must be, too.
    const auto flushed = [](double x) { return x < std::numeric_limits<double>::min() ? 0 : x; };
    on.pdfs = on.pdfs.unaryExpr(flushed).eval();
    on.f = on.f.unaryExpr(flushed).eval();
    on.q = on.q.unaryExpr(flushed).eval();
  }
  // A row that no technique reaches is a lost sample: f = 0. What drew it had a density.
  for (int j = 0; j < n; ++j) {
    if (!(on.pdfs.row(j).maxCoeff() > 0)) on.f[j] = 0;
    if (!(on.q[j] > 0)) on.q[j] = 1;
  }

  const double which = random();
  if (which < 0.25) {
    on.start = Eigen::VectorXd::Zero(m);
    on.start[random.below(m)] = 1;
  } else if (which < 0.4) {
    on.start = detail::some_fractions(random, m, 0.3);
  }
  if (random() < 0.25) {
    const double sums[] = {0.02, 0.3, 0.9};
    on.floors = sums[random.below(3)] * detail::some_fractions(random, m, 0.7);
  }
  return on;
}

/// f(name, divergence) for one of the divergences that a minimiser of smooth problems takes.
inline constexpr int smooth_divergences = 20;
template <class F>
void with_smooth_divergence(int which, F&& f) {
  using phimis::reversed;
  using phimis::tsallis;
  switch (which) {
    case 0:
      return f("Tsallis 0.1", tsallis{0.1});
    case 1:
      return f("Tsallis 0.5", tsallis{0.5});
    case 2:
      return f("Tsallis 1", tsallis{1});
    case 3:
      return f("Tsallis 1.5", tsallis{1.5});
    case 4:
      return f("Tsallis 2", tsallis{2});
    case 5:
      return f("Tsallis 4", tsallis{4});
    case 6:
      return f("Tsallis 8", tsallis{8});
    case 7:
      return f("Kullback-Leibler", phimis::kullback_leibler{});
    case 8:
      return f("Hellinger", phimis::hellinger{});
    case 9:
      return f("chi squared", phimis::chi_squared{});
    case 10:
      return f("reversed Tsallis 0.1", reversed<tsallis>{{0.1}});
    case 11:
      return f("reversed Hellinger", reversed<phimis::hellinger>{});
    case 12:
      return f("reversed Kullback-Leibler", reversed<phimis::kullback_leibler>{});
    case 13:
      return f("reversed Tsallis 1.5", reversed<tsallis>{{1.5}});
    case 14:
      return f("reversed chi squared", reversed<phimis::chi_squared>{});
    case 15:
      return f("reversed Tsallis 4", reversed<tsallis>{{4}});
    case 16:
      return f("Pearson-Vajda 2", phimis::pearson_vajda{2});
    case 17:
      return f("Pearson-Vajda 3", phimis::pearson_vajda{3});
    case 18:
      return f("reversed Pearson-Vajda 2", reversed<phimis::pearson_vajda>{{2}});
    default:
      return f("reversed Pearson-Vajda 3", reversed<phimis::pearson_vajda>{{3}});
  }
}

#endif  // PHIMIS_TESTS_RANDOM_PROBLEMS_HPP
