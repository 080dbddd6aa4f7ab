// SPDX-License-Identifier: MIT
#ifndef PHIMIS_INTEGRATE_HPP
#define PHIMIS_INTEGRATE_HPP

#include <phimis/concepts.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/uniform.hpp>
#include <phimis/error.hpp>
#include <phimis/estimator/batch.hpp>
#include <phimis/estimator/combination.hpp>
#include <phimis/estimator/control_coefficients.hpp>
#include <phimis/estimator/iteration_sizes.hpp>
#include <phimis/estimator/run_estimate.hpp>
#include <phimis/solver/rules.hpp>
#include <phimis/technique/technique_set.hpp>
#include <phimis/validate.hpp>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace phimis {

/// How much to sample, and how.
struct integrate_options {
  std::int64_t budget = 500;  ///< samples in all
  int iterations = 5;
  /// The samples of the last iteration over those of the first, in equal ratios between: few are drawn before anything is
  /// learnt. 1 spreads them evenly. See `iteration_sizes`.
  double growth = 16;
  sampling_model model = sampling_model::multi_sample;
  phimis::rounding rounding = rounding::largest_remainder;  ///< of decided counts
  std::uint64_t seed = 1;  ///< of the default uniform numbers, std::mt19937_64; another for every run to be combined
};

/// A callback's answer.
enum class progress { go_on, stop };

enum class integration_status {
  complete,
  stopped,  ///< by the callback
  all_zero  ///< stopped or not, no sample had a finite f ≠ 0: the estimate is 0 and its standard error infinite
};

/// One line of the trace.
template <class Value, int M>
struct iteration {
  int index;  ///< from 0
  phimis::fractions<double, M> fractions;
  phimis::counts<M> counts;
  std::int64_t samples;
  std::int64_t zero;
  std::int64_t nonfinite;
  Value estimate;  ///< of this iteration alone
  Value standard_error;
  double effective_sample_size;
  double degrees_of_freedom;  ///< of its standard error; see `estimator`
  Value combined_estimate;  ///< of all iterations so far
  Value combined_standard_error;
  rule_status status;  ///< of the rule's update after this iteration
};

/// What a run found: the combined estimate, and all that is needed to judge or continue it.
template <class Value, int M, class Rule>
struct integration {
  Value estimate = value_traits<Value>::zero();
  Value standard_error = value_traits<Value>::zero();
  double effective_sample_size = 0;  ///< of all samples as they were combined
  double degrees_of_freedom = 0;     ///< of the standard error: for `analysis::confidence_interval`; 0 where it is unknown
  std::int64_t samples = 0;
  double cost = 0;             ///< Σ n_k c_k with the costs of the rule; 1 a sample where it has none
  double efficiency = 0;       ///< 1/(cost × variance), of a colour by its magnitude; 0 where the variance is unknown
  std::int64_t zero = 0;       ///< contributions that were 0
  std::int64_t nonfinite = 0;  ///< contributions that were not finite: each counts as a sample of value 0
  phimis::fractions<double, M> fractions{};  ///< for the next iteration
  integration_status status = integration_status::complete;
  /// The control variates of the estimate, or of the last iteration's; 0 without.
  control_coefficients<Value, M> control{};
  std::vector<iteration<Value, M>> trace{};
  Rule rule;  ///< the state of the rule, to continue from
};

namespace detail {

// The kinds of policy that integrate() takes in any order.
struct rule_kind {
  template <class T>
  static constexpr bool is = rule<T>;
};
struct heuristic_kind {
  template <class T>
  static constexpr bool is = weight_heuristic<T>;
};
struct combination_kind {
  template <class T>
  static constexpr bool is = combination<T> || run_policy<T>;
};
struct source_kind {
  template <class T>
  static constexpr bool is = uniform_source<T>;
};
template <class Iteration>
struct callback_kind {
  template <class T>
  static constexpr bool is = std::invocable<T&, const Iteration&>;
};

/// How many policies are of a kind.
template <class Kind, class... Policies>
inline constexpr int how_many = (0 + ... + (Kind::template is<std::remove_cvref_t<Policies>> ? 1 : 0));

/// The first policy of a kind, or the default.
template <class Kind, class Default>
Default& pick(Default& otherwise) {
  return otherwise;
}
template <class Kind, class Default, class First, class... Rest>
auto& pick(Default& otherwise, First& first, Rest&... rest) {
  if constexpr (Kind::template is<std::remove_const_t<First>>) {
    return first;
  } else {
    return pick<Kind>(otherwise, rest...);
  }
}

}  // namespace detail

