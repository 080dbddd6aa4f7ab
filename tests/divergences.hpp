// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_DIVERGENCES_HPP
#define PHIMIS_TESTS_DIVERGENCES_HPP

#include <phimis/core/divergence.hpp>

#include <cmath>

/// φ and its derivatives by algebra, in long double: what the library's are held against.
struct true_phi {
  long double value, first, second;
};

inline true_phi true_phi_at(const phimis::tsallis& d, long double t) {
  const long double g = d.gamma;
  if (g == 1) return {t * std::log(t), std::log(t) + 1, 1 / t};
  return {(std::pow(t, g) - t) / (g - 1), (g * std::pow(t, g - 1) - 1) / (g - 1), g * std::pow(t, g - 2)};
}
inline true_phi true_phi_at(const phimis::kullback_leibler&, long double t) {
  return {t * std::log(t), std::log(t) + 1, 1 / t};
}
inline true_phi true_phi_at(const phimis::chi_squared&, long double t) { return {t * t - t, 2 * t - 1, 2}; }
inline true_phi true_phi_at(const phimis::hellinger&, long double t) {
  return {t - std::sqrt(t), 1 - 1 / (2 * std::sqrt(t)), 1 / (4 * t * std::sqrt(t))};
}
inline true_phi true_phi_at(const phimis::total_variation&, long double t) {
  return {std::fabs(t - 1) / 2, t > 1 ? 0.5L : t < 1 ? -0.5L : 0, 0};
}
inline true_phi true_phi_at(const phimis::pearson_vajda& d, long double t) {
  const long double k = d.k;
  const long double sign = t > 1 ? 1 : t < 1 ? -1 : 0;
  const long double second = k == 1 ? 0 : k * (k - 1) * std::pow(std::fabs(t - 1), k - 2);
  return {std::pow(std::fabs(t - 1), k), k * sign * std::pow(std::fabs(t - 1), k - 1), second};
}
/// φ*(t) = t φ(1/t)
template <class D>
true_phi true_phi_at(const phimis::reversed<D>& d, long double t) {
  const true_phi phi = true_phi_at(d.forward, 1 / t);
  return {t * phi.value, phi.value - phi.first / t, phi.second / (t * t * t)};
}

/// s = t φ' − φ and t s' = t² φ''
template <class D>
phimis::score<long double> true_score_at(const D& d, long double t) {
  const true_phi phi = true_phi_at(d, t);
  return {t * phi.first - phi.value, t * t * phi.second};
}

/// f(name, divergence) for every built-in divergence that has a score, forward and reversed.
template <class F>
void for_each_divergence(F&& f) {
  const auto both = [&f](const char* name, const char* reversed_name, const auto& d) {
    f(name, d);
    f(reversed_name, phimis::reversed<std::decay_t<decltype(d)>>{d});
  };
  both("Kullback-Leibler", "reversed Kullback-Leibler", phimis::kullback_leibler{});
  both("chi squared", "reversed chi squared", phimis::chi_squared{});
  both("Hellinger", "reversed Hellinger", phimis::hellinger{});
  both("one-sample variance", "reversed one-sample variance", phimis::one_sample_variance{});
  both("Tsallis 0.1", "reversed Tsallis 0.1", phimis::tsallis{0.1});
  both("Tsallis 0.7", "reversed Tsallis 0.7", phimis::tsallis{0.7});
  both("Tsallis 1", "reversed Tsallis 1", phimis::tsallis{1});
  both("Tsallis 3.5", "reversed Tsallis 3.5", phimis::tsallis{3.5});
  both("total variation", "reversed total variation", phimis::total_variation{});
  both("Pearson-Vajda 1", "reversed Pearson-Vajda 1", phimis::pearson_vajda{1});
  both("Pearson-Vajda 1.5", "reversed Pearson-Vajda 1.5", phimis::pearson_vajda{1.5});
  both("Pearson-Vajda 2", "reversed Pearson-Vajda 2", phimis::pearson_vajda{2});
  both("Pearson-Vajda 3", "reversed Pearson-Vajda 3", phimis::pearson_vajda{3});
}

#endif  // PHIMIS_TESTS_DIVERGENCES_HPP
