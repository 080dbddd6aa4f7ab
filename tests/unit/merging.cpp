// SPDX-License-Identifier: MIT
// What accumulates can be merged in any grouping: every rule of rules.hpp, its fractions to rounding.
#include "catch.hpp"
#include "random.hpp"

#include <phimis/solver/joint_minimiser.hpp>
#include <phimis/solver/rules.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace {

/// Observations of f = p·(1, 2, …) rippled, now and then 0, with densities that differ from batch to batch.
template <int M, class Real>
std::vector<phimis::observation<Real, M>> observations(int n, std::uint64_t seed) {
  random_numbers random(seed);
  std::vector<phimis::observation<Real, M>> all;
  for (int j = 0; j < n; ++j) {
    phimis::observation<Real, M> one;
    double f = 0;
    double q = 0;
    double sum = 0;
    for (int k = 0; k < M; ++k) {
      const double pdf = random.between(0.05, 2);
      const double share = 1 + (j / 25 + k) % M;
      one.pdfs[k] = static_cast<Real>(pdf);
      f += pdf * (k + 1);
      q += pdf * share;
      sum += share;
    }
    one.f = random() < 0.1 ? Real(0) : static_cast<Real>(f * random.between(0.6, 1.4));
    one.q = static_cast<Real>(q / sum);
    one.technique = j % M;
    all.push_back(one);
  }
  return all;
}

/// How far the largest fraction lies off.
template <class Rule>
double distance(const Rule& one, const Rule& other) {
  double most = 0;
  for (int k = 0; k < Rule::techniques; ++k) {
    most = std::max(most,
                    std::fabs(static_cast<double>(one.fractions()[k]) - static_cast<double>(other.fractions()[k])));
  }
  return most;
}

/// One state of all observations against states of parts, merged from the left, from the right, and in a tree.
template <class Rule>
void check_grouping(const char* name, const Rule& empty, double units = 2000) {
  constexpr int M = Rule::techniques;
  using Real = typename Rule::real;
  const double tolerance = units * static_cast<double>(std::numeric_limits<Real>::epsilon());
  const auto all = observations<M, Real>(150, 7);
  Rule whole = empty;
  for (const auto& one : all) whole.observe(one);
  const std::vector<std::size_t> ends{0, 1, 40, 40, 97, 150};
  std::vector<Rule> parts;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    parts.push_back(empty);
    for (std::size_t j = ends[i]; j < ends[i + 1]; ++j) parts.back().observe(all[j]);
  }
  Rule from_left = empty;
  for (const Rule& part : parts) from_left.merge(part);
  Rule from_right = empty;
  for (std::size_t i = parts.size(); i-- > 0;) {
    Rule next = parts[i];
    next.merge(from_right);
    from_right = next;
  }
  Rule low = parts[0];
  low.merge(parts[1]);
  Rule high = parts[3];
  high.merge(parts[4]);
  Rule tree = low;
  tree.merge(parts[2]);
  tree.merge(high);

  const Rule before = whole;
  const auto status = whole.update();
  INFO(name << " of " << M << ", " << sizeof(Real) << " bytes");
  CHECK(status != phimis::rule_status::no_information);
  for (Rule* merged : {&from_left, &from_right, &tree}) {
    CHECK(merged->counters().observations == whole.counters().observations);
    CHECK(merged->counters().zero == whole.counters().zero);
    CHECK(merged->update() == status);
    CHECK(distance(*merged, whole) <= tolerance);
  }
  CHECK(distance(whole, before) > 0.005);
}

}  // namespace

TEMPLATE_TEST_CASE("Every rule learns the same from states that are merged in any grouping", "", float, double) {
  using namespace phimis;
  check_grouping("newton_rule", newton_rule<kullback_leibler, TestType>(kullback_leibler{}));
  check_grouping("newton_rule, paper", newton_rule<chi_squared, TestType>(chi_squared{}, newton_form::paper));
  check_grouping("newton_rule, reversed", newton_rule<reversed<tsallis>, TestType>(reversed<tsallis>{tsallis{0.5}}));
  check_grouping("exact_rule", exact_rule<2, kullback_leibler, TestType>(kullback_leibler{}));
  check_grouping("exact_rule, V[F]", exact_rule<2, multi_sample_variance, TestType>(multi_sample_variance{}));
  check_grouping("exact_rule", exact_rule<3, chi_squared, TestType>(chi_squared{}));
  check_grouping("exact_rule, V[F]", exact_rule<3, multi_sample_variance, TestType>(multi_sample_variance{}), 1e5);
  check_grouping("exact_rule, total variation", exact_rule<3, total_variation, TestType>(total_variation{}), 1e6);
  check_grouping("streaming_rule", streaming_rule<3, kullback_leibler, TestType>(kullback_leibler{}));
  check_grouping("streaming_rule, V[F]", streaming_rule<3, multi_sample_variance, TestType>(multi_sample_variance{}));
  check_grouping("sigma_rule", sigma_rule<3, TestType>());
  check_grouping("inverse_variance_rule", inverse_variance_rule<3, TestType>());
  check_grouping("second_order_rule", second_order_rule<3, TestType>());
  check_grouping("linear_rule", linear_rule<3, negative_fractions::project, TestType>(), 1e5);
  check_grouping("linear_rule, best_face", linear_rule<3, negative_fractions::best_face, TestType>(), 1e5);
  check_grouping("linear_rule, drop", linear_rule<3, negative_fractions::drop_most_negative, TestType>(), 1e5);
}

TEST_CASE("The joint rule learns the same from states that are merged in any grouping") {
  check_grouping("joint_rule", phimis::joint_rule<3>(), 1e5);
}
