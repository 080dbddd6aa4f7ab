// SPDX-License-Identifier: MIT
#ifndef PHIMIS_BENCH_METHODS_HPP
#define PHIMIS_BENCH_METHODS_HPP

#include "peers/adam.hpp"
#include "peers/multichannel.hpp"
#include "problems.hpp"

#include <phimis/estimator/control_variates.hpp>
#include <phimis/estimator/optimal_mis.hpp>
#include <phimis/phimis.hpp>
#include <phimis/solver/joint_minimiser.hpp>

#ifdef PHIMIS_BENCH_GSL
#include "peers/vegas.hpp"
#endif

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

/// Everything that is compared: an estimate from a budget and a seed.
namespace bench {

enum class kind {
  oracle,  ///< knows the best fractions
  chosen,  ///< of this library: the default, and what the documentation recommends
  peer,    ///< others, from what they published
  other    ///< of this library
};

template <int M>
struct method {
  std::string name;
  kind of;
  std::function<double(const problem<M>&, std::int64_t budget, std::uint64_t seed)> run;
};

/// `integrate` with policies.
template <int M, class... Policies>
method<M> by_integrate(std::string name, kind of, const phimis::integrate_options& options,
                       const Policies&... policies) {
  return {std::move(name), of, [=](const problem<M>& on, std::int64_t budget, std::uint64_t seed) {
            phimis::integrate_options with = options;
            with.budget = budget;
            with.seed = seed;
            return phimis::integrate(on.f, on.techniques, with, policies...).estimate;
          }};
}

/// Fractions that stay, all samples at once.
template <int M>
double at_fractions(const problem<M>& on, const phimis::fractions<double, M>& alpha, std::int64_t budget,
                    std::uint64_t seed) {
  return phimis::integrate(on.f, on.techniques, {.budget = budget, .iterations = 1, .seed = seed},
                           phimis::fixed_rule<M>({.start = alpha}))
      .estimate;
}

/// Optimal MIS, the direct estimator, at equal counts.
template <int M>
double optimal_mis(const problem<M>& on, std::int64_t budget, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  auto next = [&] { return phimis::uniform(engine()); };
  const auto equal = phimis::equal_fractions<double, M>();
  // Weights hold for the counts, which need not be quite equal.
  const auto counts = phimis::split_largest_remainder(equal, budget);
  phimis::fractions<double, M> alpha{};
  for (int k = 0; k < M; ++k) alpha[k] = static_cast<double>(counts[k]) / static_cast<double>(budget);
  phimis::optimal_mis<double, M> estimate(alpha);
  phimis::draw_batch(on.f, on.techniques, equal, {budget}, phimis::balance{}, next,
                     [&](const phimis::drawn_sample<double, M>& sample) {
                       estimate.add(sample.observed.technique, sample.value, sample.observed.pdfs);
                     });
  return estimate.estimate();
}

/// A rule that changes its fractions after every sample, as stochastic descent does.
template <class Rule>
double sample_by_sample(const problem<2>& on, Rule rule, std::int64_t budget, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  auto next = [&] { return phimis::uniform(engine()); };
  double sum = 0;
  for (std::int64_t j = 0; j < budget; ++j) {
    phimis::draw_batch(on.f, on.techniques, rule.fractions(), {1, phimis::sampling_model::one_sample},
                       phimis::balance{}, next, [&](const phimis::drawn_sample<double, 2>& sample) {
                         sum += sample.contribution;
                         rule.observe(sample.observed);
                       });
    rule.update();
  }
  return sum / static_cast<double>(budget);
}

template <int M>
std::vector<method<M>> methods() {
  using namespace phimis;
  const integrate_options decided;
  const integrate_options even{.growth = 1};
  const integrate_options one_sample{.growth = 1,
                                     .model = sampling_model::one_sample};  // of peers, as they were published
  std::vector<method<M>> all;
  const auto add = [&](const char* name, kind of, const auto&... policies) {
    all.push_back(by_integrate<M>(name, of, decided, policies...));
  };

  all.push_back({"oracle fractions", kind::oracle, [](const problem<M>& on, std::int64_t budget, std::uint64_t seed) {
                   return at_fractions(on, on.best, budget, seed);
                 }});
  add("default", kind::chosen);
  all.push_back(by_integrate<M>("default, even iterations by_count", kind::chosen, even, by_count{}));
  add("default, pooled", kind::chosen, pooled{});
  add("default, cross_fitted_control_variates", kind::chosen, cross_fitted_control_variates{});
  add("joint, cross_fitted_control_variates", kind::chosen, joint_rule<M>(), cross_fitted_control_variates{});
  add("joint, pooled_control_variates", kind::chosen, joint_rule<M>(), pooled_control_variates{});
  add("joint, pooled_control_variates, no shrinkage", kind::chosen, joint_rule<M>(),
      pooled_control_variates{shrinkage::off});

  all.push_back({"equal counts", kind::peer, [](const problem<M>& on, std::int64_t budget, std::uint64_t seed) {
                   return at_fractions(on, equal_fractions<double, M>(), budget, seed);
                 }});
  all.push_back({"Optimal MIS, equal counts", kind::peer, optimal_mis<M>});
  if constexpr (M == 2) {
    for (const double power : {1.0, 2.0}) {
      all.push_back({power == 1 ? "Adam, Kullback–Leibler" : "Adam, variance", kind::peer,
                     [power](const problem<M>& on, std::int64_t budget, std::uint64_t seed) {
                       return sample_by_sample(on, peers::adam(power), budget, seed);
                     }});
    }
  }
  for (const double beta : {0.25, 0.5}) {
    const std::string name = beta < 0.5 ? "multichannel β = .25" : "multichannel β = .5";
    const peers::multichannel<M> rule(beta);
    all.push_back(by_integrate<M>(name, kind::peer, one_sample, rule, inverse_variance{}));
    all.push_back(by_integrate<M>(name + ", by_count", kind::peer, one_sample, rule, by_count{}));
  }
#ifdef PHIMIS_BENCH_GSL
  all.push_back({"VEGAS (GSL)", kind::peer, peers::vegas<problem<M>>});
#endif

  add("default, by_count", kind::other, by_count{});
  add("default, fixed_weights .5, 1", kind::other, fixed_weights({.5, 1}));
  add("default, inverse_variance", kind::other, inverse_variance{});
  add("default, progressive_control_variates", kind::other, progressive_control_variates{});
  add("default, pooled_control_variates", kind::other, pooled_control_variates{});
  add("joint, progressive_control_variates", kind::other, joint_rule<M>(), progressive_control_variates{});
  if constexpr (M == 2) {
    add("newton_rule, Kullback–Leibler, the paper's", kind::other,
        newton_rule(kullback_leibler{}, newton_form::paper));
    add("newton_rule, χ²", kind::other, newton_rule(chi_squared{}));
  }
  add("streaming_rule, Kullback–Leibler", kind::other, streaming_rule<M>(kullback_leibler{}));
  add("streaming_rule, χ²", kind::other, streaming_rule<M>(chi_squared{}));
  add("linear_rule", kind::other, linear_rule<M>());
  add("second_order_rule", kind::other, second_order_rule<M>());
  add("inverse_variance_rule", kind::other, inverse_variance_rule<M>());
  add("sigma_rule, count_independent weights", kind::other, sigma_rule<M>(), count_independent<balance>{});
  add("exact_rule, γ = ½", kind::other, exact_rule<M>(tsallis{0.5}));
  add("exact_rule, Kullback–Leibler", kind::other, exact_rule<M>(kullback_leibler{}));
  add("exact_rule, V[F]", kind::other, exact_rule<M>(multi_sample_variance{}));
  all.push_back(
      by_integrate<M>("default in one-sample sampling", kind::other, {.model = sampling_model::one_sample}));
  return all;
}

}  // namespace bench

#endif  // PHIMIS_BENCH_METHODS_HPP
