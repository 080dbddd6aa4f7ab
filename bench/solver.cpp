// SPDX-License-Identifier: MIT
// How long does it take to find the best fractions of m techniques on n observations? Ours, the multiplicative step, and
// NLopt's SLSQP where the library was found; of two techniques also Boost.Math's and Eigen's root finders, where the optimum
// lies inside.
//
//     bench_solver [--csv FILE] [--limit SECONDS] [--rows MOST]      two Markdown tables on standard output
//
// One residual for all, of the fractions that each returns: max_k G_k/λ − 1, the duality gap relative to λ. All stop as soon
// as it is 1e-8, root finders at 30 bits of α. Peers evaluate objective and gradient in
// one pass over blocks of rows that fit into the cache. Medians over problems, of repetitions in turn. The time of one such
// evaluation is what no solver that looks at all observations can go below.

#include "bumps.hpp"

#include <phimis/solver/minimise.hpp>

#include <Eigen/Core>
#include <boost/math/tools/roots.hpp>
#include <unsupported/Eigen/NonLinearOptimization>

#ifdef PHIMIS_BENCH_NLOPT
#include <nlopt.h>
#endif

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace {

using clock_type = std::chrono::steady_clock;
constexpr double enough = 1e-8;

double seconds_since(clock_type::time_point start) {
  return std::chrono::duration<double>(clock_type::now() - start).count();
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

/// G_1 − G_2 of two techniques as a function of α_1, and its derivative, in one pass over blocks of rows.
class condition {
 public:
  condition(const problem& on, int gamma) : on_(on), gamma_(gamma), weights_(on.f.cwiseQuotient(on.q)) {
    if (gamma == 2) weights_ = weights_.cwiseProduct(on.f).eval();
    weights_ /= weights_.sum();
  }

  std::pair<double, double> operator()(double alpha) {
    double value = 0;
    double slope = 0;
    for (Eigen::Index j = 0; j < weights_.size(); j += rows_of_block) {
      const Eigen::Index count = std::min<Eigen::Index>(rows_of_block, weights_.size() - j);
      const auto first = on_.pdfs.col(0).segment(j, count).array();
      const auto second = on_.pdfs.col(1).segment(j, count).array();
      auto r = block_.head(count).array();
      r = 1 / (alpha * first + (1 - alpha) * second);
      auto s = scores_.head(count).array();
      s = weights_.segment(j, count).array() * r;
      if (gamma_ == 2) s *= r;
      value += (s * (first - second)).sum();
      slope -= gamma_ * (s * r * (first - second).square()).sum();
    }
    return {value, slope};
  }

 private:
  static constexpr Eigen::Index rows_of_block = 256;
  const problem& on_;
  int gamma_;
  Eigen::VectorXd weights_;
  Eigen::VectorXd block_{rows_of_block};
  Eigen::VectorXd scores_{rows_of_block};
};

/// Root finders stop by the digits of α_1: 30 bits leave a residual below 1e-8, often far below.
constexpr int enough_bits = 30;

outcome timed_root(const problem& on, int gamma, double (*root)(condition&)) {
  const auto start = clock_type::now();
  condition at(on, gamma);
  const double alpha = root(at);
  const double seconds = seconds_since(start);
  objective check(on, gamma);
  return {seconds, residual_of(check, Eigen::Vector2d(alpha, 1 - alpha)), true};
}

double boost_newton(condition& at) {
  std::uintmax_t most = 200;
  return boost::math::tools::newton_raphson_iterate([&](double alpha) { return at(alpha); }, 0.5, 0.0, 1.0, enough_bits, most);
}

double boost_toms748(condition& at) {
  std::uintmax_t most = 200;
  const auto bracket = boost::math::tools::toms748_solve([&](double alpha) { return at(alpha).first; }, 1e-9, 1 - 1e-9,
                                                         boost::math::tools::eps_tolerance<double>(enough_bits), most);
  return (bracket.first + bracket.second) / 2;
}

struct eigen_condition {
  condition& at;
  int operator()(const Eigen::VectorXd& alpha, Eigen::VectorXd& value) const {
    value[0] = at(alpha[0]).first;
    return 0;
  }
  int df(const Eigen::VectorXd& alpha, Eigen::MatrixXd& slope) const {
    slope(0, 0) = at(alpha[0]).second;
    return 0;
  }
};

double eigen_hybrid(condition& at) {
  eigen_condition functor{at};
  Eigen::HybridNonLinearSolver<eigen_condition> solver(functor);
  solver.parameters.xtol = std::ldexp(1.0, -enough_bits);
  Eigen::VectorXd alpha = Eigen::VectorXd::Constant(1, 0.5);
  solver.hybrj1(alpha);
  return alpha[0];
}

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

enum solver {
  phimis_minimise,
  multiplicative_step,
  nlopt_slsqp,
  newton,
  toms748,
  hybrid,
  one_gradient,
  solvers
};
constexpr std::array<const char*, solvers> solver_names{"phimis",        "multiplicative", "slsqp",   "boost_newton",
                                                        "boost_toms748", "eigen_hybrid",   "gradient"};

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
    case newton:
      return timed_root(on, gamma, boost_newton);
    case toms748:
      return timed_root(on, gamma, boost_toms748);
    case hybrid:
      return timed_root(on, gamma, eigen_hybrid);
    case one_gradient:
      return gradient(on, gamma);
    default:
      return {std::numeric_limits<double>::quiet_NaN(), 0, false};
  }
}

