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
#include <phimis/solver/rules.hpp>
#include <phimis/technique/technique_set.hpp>
#include <phimis/validate.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace phimis {

/// How much to sample, and how.
struct integrate_options {
  std::int64_t budget = 500;  ///< samples in all, spread evenly over the iterations
  int iterations = 5;
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
  std::int64_t samples = 0;
  std::int64_t zero = 0;       ///< contributions that were 0
  std::int64_t nonfinite = 0;  ///< contributions that were not finite: each counts as a sample of value 0
  phimis::fractions<double, M> fractions{};  ///< for the next iteration
  integration_status status = integration_status::complete;
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
  static constexpr bool is = combination<T> || std::same_as<T, pooled>;
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

/// All samples of a run, for the pooled combination.
template <class Value, int M>
struct sample_pool {
  std::vector<drawn_sample<Value, M>> samples;
  per_technique<double, M> shares{};  // Σ_b n_b α_b

  template <class Heuristic>
  estimator<Value, M> combine(const Heuristic& heuristic) const {
    per_technique<double, M> alpha = shares;
    for (int k = 0; k < M; ++k) alpha[k] /= static_cast<double>(samples.size());
    estimator<Value, M> all;
    for (const auto& sample : samples) {
      const int k = sample.observed.technique;
      all.add(k, contribution(heuristic, k, sample.value, alpha, sample.observed.pdfs));
    }
    return all;
  }
};

template <class Value>
struct combined {
  Value estimate;
  Value standard_error;
  double effective_sample_size;
};

/// F = Σ w_b F_b / Σ w_b, Var F = Σ w_b² Var F_b / (Σ w_b)², over the iterations of a trace. An iteration of one sample
/// has the given spread.
template <class Value, int M, combination Combination>
combined<Value> combine(const Combination& combination, const std::vector<iteration<Value, M>>& trace,
                        const Value& spread) {
  using traits = value_traits<Value>;
  using real = typename traits::real;
  std::vector<iteration_summary> summaries;
  std::vector<Value> errors;
  double largest = 0;
  for (const auto& it : trace) {
    errors.push_back(it.samples > 1 ? it.standard_error : spread);
    const double error = static_cast<double>(traits::magnitude(errors.back()));
    summaries.push_back({it.samples, error, it.zero + it.nonfinite == it.samples});
    largest = std::max(largest, error);
  }
  std::vector<double> weights(trace.size());
  combination(std::span<const iteration_summary>(summaries), std::span<double>(weights));
  double sum = 0;
  for (const double w : weights) {
    require(is_density(w), "a combination's weights", "must be finite and not negative", w);
    sum += w;
  }
  require(sum > 0 && is_finite(sum), "a combination's weights", "must have a finite sum greater than 0", sum);

  // Squares are taken in units of the largest.
  const real unit = largest > 0 && is_finite(largest) ? static_cast<real>(largest) : real(1);
  Value estimate = traits::zero();
  Value variance = traits::zero();
  double reached = 0;
  double spent = 0;
  for (std::size_t b = 0; b < trace.size(); ++b) {
    const double share = weights[b] / sum;
    if (!(share > 0)) continue;
    estimate = estimate + trace[b].estimate * static_cast<real>(share);
    const Value part = errors[b] * (static_cast<real>(share) / unit);
    variance = variance + part * part;
    if (!(trace[b].effective_sample_size > 0)) continue;
    reached += share;
    spent += share * share / trace[b].effective_sample_size;
  }
  return {estimate, traits::root(variance) * unit, spent > 0 ? reached * reached / spent : 0};
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
///     combination       by_count{}
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

  auto default_rule = [] {
    if constexpr (M >= 2) {
      return exact_rule<M>(chi_squared{}, {.prior = 1});
    } else {
      return fixed_rule<M>();
    }
  }();
  auto default_source = [engine = std::mt19937_64(options.seed)]() mutable { return uniform(engine()); };
  const balance default_heuristic;
  const by_count default_combination;
  const auto default_callback = [](const line&) {};

  auto rule = detail::pick<detail::rule_kind>(default_rule, policies...);
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
  using rule_type = decltype(rule);
  static_assert(rule_type::techniques == M, "the rule must be for as many techniques as there are");
  static_assert(std::is_same_v<typename rule_type::real, double>,
                "integrate() observes in double: the rule must, too");
  using answer = decltype(callback(std::declval<const line&>()));
  static_assert(std::is_void_v<answer> || std::is_same_v<answer, progress>,
                "a callback of integrate() returns nothing or phimis::progress");
  validate(heuristic);
  if constexpr (requires { rule.divergence(); }) validate(rule.divergence());
  if constexpr (requires { rule.options(); }) validate(rule.options());

  bool decided = true;  // every batch had the multi-sample variance
  estimator<value, M> every_sample;
  constexpr bool pool = std::is_same_v<std::remove_cvref_t<decltype(combination)>, pooled>;
  detail::sample_pool<value, M> all;
  estimator<value, M> pooled_estimator;
  integration<value, M, rule_type> result{.rule = rule};

  for (int i = 0; i < options.iterations; ++i) {
    const std::int64_t each = options.budget / options.iterations;
    const std::int64_t samples = each + (i < options.budget % options.iterations ? 1 : 0);
    const fractions<double, M> alpha = result.rule.fractions();
    for (const double a : alpha) require(is_density(a) && a <= 1, "the rule's fractions", "must lie in [0, 1]", a);
    const auto drawn = draw_batch(f, techniques, alpha, {samples, options.model, options.rounding}, heuristic, next,
                                  [&](const drawn_sample<value, M>& sample) {
                                    result.rule.observe(sample.observed);
                                    if constexpr (pool) all.samples.push_back(sample);
                                  });
    line now{.index = i,
             .fractions = alpha,
             .counts = drawn.counts,
             .samples = samples,
             .zero = drawn.estimator.zero(),
             .nonfinite = drawn.estimator.nonfinite(),
             .estimate = drawn.estimator.estimate(),
             .standard_error = drawn.estimator.standard_error(drawn.variance),
             .effective_sample_size = static_cast<double>(drawn.estimator.effective_sample_size()),
             .combined_estimate = value_traits<value>::zero(),
             .combined_standard_error = value_traits<value>::zero(),
             .status = result.rule.update()};
    decided = decided && drawn.variance == sampling_model::multi_sample;
    every_sample.merge(drawn.estimator);
    result.trace.push_back(now);
    result.samples += samples;
    result.zero += now.zero;
    result.nonfinite += now.nonfinite;
    if constexpr (pool) {
      for (int k = 0; k < M; ++k) all.shares[k] += drawn.fractions[k] * static_cast<double>(samples);
      pooled_estimator = all.combine(heuristic);
      result.estimate = pooled_estimator.estimate();
      result.standard_error =
          pooled_estimator.standard_error(decided ? sampling_model::multi_sample : sampling_model::one_sample);
      result.effective_sample_size = static_cast<double>(pooled_estimator.effective_sample_size());
    } else {
      // The spread of one sample is that of all.
      const value spread = every_sample.standard_error(sampling_model::one_sample) *
                           static_cast<typename value_traits<value>::real>(std::sqrt(result.samples));
      const auto combined = detail::combine(combination, result.trace, spread);
      result.estimate = combined.estimate;
      result.standard_error = combined.standard_error;
      result.effective_sample_size = combined.effective_sample_size;
    }
    if (result.zero + result.nonfinite == result.samples) result.standard_error = value_traits<value>::unknown();
    result.trace.back().combined_estimate = result.estimate;
    result.trace.back().combined_standard_error = result.standard_error;
    if constexpr (std::is_void_v<decltype(callback(result.trace.back()))>) {
      callback(result.trace.back());
    } else if (callback(result.trace.back()) == progress::stop && i + 1 < options.iterations) {
      result.status = integration_status::stopped;
      break;
    }
  }
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
