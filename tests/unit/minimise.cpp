// SPDX-License-Identifier: MIT
// solver/minimise.hpp: what it refuses, and what its options promise. That it minimises is proved by tests/hard.
#include "catch.hpp"
#include "random_problems.hpp"
#include "refuses.hpp"

#include <phimis/core/exact_minimiser.hpp>
#include <phimis/solver/minimise.hpp>
#include <phimis/solver/table.hpp>

#include <Eigen/Core>

#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <thread>
#include <type_traits>
#include <typeinfo>
#include <vector>

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using phimis::control_variate;
using phimis::minimise;
using phimis::minimise_options;
using phimis::minimum;
using phimis::rule_status;

constexpr double infinity = std::numeric_limits<double>::infinity();
const double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Three techniques that are all needed, 200 rows.
const random_problem three = [] {
  random_numbers random(5);
  random_problem on = detail::dirichlet(random, 200, 3);
  on.f = on.pdfs * VectorXd{{0.2, 0.3, 0.5}};
  for (auto& value : on.f) value *= std::exp(0.7 * detail::normal(random));
  return on;
}();

minimum solve(const minimise_options& options = {}) {
  return minimise(phimis::kullback_leibler{}, three.f, three.pdfs, three.q, options);
}

void refuses(const minimise_options& options, const std::string& parameter, const std::string& rule,
             const std::string& value) {
  ::refuses([&] { solve(options); }, parameter, rule, value);
}