/// The integral of f, with fractions learnt from iteration to iteration.
///
///     for every iteration:  draw a batch at the rule's fractions
///                           estimate, observe every sample, update the rule
///     combine the iterations
///
/// Policies follow in any order, each by value and each with a default:
///
///     rule              exact_rule<M>(chi_squared{}, {.prior = 1})
///     weight heuristic  balance{}
///     combination       square_root{}; by_count{} where the fractions are fixed
///     uniform numbers   std::mt19937_64 of options.seed; any callable that returns the next one, taken by reference
///     callback          none; called after each iteration, may return progress::stop
///
/// Source   T Sec. 4, Eqs. 6, 8; the fractions of an iteration depend on earlier ones only, so each is unbiased.
/// Requires f(point) of a type with value_traits; techniques that together reach all of f's support, each with a
///          fraction above 0.
/// Errors   std::invalid_argument for options and policies out of range. Samples that are not finite are counted.
///
/// \param f          the integrand
/// \param techniques a technique_set
/// \return the estimate with its standard error, and the trace
template <class Integrand, technique... Techniques, class... Policies>
auto integrate(const Integrand& f, const technique_set<Techniques...>& techniques, const integrate_options& options,
               Policies&&... policies) {
  constexpr int M = sizeof...(Techniques);
  using value = std::decay_t<decltype(f(std::declval<typename technique_set<Techniques...>::point>()))>;
  static_assert(std::is_floating_point_v<value> || std::is_class_v<value>,
                "the integrand must return a floating-point number, or a type with phimis::value_traits");
  using line = iteration<value, M>;

  require(options.iterations >= 1, "iterations", "must be at least 1", options.iterations);
  require(options.budget >= options.iterations, "budget",
          "must be at least one sample for each of " + std::to_string(options.iterations) + " iterations",
          options.budget);
  require(is_finite(options.growth) && options.growth > 0, "growth", "must be finite and greater than 0",
          options.growth);

  auto default_rule = [] {
    if constexpr (M >= 2) {
      return exact_rule<M>(chi_squared{}, {.prior = 1});
    } else {
      return fixed_rule<M>();
    }
  }();
  auto default_source = [engine = std::mt19937_64(options.seed)]() mutable { return uniform(engine()); };
  const balance default_heuristic;
  const auto default_callback = [](const line&) {};

  auto rule = detail::pick<detail::rule_kind>(default_rule, policies...);
  using rule_type = decltype(rule);
  // Where nothing is learnt no iteration is better than another.
  using default_combination_type =
      std::conditional_t<std::is_same_v<rule_type, fixed_fractions<double, M>>, by_count, square_root>;
  const default_combination_type default_combination;
  const auto& heuristic = detail::pick<detail::heuristic_kind>(default_heuristic, policies...);
  const auto& combination = detail::pick<detail::combination_kind>(default_combination, policies...);
  auto& next = detail::pick<detail::source_kind>(default_source, policies...);
  auto& callback = detail::pick<detail::callback_kind<line>>(default_callback, policies...);
  static_assert(
      ((detail::rule_kind::is<std::remove_cvref_t<Policies>> ||
        detail::heuristic_kind::is<std::remove_cvref_t<Policies>> ||
        detail::combination_kind::is<std::remove_cvref_t<Policies>> ||
        detail::source_kind::is<std::remove_cvref_t<Policies>> ||
        detail::callback_kind<line>::template is<std::remove_reference_t<Policies>>)&&...),
      "a policy of integrate() is a rule, a weight heuristic, a combination, a uniform source or a callback");
  static_assert(detail::how_many<detail::rule_kind, Policies...> <= 1 &&
                    detail::how_many<detail::heuristic_kind, Policies...> <= 1 &&
                    detail::how_many<detail::combination_kind, Policies...> <= 1 &&
                    detail::how_many<detail::source_kind, Policies...> <= 1 &&
                    detail::how_many<detail::callback_kind<line>, Policies...> <= 1,
                "integrate() takes at most one policy of each kind");
  static_assert(rule_type::techniques == M, "the rule must be for as many techniques as there are");
  static_assert(std::is_same_v<typename rule_type::real, double>,
                "integrate() observes in double: the rule must, too");
  using answer = decltype(callback(std::declval<const line&>()));
  static_assert(std::is_void_v<answer> || std::is_same_v<answer, progress>,
                "a callback of integrate() returns nothing or phimis::progress");
  validate(heuristic);
  if constexpr (requires { rule.divergence(); }) validate(rule.divergence());
  per_technique<double, M> costs = equal_costs<double, M>();
  if constexpr (requires { rule.options(); }) {
    validate(rule.options());
    costs = rule.options().costs;
    if constexpr (requires { rule.divergence(); }) validate_costs<double>(rule.divergence(), costs.value);
  }

  using combination_type = std::remove_cvref_t<decltype(combination)>;
  estimator<value, M> every_sample;
  typename detail::run_of<value, M, combination_type>::type estimates(combination, options.model);
  integration<value, M, rule_type> result{.rule = rule};
  const std::vector<std::int64_t> sizes =
      iteration_sizes(options.budget, options.iterations, options.growth, M);

  for (int i = 0; i < options.iterations; ++i) {
    const std::int64_t samples = sizes[static_cast<std::size_t>(i)];
    const fractions<double, M> alpha = result.rule.fractions();
    for (const double a : alpha) require(is_density(a) && a <= 1, "the rule's fractions", "must lie in [0, 1]", a);
    const auto drawn = draw_batch(f, techniques, alpha, {samples, options.model, options.rounding}, heuristic, next,
                                  [&](const drawn_sample<value, M>& sample) {
                                    result.rule.observe(sample.observed);
                                    estimates.add(sample);
                                  });
    const estimator<value, M> own = estimates.close(drawn);
    line now{.index = i,
             .fractions = alpha,
             .counts = drawn.counts,
             .samples = samples,
             .zero = drawn.estimator.zero(),
             .nonfinite = drawn.estimator.nonfinite(),
             .estimate = own.estimate(),
             .standard_error = own.standard_error(drawn.variance),
             .effective_sample_size = static_cast<double>(own.effective_sample_size()),
             .degrees_of_freedom = static_cast<double>(own.degrees_of_freedom(drawn.variance)),
             .combined_estimate = value_traits<value>::zero(),
             .combined_standard_error = value_traits<value>::zero(),
             .status = result.rule.update()};
    every_sample.merge(own);
    result.trace.push_back(now);
    result.samples += samples;
    for (int k = 0; k < M; ++k) result.cost += static_cast<double>(drawn.counts[k]) * costs[k];
    result.zero += now.zero;
    result.nonfinite += now.nonfinite;
    // The spread of one sample is that of all.
    const value spread = every_sample.standard_error(sampling_model::one_sample) *
                         static_cast<typename value_traits<value>::real>(std::sqrt(result.samples));
    const auto combined = estimates.total(heuristic, result.trace, spread);
    result.estimate = combined.estimate;
    result.standard_error = combined.standard_error;
    result.effective_sample_size = combined.effective_sample_size;
    result.degrees_of_freedom = combined.degrees_of_freedom;
    result.control = estimates.control();
    if (result.zero + result.nonfinite == result.samples) {
      result.standard_error = value_traits<value>::unknown();
      result.degrees_of_freedom = 0;
    }
    result.trace.back().combined_estimate = result.estimate;
    result.trace.back().combined_standard_error = result.standard_error;
    if constexpr (std::is_void_v<decltype(callback(result.trace.back()))>) {
      callback(result.trace.back());
    } else if (callback(result.trace.back()) == progress::stop && i + 1 < options.iterations) {
      result.status = integration_status::stopped;
      break;
    }
  }
  const double error = static_cast<double>(value_traits<value>::magnitude(result.standard_error));
  result.efficiency = 1 / (result.cost * error * error);
  result.fractions = result.rule.fractions();
  if (result.zero + result.nonfinite == result.samples) result.status = integration_status::all_zero;
  return result;
}

/// With the default options: 500 samples in 5 iterations.
template <class Integrand, technique... Techniques, class... Policies>
requires(!std::same_as<std::remove_cvref_t<Policies>, integrate_options> &&
         ...) auto integrate(const Integrand& f, const technique_set<Techniques...>& techniques,
                             Policies&&... policies) {
  return integrate(f, techniques, integrate_options{}, std::forward<Policies>(policies)...);
}

}  // namespace phimis

#endif  // PHIMIS_INTEGRATE_HPP