/// Whether no fraction is 0 where the divergence is least.
bool is_inside(const problem& on, int gamma) {
  condition at(on, gamma);
  return at(1e-6).first > 0 && at(1 - 1e-6).first < 0;
}

/// Medians over problems of medians over repetitions, solvers in turn. What takes long is not repeated, and a solver that ran
/// out of time solves no other problem of that size.
std::array<measured, solvers> measure(int n, int m, int gamma, double limit, const std::vector<solver>& who, bool inside) {
  std::array<measured, solvers> all;
  const unsigned problems = n < 1000000 ? 5 : 3;
  unsigned solved = 0;
  for (unsigned seed = 1; solved < problems; ++seed) {
    const problem on = some_problem(n, m, seed);
    if (inside && !is_inside(on, gamma)) continue;
    ++solved;
    std::array<std::vector<double>, solvers> times;
    for (int i = 0; i < 9; ++i) {
      for (const solver which : who) {
        const auto s = static_cast<std::size_t>(which);
        auto& of = all[s];
        if (!of.seconds.empty() && of.seconds.back() >= limit) continue;
        if (i > 0 && (times[s].empty() || times[s].front() * (i + 1) > limit / 20)) continue;
        const outcome result = run(which, on, gamma, limit);
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
                ms < 0.01  ? 4
                : ms < 1   ? 3
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

void write(std::FILE* csv, int gamma, int n, int m, const char* where, const std::array<measured, solvers>& all,
           double limit) {
  if (csv == nullptr) return;
  for (std::size_t s = 0; s < solvers; ++s) {
    if (all[s].seconds.empty()) continue;
    std::fprintf(csv, "%d,%d,%d,%s,%s,%.4g,%.2g,%d\n", gamma, n, m, where, solver_names[s], all[s].time(),
                 all[s].residual, all[s].time() < limit ? 1 : 0);
  }
}

void compare_all(std::FILE* csv, double limit, int most_rows) {
  std::puts(
      "| γ | n | m | phimis, ms | multiplicative step, ms | × | SLSQP, ms | × | one gradient, ms "
      "| phimis, gradients | SLSQP, gradients |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|");
  for (const int gamma : {1, 2}) {
    for (int n = 100; n <= most_rows; n *= 10) {
      for (int m = 2; m <= 64; m *= 2) {
        if (n >= 1000000 && (m == 4 || m > 16)) continue;  // gigabytes, and minutes for the peers
        const auto all = measure(
            n, m, gamma, limit,
            {phimis_minimise, multiplicative_step, nlopt_slsqp, one_gradient}, false);
        const auto& own = all[phimis_minimise];
        const auto& unit = all[one_gradient];
        std::printf("| %d | %d | %d | %s | %s | %s | %s | %s | %.3g | %s | %s |\n", gamma, n, m,
                    milliseconds(own, limit).c_str(),
                    milliseconds(all[multiplicative_step], limit).c_str(),
                    ratio(all[multiplicative_step], own, limit).c_str(),
                    milliseconds(all[nlopt_slsqp], limit).c_str(), ratio(all[nlopt_slsqp], own, limit).c_str(),
                    1e3 * unit.time(), ratio(own, unit, limit).c_str(), ratio(all[nlopt_slsqp], unit, limit).c_str());
        std::fflush(stdout);
        write(csv, gamma, n, m, "anywhere", all, limit);
      }
    }
  }
}

void compare_root_finders(std::FILE* csv, double limit, int most_rows) {
  std::puts("");
  std::puts(
      "| γ | n | phimis, ms | Newton (Boost.Math), ms | × | TOMS 748 (Boost.Math), ms | × | hybrid (Eigen), ms | × "
      "| SLSQP, ms | × |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|");
  for (const int gamma : {1, 2}) {
    for (int n = 100; n <= most_rows; n *= 100) {
      const auto all =
          measure(n, 2, gamma, limit, {phimis_minimise, newton, toms748, hybrid, nlopt_slsqp}, true);
      const auto& own = all[phimis_minimise];
      std::printf("| %d | %d | %s |", gamma, n, milliseconds(own, limit).c_str());
      for (const solver peer : {newton, toms748, hybrid, nlopt_slsqp}) {
        std::printf(" %s | %s |", milliseconds(all[peer], limit).c_str(), ratio(all[peer], own, limit).c_str());
      }
      std::puts("");
      std::fflush(stdout);
      write(csv, gamma, n, 2, "inside", all, limit);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  double limit = 5;
  int most_rows = 1000000;
  std::FILE* csv = nullptr;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i];
    if (option == "--csv") csv = std::fopen(argv[i + 1], "w");
    if (option == "--limit") limit = std::atof(argv[i + 1]);
    if (option == "--rows") most_rows = std::atoi(argv[i + 1]);
    if (option == "--csv" && csv == nullptr) return std::perror(argv[i + 1]), 1;
  }
  if (csv) std::fputs("gamma,n,m,optimum,solver,seconds,residual,in_time\n", csv);
  compare_all(csv, limit, most_rows);
  compare_root_finders(csv, limit, most_rows);
  if (csv) std::fclose(csv);
}