double largest_difference(const VectorXd& a, const VectorXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("A minimisation needs an observation, and shapes that fit") {
  const auto with = [](Eigen::Index n, Eigen::Index rows, Eigen::Index columns, Eigen::Index densities) {
    return [=] {
      minimise(phimis::chi_squared{}, VectorXd::Ones(n), MatrixXd::Ones(rows, columns), VectorXd::Ones(densities));
    };
  };
  refuses(with(0, 0, 3, 0), "f", "must have at least one observation", "0");
  refuses(with(5, 4, 3, 5), "pdfs", "must have a row for each of 5 values of f", "4");
  refuses(with(5, 5, 0, 5), "pdfs", "must have a column for each technique", "0");
  refuses(with(5, 5, 3, 6), "q", "must have an entry for each of 5 values of f", "6");
  refuses(with(5, 5, 3, 0), "q", "must have an entry for each of 5 values of f", "0");
}

TEST_CASE("A minimisation refuses options of another number of techniques") {
  refuses({.start = VectorXd::Constant(2, 0.5)}, "start", "must have one entry for each of 3 techniques", "2");
  refuses({.floors = VectorXd::Zero(4)}, "floors", "must have one entry for each of 3 techniques", "4");
  refuses({.costs = VectorXd::Ones(1)}, "costs", "must have one entry for each of 3 techniques", "1");
}

TEST_CASE("A minimisation refuses costs that are no costs") {
  refuses({.costs = VectorXd{{1, -2, 1}}}, "costs", "must be finite and greater than 0", "-2");
  refuses({.costs = VectorXd{{1, 1, 0}}}, "costs", "must be finite and greater than 0", "0");
  refuses({.costs = VectorXd{{not_a_number, 1, 1}}}, "costs", "must be finite and greater than 0", "nan");
  refuses({.costs = VectorXd{{1, infinity, 1}}}, "costs", "must be finite and greater than 0", "inf");
}

TEST_CASE("A minimisation refuses floors that leave no fractions") {
  refuses({.floors = VectorXd{{0.5, 0.5, 0.25}}}, "floors", "must sum to at most 1", "1.25");
  refuses({.floors = VectorXd{{0.5, -0.25, 0}}}, "floors", "must be finite and not negative", "-0.25");
  refuses({.floors = VectorXd{{0, not_a_number, 0}}}, "floors", "must be finite and not negative", "nan");
}

TEST_CASE("A minimisation refuses a start off the simplex") {
  refuses({.start = VectorXd{{0.5, 0.5, 0.5}}}, "start", "must sum to 1", "1.5");
  refuses({.start = VectorXd{{1.5, -0.5, 0}}}, "start", "must be finite and not negative", "-0.5");
  refuses({.start = VectorXd{{0, infinity, 0}}}, "start", "must be finite and not negative", "inf");
  refuses({.start = VectorXd::Zero(3)}, "start", "must sum to 1", "0");
}

TEST_CASE("A minimisation refuses to freeze what is no technique") {
  refuses({.frozen = {3}}, "frozen", "must be techniques from 0 to 2", "3");
  refuses({.frozen = {0, -1}}, "frozen", "must be techniques from 0 to 2", "-1");
}

TEST_CASE("A minimisation refuses floors that frozen techniques leave no room for") {
  refuses({.start = VectorXd{{0.75, 0.125, 0.125}}, .floors = VectorXd{{0, 0.25, 0.25}}, .frozen = {0}}, "floors",
          "must leave room for the frozen techniques", "1.25");
}

TEST_CASE("A minimisation refuses a prior that is no weight") {
  refuses({.prior = -1}, "prior", "must be finite and not negative", "-1");
  refuses({.prior = not_a_number}, "prior", "must be finite and not negative", "nan");
}

TEST_CASE("A minimisation refuses a divergence without meaning") {
  const auto with = [](const auto& divergence) {
    return [=] { minimise(divergence, three.f, three.pdfs, three.q); };
  };
  refuses(with(phimis::tsallis{0}), "gamma", "must be finite and greater than 0", "0");
  refuses(with(phimis::reversed{phimis::tsallis{-1}}), "gamma", "must be finite and greater than 0", "-1");
  refuses(with(phimis::pearson_vajda{0.5}), "k", "must be finite and at least 1", "0.5");
}

TEST_CASE("Frozen techniques keep their fraction to the last digit") {
  const VectorXd start{{0.1, 0.2, 0.7}};
  for (int k = 0; k < 3; ++k) {
    const minimum found = solve({.start = start, .frozen = {k}});
    CHECK(found.status == rule_status::updated);
    CHECK(found.fractions[k] == start[k]);
    CHECK(std::fabs(found.fractions.sum() - 1) <= 1e-15);
    CHECK(largest_difference(found.fractions, start) > 0.01);  // the others move
  }
}

TEST_CASE("With all techniques frozen, or all but one, nothing moves") {
  const VectorXd start{{0.1, 0.2, 0.7}};
  CHECK(solve({.start = start, .frozen = {0, 1, 2}}).fractions == start);
  CHECK(largest_difference(solve({.start = start, .frozen = {0, 2}}).fractions, start) <= 1e-15);
}

TEST_CASE("Freezing a technique twice is freezing it") {
  const VectorXd start{{0.1, 0.2, 0.7}};
  CHECK(solve({.start = start, .frozen = {1, 1}}).fractions == solve({.start = start, .frozen = {1}}).fractions);
}

TEST_CASE("Floors are a vector, and hold exactly") {
  const VectorXd free = solve().fractions;
  const VectorXd floors{{free[0] + 0.1, 0, free[2] / 2}};
  const minimum found = solve({.floors = floors});
  CHECK(found.status == rule_status::updated);
  CHECK(found.fractions[0] == floors[0]);
  CHECK(found.fractions[1] > 0);
  CHECK(found.fractions[2] >= floors[2]);
  CHECK(std::fabs(found.fractions.sum() - 1) <= 1e-15);
}

TEST_CASE("A floor that does not bind changes nothing") {
  const VectorXd free = solve().fractions;
  CHECK(largest_difference(solve({.floors = free / 2}).fractions, free) <= 1e-12);
}

TEST_CASE("Floors that sum to one are the fractions") {
  const VectorXd floors{{0.25, 0.25, 0.5}};
  CHECK(solve({.floors = floors}).fractions == floors);
}

TEST_CASE("A prior pulls to the start, the more the heavier it is") {
  const VectorXd start{{0.1, 0.2, 0.7}};
  const VectorXd free = solve().fractions;
  double before = largest_difference(free, start);
  for (const double prior : {1.0, 30.0, 1e3, 1e6}) {
    const minimum found = solve({.start = start, .prior = prior});
    INFO("prior " << prior);
    CHECK(found.status == rule_status::updated);
    const double distance = largest_difference(found.fractions, start);
    CHECK(distance < before);
    before = distance;
  }
  CHECK(before < 1e-3);
}

TEST_CASE("For Kullback-Leibler a prior is a Dirichlet prior: pure observations of each technique") {
  // prior · π_k observations at which only technique k has density, all of the mean f/q.
  const VectorXd start{{0.1, 0.2, 0.7}};
  const double prior = 40;
  const double mean = three.f.cwiseQuotient(three.q).mean();
  random_problem with = three;
  const int n = three.rows();
  with.f.conservativeResize(n + 3);
  with.q.conservativeResize(n + 3);
  with.pdfs.conservativeResize(n + 3, 3);
  for (int k = 0; k < 3; ++k) {
    with.pdfs.row(n + k).setZero();
    with.pdfs(n + k, k) = 1;
    with.q[n + k] = 1;
    with.f[n + k] = prior * start[k] * mean;
  }
  const VectorXd counted =
      minimise(phimis::kullback_leibler{}, with.f, with.pdfs, with.q, {.variate = control_variate::off}).fractions;
  const VectorXd found = solve({.start = start, .prior = prior, .variate = control_variate::off}).fractions;
  CHECK(largest_difference(counted, found) <= 1e-12);
}

TEST_CASE("Without a prior the start changes nothing, not even at a vertex") {
  const VectorXd free = solve().fractions;
  for (int k = 0; k < 3; ++k) {
    CHECK(largest_difference(solve({.start = VectorXd::Unit(3, k)}).fractions, free) <= 1e-12);
  }
}

TEST_CASE("The unit of f changes no fraction, from 1e-300 to 1e300") {
  const auto check = [](const char* name, const auto& divergence) {
    INFO(name);
    const VectorXd free = minimise(divergence, three.f, three.pdfs, three.q).fractions;
    for (const double unit : {1e-300, 1e-150, 1e150, 1e300}) {
      const minimum found = minimise(divergence, three.f * unit, three.pdfs, three.q);
      CHECK(found.status == rule_status::updated);
      CHECK(largest_difference(found.fractions, free) <= 1e-12);
    }
  };
  for (int i = 0; i < smooth_divergences; ++i) with_smooth_divergence(i, check);
}

TEST_CASE("Quotients beyond the range of numbers are those of scaled observations") {
  const VectorXd free = solve().fractions;
  // f/p is up to 1e320, p/q near 1.
  const minimum found = minimise(phimis::kullback_leibler{}, three.f * 1e280, three.pdfs * 1e-40, three.q * 1e-40);
  CHECK(found.counters.nonfinite == three.f.size());
  CHECK(found.status == rule_status::no_information);
  const minimum large = minimise(phimis::kullback_leibler{}, three.f * 1e260, three.pdfs * 1e-40, three.q * 1e-40);
  CHECK(large.counters.nonfinite == 0);
  CHECK(largest_difference(large.fractions, free) <= 1e-12);
}

TEST_CASE("A number that is none is found wherever it stands among many rows") {
  random_numbers random(4);
  const random_problem on = detail::dirichlet(random, 200, 2);
  for (const double bad : {not_a_number, -not_a_number, infinity, -infinity, -1.0}) {
    for (const Eigen::Index row : {0, 63, 64, 150, 199}) {
      INFO(bad << " in row " << row);
      for (int where = 0; where < 4; ++where) {
        random_problem broken = on;
        if (where < 2) broken.pdfs(row, where) = bad;
        if (where == 2) broken.q[row] = bad;
        if (where == 3) broken.f[row] = bad;
        const minimum found = minimise(phimis::chi_squared{}, broken.f, broken.pdfs, broken.q);
        CHECK(found.counters.nonfinite == (where == 3 && bad == -1 ? 0 : 1));
        CHECK(found.counters.observations == 200);
        CHECK(std::fabs(found.fractions.sum() - 1) <= 1e-15);
      }
    }
  }
}

TEST_CASE("The unit of the measure changes no fraction, from 1e-150 to 1e150") {
  const VectorXd free = solve().fractions;
  for (const double unit : {1e-150, 1e150}) {
    const minimum found = minimise(phimis::kullback_leibler{}, three.f * unit, three.pdfs * unit, three.q * unit);
    CHECK(largest_difference(found.fractions, free) <= 1e-12);
  }
}

TEST_CASE("Variances see the sign of f as the exact rule does") {
  VectorXd with_signs = three.f;
  for (Eigen::Index j = 0; j < with_signs.size(); j += 3) with_signs[j] *= -1;
  phimis::exact_minimiser<phimis::multi_sample_variance, phimis::table<double, 3>> rule(
      phimis::multi_sample_variance{}, phimis::without_floors<double, 3>());
  for (Eigen::Index j = 0; j < with_signs.size(); ++j) {
    rule.observe({with_signs[j], {{three.pdfs(j, 0), three.pdfs(j, 1), three.pdfs(j, 2)}}, three.q[j], 0});
  }
  REQUIRE(rule.update() == rule_status::local);
  const VectorXd learnt{{rule.fractions()[0], rule.fractions()[1], rule.fractions()[2]}};
  const minimum found = minimise(phimis::multi_sample_variance{}, with_signs, three.pdfs, three.q);
  CHECK(found.status == rule_status::local);
  CHECK(largest_difference(found.fractions, learnt) <= 1e-9);
  // The same where a refused observation has rows copied.
  const Eigen::Index n = with_signs.size();
  VectorXd f(n + 1), q(n + 1);
  MatrixXd pdfs(n + 1, 3);
  f << not_a_number, with_signs;
  q << 1, three.q;
  pdfs << Eigen::RowVectorXd::Ones(3), three.pdfs;
  const minimum copied = minimise(phimis::multi_sample_variance{}, f, pdfs, q);
  CHECK(copied.counters.nonfinite == 1);
  CHECK(largest_difference(copied.fractions, learnt) <= 1e-9);
  const minimum of_magnitude = minimise(phimis::multi_sample_variance{}, three.f, three.pdfs, three.q);
  CHECK(largest_difference(of_magnitude.fractions, learnt) > 1e-3);
}

TEST_CASE("The sign of f changes no fraction") {
  VectorXd f = three.f;
  for (int j = 0; j < f.size(); j += 3) f[j] = -f[j];
  // Rows whose sign is lost are copied, others stay where they are: equal up to rounding.
  const VectorXd found = minimise(phimis::kullback_leibler{}, f, three.pdfs, three.q).fractions;
  CHECK(largest_difference(found, solve().fractions) <= 1e-14);
}

TEST_CASE("Observations merge: their order and their halves do not matter, and seen twice they count twice") {
  const int n = three.rows();
  const VectorXd free = solve().fractions;
  const auto rows = [&](const std::vector<int>& order) {
    return minimise(phimis::kullback_leibler{}, VectorXd(three.f(order)), MatrixXd(three.pdfs(order, Eigen::all)),
                    VectorXd(three.q(order)))
        .fractions;
  };
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::vector<int> other(order.rbegin(), order.rend());
  CHECK(largest_difference(rows(other), free) <= 1e-12);
  std::rotate(order.begin(), order.begin() + n / 2, order.end());
  CHECK(largest_difference(rows(order), free) <= 1e-12);
  other.insert(other.end(), order.begin(), order.end());
  CHECK(largest_difference(rows(other), free) <= 1e-12);
}

TEST_CASE("Techniques in another order have their fractions in that order") {
  const std::vector<int> order{2, 0, 1};
  const VectorXd free = solve().fractions;
  const VectorXd found =
      minimise(phimis::kullback_leibler{}, three.f, MatrixXd(three.pdfs(Eigen::all, order)), three.q).fractions;
  CHECK(largest_difference(found, free(order)) <= 1e-12);
}

TEST_CASE("Observations that are not finite are counted and left out") {
  random_problem with = three;
  with.f[3] = not_a_number;
  with.f[5] = infinity;
  with.pdfs(7, 1) = -1;
  with.pdfs(9, 2) = infinity;
  with.q[11] = 0;
  const minimum found = minimise(phimis::kullback_leibler{}, with.f, with.pdfs, with.q);
  CHECK(found.counters.observations == 200);
  CHECK(found.counters.nonfinite == 5);
  std::vector<int> kept;
  for (int j = 0; j < 200; ++j) {
    if (j != 3 && j != 5 && j != 7 && j != 9 && j != 11) kept.push_back(j);
  }
  const VectorXd without = minimise(phimis::kullback_leibler{}, VectorXd(three.f(kept)),
                                    MatrixXd(three.pdfs(kept, Eigen::all)), VectorXd(three.q(kept)))
                               .fractions;
  CHECK(found.status == rule_status::updated);
  CHECK(largest_difference(found.fractions, without) <= 1e-12);
}

TEST_CASE("Without information the fractions are the start") {
  const VectorXd start{{0.1, 0.2, 0.7}};
  const minimum zero =
      minimise(phimis::kullback_leibler{}, VectorXd::Zero(200), three.pdfs, three.q, {.start = start});
  CHECK(zero.status == rule_status::no_information);
  CHECK(zero.fractions == start);
  CHECK(zero.counters.zero == 200);
}

TEST_CASE("A divergence that is infinite where f is 0 says so and keeps the start") {
  VectorXd f = three.f;
  f[17] = 0;
  const VectorXd start{{0.1, 0.2, 0.7}};
  const minimum found =
      minimise(phimis::reversed<phimis::kullback_leibler>{}, f, three.pdfs, three.q, {.start = start});
  CHECK(found.status == rule_status::infinite_divergence);
  CHECK(found.fractions == start);
}

TEST_CASE("A single technique has the whole budget") {
  const minimum found = minimise(phimis::kullback_leibler{}, three.f, three.pdfs.leftCols(1), three.q);
  CHECK(found.fractions == VectorXd::Ones(1));
}

TEST_CASE("The control variate finds a zero-variance mixture of any number of techniques exactly") {
  random_numbers random(11);
  random_problem on = detail::dirichlet(random, 300, 12);
  const VectorXd mixture = detail::some_fractions(random, 12, 1);
  on.f = on.pdfs * mixture;
  const VectorXd masses = (on.pdfs.array().colwise() / on.q.array()).colwise().mean();
  on.pdfs = (on.pdfs.array().rowwise() / masses.transpose().array()).eval();  // normalised on the sample
  on.f = on.pdfs * mixture;
  const minimum found = minimise(phimis::chi_squared{}, on.f, on.pdfs, on.q);
  CHECK(found.status == rule_status::updated);
  CHECK(largest_difference(found.fractions, mixture) <= 1e-10);
}

TEST_CASE("Costs divide pdfs: for chi squared the minimum is of cost times variance per sample") {
  const VectorXd costs{{1, 5, 0.2}};
  // a_k ∝ c_k α_k minimises Σ f²/(q Σ a_k p_k/c_k).
  const MatrixXd cheap = three.pdfs * costs.cwiseInverse().asDiagonal();
  VectorXd wanted =
      minimise(phimis::chi_squared{}, three.f, cheap, three.q, {.variate = control_variate::off}).fractions;
  wanted = wanted.cwiseQuotient(costs).eval();
  wanted /= wanted.sum();
  const VectorXd found =
      minimise(phimis::chi_squared{}, three.f, three.pdfs, three.q, {.costs = costs, .variate = control_variate::off})
          .fractions;
  CHECK(largest_difference(found, wanted) <= 1e-12);
}

TEST_CASE("Equal costs change nothing, and others are refused where they mean nothing") {
  const VectorXd free = solve().fractions;
  CHECK(largest_difference(solve({.costs = VectorXd::Constant(3, 7)}).fractions, free) <= 1e-12);
  refuses(
      [] {
        minimise(phimis::pearson_vajda{2}, three.f, three.pdfs, three.q, {.costs = VectorXd{{1, 2, 1}}});
      },
      "costs", "must be equal for a divergence whose score is no power of f/p", "2");
}

TEST_CASE("Threads of the host change no digit, whoever runs which part") {
  const int techniques = GENERATE(2, 4);
  // Long enough to be read in parts.
  random_numbers random(3);
  const random_problem on = detail::dirichlet(random, 200000, techniques);
  const auto backwards = [](int count, const std::function<void(int)>& part) {
    for (int i = count - 1; i >= 0; --i) part(i);
  };
  const auto threads = [](int count, const std::function<void(int)>& part) {
    std::vector<std::jthread> all;
    for (int i = 0; i < count; ++i) all.emplace_back([&part, i] { part(i); });
  };
  VectorXd f = on.pdfs * VectorXd{{0.2, 0.3, 0.1, 0.4}}.head(techniques);
  for (Eigen::Index j = 0; j < f.size(); j += 2) f[j] *= 1.5;
  for (const bool copied : {false, true}) {
    if (copied) f[7] = not_a_number;
    const auto solved = [&](const phimis::parallel_for& run) {
      minimise_options options;
      options.run = run;
      return minimise(phimis::chi_squared{}, f, on.pdfs, on.q, options);
    };
    const minimum alone = solved({});
    CHECK(alone.status == rule_status::updated);
    CHECK(alone.counters.observations == 200000);
    CHECK(alone.counters.nonfinite == (copied ? 1 : 0));
    for (const phimis::parallel_for& run : {phimis::parallel_for(backwards), phimis::parallel_for(threads)}) {
      const minimum together = solved(run);
      CHECK(together.fractions == alone.fractions);
      CHECK(together.residual == alone.residual);
    }
  }
}

TEST_CASE("A tolerance is reached, and saves evaluations") {
  minimise_options coarse;
  coarse.tolerance = 1e-3;
  const minimum near = solve(coarse);
  const minimum exact = solve();
  CHECK(near.status == rule_status::updated);
  CHECK(near.residual <= 1e-3);
  CHECK(near.evaluations < exact.evaluations);
  coarse.tolerance = -1;
  refuses(coarse, "tolerance", "must be finite and not negative", "-1");
}

namespace {

/// 300 rows on [0, 1] of 2x, 2 − 2x and columns of zeros, f = 1 + x².
struct silent_problem {
  VectorXd f = VectorXd(300), q = VectorXd::Ones(300);
  MatrixXd pdfs;

  silent_problem(bool falling, int zeros) : pdfs(MatrixXd::Zero(300, 1 + (falling ? 1 : 0) + zeros)) {
    for (Eigen::Index j = 0; j < 300; ++j) {
      const double x = (static_cast<double>(j) + 0.5) / 300;
      f[j] = 1 + x * x;
      pdfs(j, 0) = 2 * x;
      if (falling) pdfs(j, 1) = 2 - 2 * x;
    }
  }
};

template <class Receiver>
void for_every_divergence(const Receiver& receive) {
  using phimis::reversed;
  receive(phimis::kullback_leibler{});
  receive(phimis::chi_squared{});
  receive(phimis::tsallis{0.5});
  receive(phimis::tsallis{3});
  receive(phimis::pearson_vajda{1.5});
  receive(phimis::pearson_vajda{3});
  receive(phimis::total_variation{});
  receive(phimis::one_sample_variance{});
  receive(phimis::multi_sample_variance{});
  receive(reversed<phimis::kullback_leibler>{});
  receive(reversed<phimis::chi_squared>{});
  receive(reversed<phimis::tsallis>{phimis::tsallis{0.5}});
  receive(reversed<phimis::tsallis>{phimis::tsallis{1.5}});
  receive(reversed<phimis::tsallis>{phimis::tsallis{3}});
  receive(reversed<phimis::total_variation>{});
  receive(reversed<phimis::pearson_vajda>{phimis::pearson_vajda{3}});
}

}  // namespace

TEST_CASE("A technique without density at any observation gets its floor, under every divergence and number of techniques") {
  for (const auto variate : {control_variate::on, control_variate::off}) {
    for (const int zeros : {1, 2}) {
      const silent_problem on(false, zeros);
      for (const double floor : {0.0, 0.01}) {
        minimise_options options{.floors = VectorXd::Constant(1 + zeros, floor), .variate = variate};
        for_every_divergence([&](const auto& divergence) {
          const minimum found = minimise(divergence, on.f, on.pdfs, on.q, options);
          CAPTURE(zeros, floor, variate == control_variate::on, typeid(divergence).name());
          CHECK((found.status == rule_status::updated || found.status == rule_status::local));
          for (int k = 1; k <= zeros; ++k) CHECK(found.fractions[k] == floor);
          CHECK(found.residual < 1e-12);
        });
      }
    }
  }
}

TEST_CASE("A prior keeps a share for a technique without density, the same of two techniques as of three") {
  // Of three the first two are one technique that was split: their shares add up to that of two.
  const silent_problem two(false, 1);
  silent_problem split(true, 1);
  split.pdfs.col(1) = split.pdfs.col(0);
  for_every_divergence([&](const auto& divergence) {
    if constexpr (phimis::detail::is_variance<std::decay_t<decltype(divergence)>>::value) return;
    double before = 1;  // the distance from the start
    for (const double prior : {3.0, 100.0, 1e4}) {
      minimise_options of_two{.start = VectorXd{{0.5, 0.5}}, .prior = prior};
      minimise_options of_three{.start = VectorXd{{0.25, 0.25, 0.5}}, .prior = prior};
      const minimum found = minimise(divergence, two.f, two.pdfs, two.q, of_two);
      const minimum other = minimise(divergence, split.f, split.pdfs, split.q, of_three);
      CAPTURE(prior, typeid(divergence).name(), found.fractions, other.fractions);
      // Of three techniques a kink is rounded off to 1e-6, and the prior, a row that outweighs all others, has one at the start.
      const bool kinked = phimis::detail::is_kinked<std::decay_t<decltype(divergence)>>::value;
      CHECK(found.status == rule_status::updated);
      CHECK((other.status == rule_status::updated || kinked));
      CHECK(std::fabs(found.fractions[1] - other.fractions[2]) < (kinked ? 1e-5 : 1e-9));
      const double now = std::fabs(found.fractions[1] - 0.5);
      CHECK(now <= before);
      before = now;
    }
  });
}

TEST_CASE("A prior without a share for a technique is convex there, too, and bars it where it is infinitely far") {
  const silent_problem on(true, 0);
  silent_problem with_uniform(true, 1);
  with_uniform.pdfs.col(2).setOnes();
  for_every_divergence([&](const auto& divergence) {
    for (const double prior : {1.0, 100.0, 1e4}) {
      const minimum of_two = minimise(divergence, on.f, on.pdfs, on.q, {.start = VectorXd{{1, 0}}, .prior = prior});
      const minimum of_three = minimise(divergence, with_uniform.f, with_uniform.pdfs, with_uniform.q,
                                        {.start = VectorXd{{1, 0, 0}}, .prior = prior});
      CAPTURE(prior, typeid(divergence).name(), of_two.fractions, of_three.fractions);
      CHECK((of_two.status == rule_status::updated || of_two.status == rule_status::local));
      CHECK((of_three.status == rule_status::updated || of_three.status == rule_status::local));
      CHECK(of_two.residual < 1e-10);
      CHECK(of_three.residual < 1e-10);
      if (phimis::infinite_at_zero(divergence)) {
        CHECK(of_two.fractions[0] == 1);
        CHECK(of_three.fractions[0] == 1);
      } else if (prior == 1e4) {
        CHECK(of_two.fractions[0] > 0.9);
        CHECK(of_three.fractions[0] > 0.9);
      }
    }
  });
}
