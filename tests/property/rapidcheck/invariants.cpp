// SPDX-License-Identifier: MIT
// What the fuzzers demand, on numbers that rapidcheck makes up and, where a property fails, makes smaller.
#include "invariants.hpp"
#include "catch.hpp"
#include "generators.hpp"

#include <phimis/core/counts.hpp>
#include <phimis/core/uniform.hpp>
#include <phimis/solver/rules.hpp>

#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace {

constexpr int M = 4;

template <class Real>
using options = phimis::rule_options<Real, M>;
template <class Real>
using observations = std::vector<phimis::observation<Real, M>>;

void require_nothing(const std::string& broken) {
  if (!broken.empty()) RC_FAIL(broken);
}

/// Updates after half of the observations and after all.
template <class Rule, class More>
void learn(Rule rule, const observations<typename Rule::real>& all, const More& more) {
  require_nothing(invariants::off_simplex(rule.fractions(), rule.options()));
  for (std::size_t j = 0; j <= all.size(); ++j) {
    if (j == all.size() / 2 || j == all.size()) {
      const auto before = rule.fractions();
      rule.update();
      require_nothing(invariants::wrong_update(rule, before));
      more(rule, before);
    }
    if (j < all.size()) rule.observe(all[j]);
  }
}
template <class Rule>
void learn(const Rule& rule, const observations<typename Rule::real>& all) {
  learn(rule, all, [](const auto&, const auto&) {});
}

/// f(divergence) for one of each family.
template <class F>
void for_each_family(const F& f) {
  f(phimis::kullback_leibler{});
  f(phimis::chi_squared{});
  f(phimis::tsallis{0.3});
  f(phimis::reversed<phimis::kullback_leibler>{});
  f(phimis::reversed<phimis::chi_squared>{});
  f(phimis::total_variation{});
  f(phimis::pearson_vajda{3});
}

template <class Divergence, class Real>
options<Real> allowed(const Divergence&, options<Real> given) {
  bool priced = false;
  if constexpr (phimis::has_exponent<Divergence>::value) priced = Divergence{}.exponent() > 0;
  if (!priced) given.costs = phimis::equal_costs<Real, M>();
  return given;
}

}  // namespace

TEMPLATE_TEST_CASE("Any shares, floors and frozen techniques make fractions that split any budget", "", float,
                   double) {
  CHECK(rc::check([] {
    auto given = *generators::options<TestType, M>();
    // A frozen technique may leave less than the others' floors.
    for (int k = 0; k < M; ++k) given.floors[k] *= 1 - given.start[0];
    given.frozen[0] = *rc::gen::arbitrary<bool>();
    const auto shares = *generators::of_each<TestType, M>(generators::densities<TestType>());
    const auto budget = *rc::gen::inRange<std::int64_t>(0, 1000000000);
    const double u = phimis::uniform(*rc::gen::arbitrary<std::uint64_t>());
    const auto alpha = phimis::share_budget(shares, given);
    require_nothing(invariants::off_simplex(alpha, given));
    require_nothing(invariants::wrong_counts(phimis::split_largest_remainder(alpha, budget), alpha, budget));
    require_nothing(invariants::wrong_counts(phimis::split_systematic(alpha, budget, u), alpha, budget));
    RC_ASSERT(alpha[phimis::pick_technique(alpha, u)] > 0);
  }));
}

TEMPLATE_TEST_CASE("Every rule stays on its simplex whatever it observes", "", float, double) {
  CHECK(rc::check([] {
    const auto given = *generators::options<TestType, M>();
    const auto all = *generators::observations<TestType, M>(generators::numbers<TestType>());
    auto free = given;
    free.costs = phimis::equal_costs<TestType, M>();
    using phimis::negative_fractions;
    learn(phimis::sigma_rule<M>(given), all);
    learn(phimis::inverse_variance_rule<M>(given), all);
    learn(phimis::second_order_rule<M>(given), all);
    learn(phimis::linear_rule<M, negative_fractions::project, TestType>(free), all);
    learn(phimis::linear_rule<M, negative_fractions::drop_most_negative, TestType>(free), all);
    learn(phimis::linear_rule<M, negative_fractions::best_face, TestType>(free), all);
    learn(phimis::streaming_rule<M>(phimis::hellinger{}, free, TestType(0.5)), all);
    learn(phimis::streaming_rule<M>(phimis::multi_sample_variance{}, free), all);
    learn(phimis::exact_rule<M>(phimis::multi_sample_variance{}, given), all);
    for_each_family([&](const auto& divergence) {
      learn(phimis::exact_rule<M>(divergence, allowed(divergence, given)), all);
    });
  }));
}

TEMPLATE_TEST_CASE("The exact minimiser never ends above where it began", "", float, double) {
  CHECK(rc::check([] {
    const auto given = *generators::options<TestType, M>();
    const auto all = *generators::observations<TestType, M>(generators::moderate<TestType>());
    const auto variate = *rc::gen::element(phimis::control_variate::on, phimis::control_variate::off);
    for_each_family([&](const auto& divergence) {
      const auto taken = allowed(divergence, given);
      using rule_type = decltype(phimis::exact_rule<M>(divergence, taken, variate));
      learn(phimis::exact_rule<M>(divergence, taken, variate), all, [&](const rule_type& rule, const auto& before) {
        if (rule.status() == phimis::rule_status::no_information) return;
        const auto view = rule.table().view();
        const phimis::column_pointers<TestType> columns{view.u, view.w, view.y, view.n, M};
        using divergence_type = std::decay_t<decltype(divergence)>;
        const invariants::objective<divergence_type, TestType> on(
            divergence, invariants::rows(columns), taken.start.value, taken.costs.value, taken.prior, variate);
        require_nothing(
            invariants::above_start<TestType>(on, rule.fractions().value, before.value, rule.gap()));
      });
    });
  }));
}

TEMPLATE_TEST_CASE("What is merged teaches what one rule learns, and a power of two of f teaches the same", "", float,
                   double) {
  CHECK(rc::check([] {
    const auto given = *generators::options<TestType, M>();
    const auto all = *generators::observations<TestType, M>(generators::moderate<TestType>());
    const auto half = all.size() / 2;
    const auto scale = std::ldexp(TestType(1), *rc::gen::inRange(-60, 61));
    for_each_family([&](const auto& divergence) {
      const auto empty = phimis::exact_rule<M>(divergence, allowed(divergence, given));
      auto whole = empty;
      auto first = empty;
      auto second = empty;
      auto scaled = empty;
      for (std::size_t j = 0; j < all.size(); ++j) {
        whole.observe(all[j]);
        (j < half ? first : second).observe(all[j]);
        auto larger = all[j];
        larger.f *= scale;
        scaled.observe(larger);
      }
      first.merge(second);
      RC_ASSERT(whole.update() == first.update());
      RC_ASSERT(whole.status() == scaled.update());
      for (int k = 0; k < M; ++k) {
        RC_ASSERT(whole.fractions()[k] == first.fractions()[k]);
        RC_ASSERT(whole.fractions()[k] == scaled.fractions()[k]);
      }
    });
  }));
}
