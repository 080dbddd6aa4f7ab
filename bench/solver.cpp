// SPDX-License-Identifier: MIT
// How long does it take to find the best fractions of m techniques on n observations? Ours, the multiplicative step, and
// NLopt's SLSQP where the library was found.
//
//     bench_solver [--csv FILE] [--limit SECONDS] [--rows MOST]      a Markdown table on standard output
//
// One residual for all, of the fractions that each returns: max_k G_k/λ − 1, the duality gap relative to λ. The peers
// stop as soon as it is 1e-8; ours stops at its own tolerance, which is tighter. Peers evaluate objective and gradient in
// one pass over blocks of rows that fit into the cache. Medians over problems, of repetitions in turn. The time of one such
// evaluation is what no solver that looks at all observations can go below.

#include <phimis/solver/minimise.hpp>

#include <Eigen/Core>

#ifdef PHIMIS_BENCH_NLOPT
#include <nlopt.h>
#endif

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace {

using clock_type = std::chrono::steady_clock;
constexpr double enough = 1e-8;

double seconds_since(clock_type::time_point start) {
  return std::chrono::duration<double>(clock_type::now() - start).count();
}

struct problem {
  Eigen::VectorXd f;
  Eigen::MatrixXd pdfs;
  Eigen::VectorXd q;
};

/// m Gaussian bumps on [0, 1]; f is a mixture of a third of them times a smooth factor; x are drawn from the equal
/// mixture.
problem some_problem(int n, int m, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  const auto size = static_cast<std::size_t>(m);
  std::vector<double> centre(size), width(size), mass(size), share(size);
  for (std::size_t k = 0; k < size; ++k) {
    centre[k] = uniform(engine);
    width[k] = 0.02 * std::pow(15, uniform(engine));
    const double root = width[k] * std::sqrt(2.0);
    mass[k] = (std::erf((1 - centre[k]) / root) + std::erf(centre[k] / root)) / 2;
    share[k] = uniform(engine) < 1.0 / 3 ? uniform(engine) : 0;
  }
  share[static_cast<std::size_t>(engine() % size)] += 0.5;
  const double phase = 6 * uniform(engine);
  problem on{Eigen::VectorXd(n), Eigen::MatrixXd(n, m), Eigen::VectorXd(n)};
  for (int j = 0; j < n; ++j) {
    const auto from = static_cast<std::size_t>(engine() % size);
    double x = -1;
    while (x < 0 || x > 1) x = centre[from] + width[from] * normal(engine);
    on.f[j] = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const double z = (x - centre[k]) / width[k];
      const double pdf = std::exp(-z * z / 2) / (2.5066282746310002 * width[k] * mass[k]);
      on.pdfs(j, static_cast<int>(k)) = pdf;
      on.f[j] += share[k] * pdf;
    }
    on.f[j] *= std::exp(0.5 * std::sin(9 * x + phase));
  }
  on.q = on.pdfs.rowwise().mean();
  return on;
}

/// The objective of γ = 1, −Σ f/q log p, or of γ = 2, Σ f²/(p q), in a unit in which it and its gradient are near 1.
class objective {
 public:
  objective(const problem& on, int gamma)
      : pdfs_(on.pdfs), gamma_(gamma), weights_(on.f.cwiseQuotient(on.q)), block_(rows_of_block) {
    if (gamma == 2) weights_ = weights_.cwiseProduct(on.f).eval();
    const Eigen::VectorXd p = on.pdfs.rowwise().mean();
    weights_ /= gamma == 1 ? weights_.sum() : weights_.cwiseQuotient(p).sum();
  }

  /// The value, and G_k = Σ p_k/q s.
  double operator()(const Eigen::Ref<const Eigen::VectorXd>& alpha, Eigen::VectorXd& g) {
    g.setZero(pdfs_.cols());
    double value = 0;
    for (Eigen::Index j = 0; j < pdfs_.rows(); j += rows_of_block) {
      const Eigen::Index count = std::min<Eigen::Index>(rows_of_block, pdfs_.rows() - j);
      const auto rows = pdfs_.middleRows(j, count);
      auto p = block_.head(count);
      const auto w = weights_.segment(j, count).array();
      p.noalias() = rows * alpha;
      if (gamma_ == 1) {
        if (with_value_) value -= (w * p.array().log()).sum();
        p.array() = w / p.array();
      } else {
        p.array() = 1 / p.array();
        value += (w * p.array()).sum();
        p.array() *= w * p.array();
      }
      g.noalias() += rows.transpose() * p;
    }
    return value;
  }

  void with_value(bool wanted) { with_value_ = wanted; }

  static double residual(const Eigen::Ref<const Eigen::VectorXd>& alpha, const Eigen::VectorXd& g) {
    return g.maxCoeff() / (alpha.dot(g) / alpha.sum()) - 1;
  }

