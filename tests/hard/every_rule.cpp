// SPDX-License-Identifier: MIT
// The lists of every rule and every divergence, and that they are lists of all.
#include "any_rule.hpp"
#include "catch.hpp"
#include "divergences.hpp"

#include <phimis/solver/joint_minimiser.hpp>
#include <phimis/solver/rules.hpp>

#include <set>
#include <type_traits>

namespace hard {

namespace {

template <class Divergence>
bool has_step(const Divergence& divergence) {
  if constexpr (std::is_same_v<Divergence, phimis::total_variation>) {
    return true;
  } else if constexpr (std::is_same_v<Divergence, phimis::pearson_vajda>) {
    return divergence.k == 1;
  } else {
    return false;
  }
}
template <class Divergence>
bool has_step(const phimis::reversed<Divergence>& divergence) {
  return has_step(divergence.forward);
}

template <class Divergence>
any_divergence describe(const char* name, const Divergence& divergence) {
  any_divergence result{};
  result.name = name;
  result.infinite_at_zero = phimis::infinite_at_zero(divergence);
  if constexpr (phimis::has_exponent<Divergence>::value) {
    result.power = true;
    result.exponent = divergence.exponent();
  }
  result.steps = has_step(divergence);
  result.variance = std::is_same_v<Divergence, phimis::multi_sample_variance>;
  result.optimum = [divergence](const auto& on, const auto& options) {
    return phimis::analysis::optimum(divergence, on, options);
  };
  return result;
}

const any_divergence* named(const std::string& name) {
  for (const any_divergence& divergence : every_divergence()) {
    if (divergence.name == name) return &divergence;
  }
  FAIL("no divergence " << name);
  return nullptr;
}

}  // namespace

const std::vector<any_divergence>& every_divergence() {
  static const std::vector<any_divergence> all = [] {
    std::vector<any_divergence> list;
    for_each_divergence(
        [&](const char* name, const auto& divergence) { list.push_back(describe(name, divergence)); });
    return list;
  }();
  return all;
}

const any_divergence& multi_sample_variance() {
  static const any_divergence variance = describe("V[F]", phimis::multi_sample_variance{});
  return variance;
}

template <class Real, int M>
std::vector<any_rule<Real, M>> exact_rules(const phimis::rule_options<Real, M>& options,
                                           phimis::control_variate variate) {
  std::vector<any_rule<Real, M>> all;
  const auto add = [&](const any_divergence& of, const auto& divergence) {
    using rule_type = phimis::exact_minimiser<std::decay_t<decltype(divergence)>, phimis::table<Real, M>>;
    all.emplace_back("exact, " + of.name, way::at_once, &of, rule_type(divergence, options, variate));
  };
  std::size_t i = 0;
  for_each_divergence([&](const char*, const auto& divergence) { add(every_divergence()[i++], divergence); });
  add(multi_sample_variance(), phimis::multi_sample_variance{});
  return all;
}

template <class Real, int M>
std::vector<any_rule<Real, M>> every_rule(const phimis::rule_options<Real, M>& options,
                                          phimis::control_variate variate) {
  using phimis::negative_fractions;
  using phimis::newton_form;
  auto all = exact_rules<Real, M>(options, variate);
  const auto add = [&](const char* name, way how, const any_divergence* divergence, const auto& rule) {
    all.emplace_back(divergence ? std::string(name) + ", " + divergence->name : name, how, divergence, rule);
  };
  for_each_divergence([&](const char* name, const auto& divergence) {
    using type = std::decay_t<decltype(divergence)>;
    if constexpr (phimis::has_exponent<type>::value) {
      if constexpr (M == 2) {
        for (const newton_form form : {newton_form::safeguarded, newton_form::paper}) {
          add(form == newton_form::paper ? "Newton as printed" : "Newton", way::by_steps, named(name),
              phimis::newton_raphson<type, Real>(divergence, form, options));
        }
      }
      if (divergence.exponent() > 0) {
        add("streaming", way::by_steps, named(name),
            phimis::streaming_newton<type, Real, M>(divergence, options, Real(0)));
      }
    }
  });
  add("streaming", way::by_steps, &multi_sample_variance(),
      phimis::streaming_newton<phimis::multi_sample_variance, Real, M>({}, options, Real(0.5)));
  add("fixed", way::otherwise, nullptr, phimis::fixed_rule<M, Real>(options));
  add("linear, projected", way::otherwise, nullptr,
      phimis::linear_rule<M, negative_fractions::project, Real>(options));
  add("linear, most negative dropped", way::otherwise, nullptr,
      phimis::linear_rule<M, negative_fractions::drop_most_negative, Real>(options));
  add("linear, best face", way::otherwise, nullptr,
      phimis::linear_rule<M, negative_fractions::best_face, Real>(options));
  add("sigma", way::otherwise, nullptr, phimis::sigma_rule<M, Real>(options));
  add("inverse variance", way::otherwise, nullptr, phimis::inverse_variance_rule<M, Real>(options));
  add("second order", way::otherwise, nullptr, phimis::second_order_rule<M, Real>(options));
  if constexpr (std::is_same_v<Real, double>) {
    add("joint", way::otherwise, nullptr, phimis::joint_minimiser<M>(options, variate));
  }
  return all;
}

#define PHIMIS_RULES(Real, M)                                                                        \
  template std::vector<any_rule<Real, M>> exact_rules<Real, M>(const phimis::rule_options<Real, M>&, \
                                                               phimis::control_variate);             \
  template std::vector<any_rule<Real, M>> every_rule<Real, M>(const phimis::rule_options<Real, M>&,  \
                                                              phimis::control_variate);
PHIMIS_RULES(float, 2)
PHIMIS_RULES(float, 3)
PHIMIS_RULES(double, 2)
PHIMIS_RULES(double, 3)

}  // namespace hard

static_assert(phimis::rule<hard::any_rule<double, 2>>);

TEST_CASE("The list of every rule has each once, and starts where its options say") {
  const auto count = [](const auto& rules) {
    std::set<std::string> names;
    for (const auto& rule : rules) {
      names.insert(rule.name());
      CHECK(rule.status() == phimis::rule_status::start);
      for (const auto a : rule.fractions()) CHECK(a == 1 / static_cast<decltype(a)>(rule.techniques));
    }
    CHECK(names.size() == rules.size());
    return rules.size();
  };
  REQUIRE(hard::every_divergence().size() == 26);
  CHECK(count(hard::exact_rules<double, 2>()) == 27);
  // 26 divergences and V[F]; Newton in two forms for the 16 powers, of two techniques alone; streaming for the 11 powers
  // that are positive and for V[F]; seven rules without a divergence, and the joint rule, which has no float.
  CHECK(count(hard::every_rule<double, 2>()) == 27 + 2 * 16 + 12 + 7 + 1);
  CHECK(count(hard::every_rule<float, 2>()) == 27 + 2 * 16 + 12 + 7);
  CHECK(count(hard::every_rule<double, 3>()) == 27 + 12 + 7 + 1);
  CHECK(count(hard::every_rule<float, 3>()) == 27 + 12 + 7);
}
