// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CONCEPTS_HPP
#define PHIMIS_CONCEPTS_HPP

#include <phimis/core/divergence.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/observation.hpp>
#include <phimis/core/rule.hpp>

#include <concepts>
#include <type_traits>

namespace phimis {

/// The host's uniform numbers: each call returns the next one, in [0, 1).
template <class T>
concept uniform_source = requires(T& next) {
  { next() } -> std::floating_point;
};

namespace detail {
using any_uniform_source = double (*)();
}

/// A way to sample points and the density it samples them with.
///
/// `sample` draws from exactly the density that `pdf` returns, using any number of uniform numbers. pdf >= 0, and it
/// integrates to one over the domain; to less where some samples are lost (they count, with f = 0).
template <class T>
concept technique = requires(const T& t, detail::any_uniform_source next) {
  { t.pdf(t.sample(next)) } -> std::convertible_to<double>;
};

/// A technique that finds the uniform number which gives a point: sample(u) = x means invert(x) = u.
template <class T>
concept invertible_technique = technique<T> && requires(const T& t, detail::any_uniform_source next) {
  { t.invert(t.sample(next)) } -> std::convertible_to<double>;
};

/// A divergence that is given by φ: the power family by its exponent and φ, any other by φ's derivatives.
///
/// φ is convex with φ(1) = 0.
template <class T>
concept phi_divergence_policy = requires(const T& d, double t) {
  { d.taylor(t) } -> std::same_as<phi_taylor<double>>;
}
|| requires(const T& d, double t) {
  { d.exponent() } -> std::convertible_to<double>;
  { d.phi(t) } -> std::convertible_to<double>;
};

namespace detail {
template <class T>
struct is_reversed_phi : std::false_type {};
template <phi_divergence_policy D>
struct is_reversed_phi<reversed<D>> : std::true_type {};
}  // namespace detail

/// What "mimics" means: a φ-divergence, a reversed one, or the multi-sample variance. Reversed twice it is itself: write
/// that.
template <class T>
concept divergence =
    phi_divergence_policy<T> || detail::is_reversed_phi<T>::value || std::same_as<T, multi_sample_variance>;

/// How techniques share one sample: weights w_1..w_M in [0, 1] that sum to one where any α_k p_k > 0, and w_k = 0
/// where p_k = 0.
template <class T>
concept weight_heuristic = requires(const T& w, fractions<double, 2> alpha, per_technique<double, 2> pdfs) {
  { w(0, alpha, pdfs) } -> std::convertible_to<double>;
};

/// How observations become fractions. `observe` adds to the state, `update` changes the fractions and nothing else
/// does, `merge` adds what another state has observed.
template <class T>
concept rule = requires(T& r, const T& other, const observation<typename T::real, T::techniques>& sample) {
  r.observe(sample);
  { r.update() } -> std::same_as<rule_status>;
  { other.fractions() } -> std::convertible_to<fractions<typename T::real, T::techniques>>;
  { other.status() } -> std::same_as<rule_status>;
  r.merge(other);
};

}  // namespace phimis

#endif  // PHIMIS_CONCEPTS_HPP