 private:
  static constexpr Eigen::Index rows_of_block = 256;
  const Eigen::MatrixXd& pdfs_;
  int gamma_;
  bool with_value_ = true;
  Eigen::VectorXd weights_;
  Eigen::VectorXd block_;
};

/// What a solver returned.
struct outcome {
  double seconds;
  double residual;
  bool in_time;
};

/// The residual of any fractions, made ones that are.
double residual_of(objective& on, Eigen::VectorXd alpha) {
  alpha = alpha.cwiseMax(0).eval();
  alpha /= alpha.sum();
  Eigen::VectorXd g;
  on(alpha, g);
  return std::max(0.0, objective::residual(alpha, g));
}

outcome ours(const problem& on, int gamma) {
  phimis::minimise_options options;
  options.variate = phimis::control_variate::off;
  options.tolerance = enough;
  const auto start = clock_type::now();
  const phimis::minimum found = gamma == 1
                                    ? phimis::minimise(phimis::kullback_leibler{}, on.f, on.pdfs, on.q, options)
                                    : phimis::minimise(phimis::chi_squared{}, on.f, on.pdfs, on.q, options);
  const double seconds = seconds_since(start);
  objective check(on, gamma);
  return {seconds, residual_of(check, found.fractions), true};
}

/// α_k ← α_k (G_k/λ)^{1/γ}
outcome multiplicative(const problem& on, int gamma, double limit) {
  const Eigen::Index m = on.pdfs.cols();
  const auto start = clock_type::now();
  objective at(on, gamma);
  at.with_value(false);
  Eigen::VectorXd alpha = Eigen::VectorXd::Constant(m, 1.0 / static_cast<double>(m));
  Eigen::VectorXd g(m);
  double seconds = 0;
  double residual = 0;
  for (;;) {
    at(alpha, g);
    residual = objective::residual(alpha, g);
    seconds = seconds_since(start);
    if (residual <= enough || seconds > limit) break;
    if (gamma == 1) {
      alpha.array() *= g.array();
    } else {
      alpha.array() *= g.array().sqrt();
    }
    alpha /= alpha.sum();
  }
  return {seconds, residual, residual <= enough};
}

#ifdef PHIMIS_BENCH_NLOPT
struct slsqp_state {
  objective at;
  Eigen::VectorXd g;
  nlopt_opt solver;
  Eigen::VectorXd good_enough{};  ///< NLopt returns the point before the one that stopped it
};

double slsqp_objective(unsigned m, const double* x, double* gradient, void* data) {
  auto& state = *static_cast<slsqp_state*>(data);
  const Eigen::Map<const Eigen::VectorXd> alpha(x, m);
  const double value = state.at(alpha, state.g);
  if (gradient != nullptr) {
    Eigen::Map<Eigen::VectorXd>(gradient, m) = -state.g;
    if (std::isfinite(value) && std::fabs(alpha.sum() - 1) < 1e-9 && objective::residual(alpha, state.g) <= enough) {
      state.good_enough = alpha;
      nlopt_force_stop(state.solver);
    }
  }
  return value;
}

double sum_is_one(unsigned m, const double* x, double* gradient, void*) {
  double sum = -1;
  for (unsigned k = 0; k < m; ++k) {
    sum += x[k];
    if (gradient != nullptr) gradient[k] = 1;
  }
  return sum;
}

outcome slsqp(const problem& on, int gamma, double limit) {
  const auto m = static_cast<unsigned>(on.pdfs.cols());
  const auto start = clock_type::now();
  slsqp_state state{objective(on, gamma), Eigen::VectorXd(m), nlopt_create(NLOPT_LD_SLSQP, m)};
  nlopt_set_min_objective(state.solver, slsqp_objective, &state);
  nlopt_set_lower_bounds1(state.solver, 0);
  nlopt_set_upper_bounds1(state.solver, 1);
  nlopt_add_equality_constraint(state.solver, sum_is_one, nullptr, 1e-12);
  nlopt_set_ftol_rel(state.solver, 0);  // not of its own accord, as long as it makes progress
  nlopt_set_xtol_rel(state.solver, 1e-15);
  nlopt_set_maxtime(state.solver, limit);
  Eigen::VectorXd alpha = Eigen::VectorXd::Constant(m, 1.0 / m);
  double value = 0;
  nlopt_optimize(state.solver, alpha.data(), &value);
  const double seconds = seconds_since(start);
  nlopt_destroy(state.solver);
  const double residual = residual_of(state.at, state.good_enough.size() > 0 ? state.good_enough : alpha);
  return {seconds, residual, seconds < limit};
}
#endif

/// One evaluation of what the peers evaluate.
outcome gradient(const problem& on, int gamma) {
  objective at(on, gamma);
  const Eigen::VectorXd alpha = Eigen::VectorXd::Constant(on.pdfs.cols(), 1.0 / static_cast<double>(on.pdfs.cols()));
  Eigen::VectorXd g;
  const auto start = clock_type::now();
  at(alpha, g);
  return {seconds_since(start), objective::residual(alpha, g), true};
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The problems of one size, one solver's times on them.
struct measured {
  std::vector<double> seconds;
  double residual = 0;  ///< the worst

  double time() const { return median(seconds); }
};

enum solver { phimis_minimise, multiplicative_step, nlopt_slsqp, one_gradient, solvers };
constexpr std::array<const char*, solvers> solver_names{"phimis", "multiplicative", "slsqp", "gradient"};

outcome run(solver which, const problem& on, int gamma, double limit) {
  switch (which) {
    case phimis_minimise:
      return ours(on, gamma);
    case multiplicative_step:
      return multiplicative(on, gamma, limit);
#ifdef PHIMIS_BENCH_NLOPT
    case nlopt_slsqp:
      return slsqp(on, gamma, limit);
#endif
    case one_gradient:
      return gradient(on, gamma);
    default:
      return {std::numeric_limits<double>::quiet_NaN(), 0, false};
  }
}

/// Medians over problems of medians over repetitions, solvers in turn. What takes long is not repeated, and a solver that ran
/// out of time solves no other problem of that size.
std::array<measured, solvers> measure(int n, int m, int gamma, double limit) {
  std::array<measured, solvers> all;
  constexpr unsigned problems = 5;
  for (unsigned seed = 1; seed <= problems; ++seed) {
    const problem on = some_problem(n, m, seed);
    std::array<std::vector<double>, solvers> times;
    for (int i = 0; i < 9; ++i) {
      for (std::size_t s = 0; s < solvers; ++s) {
        auto& of = all[s];
        if (!of.seconds.empty() && of.seconds.back() >= limit) continue;
        if (i > 0 && (times[s].empty() || times[s].front() * (i + 1) > limit / 20)) continue;
        const outcome result = run(static_cast<solver>(s), on, gamma, limit);
        if (!(result.seconds >= 0)) continue;
        times[s].push_back(result.in_time ? result.seconds : limit);
        of.residual = std::max(of.residual, result.residual);
      }
    }
    for (std::size_t s = 0; s < solvers; ++s) {
      if (!times[s].empty()) all[s].seconds.push_back(median(times[s]));
    }
  }
  return all;
}

std::string milliseconds(const measured& of, double limit) {
  if (of.seconds.empty()) return "–";
  char text[64];
  const double ms = 1e3 * of.time();
  std::snprintf(text, sizeof text, "%s%.*f (%.0e)", of.time() >= limit ? "> " : "",
                ms < 1     ? 3
                : ms < 100 ? 1
                           : 0,
                ms, of.residual);
  return text;
}

std::string ratio(const measured& peer, const measured& own, double limit) {
  if (peer.seconds.empty()) return "–";
  char text[32];
  const double times = peer.time() / own.time();
  std::snprintf(text, sizeof text, "%s%.*f", peer.time() >= limit ? "> " : "", times < 10 ? 1 : 0, times);
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  double limit = 10;
  int most_rows = 100000;
  std::FILE* csv = nullptr;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i];
    if (option == "--csv") csv = std::fopen(argv[i + 1], "w");
    if (option == "--limit") limit = std::atof(argv[i + 1]);
    if (option == "--rows") most_rows = std::atoi(argv[i + 1]);
    if (option == "--csv" && csv == nullptr) return std::perror(argv[i + 1]), 1;
  }
  if (csv) std::fputs("gamma,n,m,solver,seconds,residual,in_time\n", csv);
  std::puts(
      "| γ | n | m | phimis, ms | multiplicative step, ms | × | SLSQP, ms | × | one gradient, ms | phimis, gradients "
      "| SLSQP, gradients |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|");
  for (const int gamma : {1, 2}) {
    for (int n = 100; n <= most_rows; n *= 10) {
      for (int m = 2; m <= 64; m *= 2) {
        const auto all = measure(n, m, gamma, limit);
        const auto& own = all[phimis_minimise];
        const auto& unit = all[one_gradient];
        std::printf("| %d | %d | %d | %s | %s | %s | %s | %s | %.3g | %s | %s |\n", gamma, n, m,
                    milliseconds(own, limit).c_str(), milliseconds(all[multiplicative_step], limit).c_str(),
                    ratio(all[multiplicative_step], own, limit).c_str(),
                    milliseconds(all[nlopt_slsqp], limit).c_str(), ratio(all[nlopt_slsqp], own, limit).c_str(),
                    1e3 * unit.time(), ratio(own, unit, limit).c_str(), ratio(all[nlopt_slsqp], unit, limit).c_str());
        std::fflush(stdout);
        for (std::size_t s = 0; csv && s < solvers; ++s) {
          if (all[s].seconds.empty()) continue;
          std::fprintf(csv, "%d,%d,%d,%s,%.4g,%.2g,%d\n", gamma, n, m, solver_names[s], all[s].time(),
                       all[s].residual, all[s].time() < limit ? 1 : 0);
        }
      }
    }
  }
  if (csv) std::fclose(csv);
}
