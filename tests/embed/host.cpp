// SPDX-License-Identifier: MIT
// A renderer's build: no exceptions, no RTTI, no heap, float, and perhaps -ffast-math.
#include <phimis/core.hpp>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <type_traits>

namespace {

// f = x² + 1 under p_1 = 3x², p_2 = 1 on [0, 1]: every divergence has its optimum at α = (¼, ¾).
template <class Real>
phimis::observation<Real, 2> sample_of(int technique, Real u) {
  const Real x = technique == 0 ? std::cbrt(u) : u;
  return {x * x + 1, {{3 * x * x, 1}}, (3 * x * x + 1) / 2, technique};
}

template <class Rule>
void learn(Rule& rule, typename Rule::real scale = 1) {
  for (int j = 0; j < 64; ++j) {
    using Real = typename Rule::real;
    auto sample = sample_of<Real>(j % 2, (static_cast<Real>(j) + Real(0.5)) / 64);
    sample.f *= scale;
    rule.observe(sample);
  }
}

template <class Divergence, class Real>
bool finds_the_optimum(const Divergence& divergence) {
  phimis::exact_minimiser<Divergence, phimis::fixed_table<Real, 2, 64>> rule(divergence);
  static_assert(std::is_trivially_copyable<decltype(rule)>::value, "a pixel's state is copied by its bytes");
  learn(rule);
  rule.update();
  const double distance = static_cast<double>(rule.fractions()[0]) - 0.25;
  const double tolerance = std::is_same<Real, float>::value ? 2e-3 : 1e-6;
  if (distance < tolerance && -distance < tolerance) return true;
  std::printf("%s: %.9f in place of 0.25\n", __PRETTY_FUNCTION__, distance + 0.25);
  return false;
}

// From sums alone, from batches of the same samples.
template <class Real>
bool streams_to_the_optimum() {
  phimis::streaming_newton<phimis::kullback_leibler, Real, 2> rule;
  static_assert(std::is_trivially_copyable<decltype(rule)>::value, "a pixel's state is copied by its bytes");
  static_assert(sizeof(Real) == 8 || sizeof(rule.state()) <= 64, "a pixel's state");
  for (int batch = 0; batch < 8; ++batch) {
    learn(rule);
    rule.update();
  }
  const double distance = static_cast<double>(rule.fractions()[0]) - 0.25;
  return distance < 0.02 && -distance < 0.02;
}

// A third technique, 2x, that the optimum does not need.
template <class Divergence, class Real>
bool gives_up_the_third(const Divergence& divergence) {
  phimis::exact_minimiser<Divergence, phimis::fixed_table<Real, 3, 64>> rule(divergence,
                                                                             phimis::without_floors<Real, 3>());
  static_assert(std::is_trivially_copyable<decltype(rule)>::value, "a pixel's state is copied by its bytes");
  for (int j = 0; j < 64; ++j) {
    const auto o = sample_of<Real>(j % 2, (static_cast<Real>(j) + Real(0.5)) / 64);
    const Real x = std::sqrt(o.pdfs[0] / 3);
    rule.observe({o.f, {{o.pdfs[0], o.pdfs[1], 2 * x}}, o.q, o.technique});
  }
  rule.update();
  const double distance = static_cast<double>(rule.fractions()[0]) - 0.25;
  const double tolerance = std::is_same<Real, float>::value ? 1e-2 : 1e-6;
  if (distance < tolerance && -distance < tolerance && rule.fractions()[2] < 2 * static_cast<Real>(tolerance)) {
    return true;
  }
  std::printf("%s: %.9f, %.9f in place of 0.25, 0\n", __PRETTY_FUNCTION__, distance + 0.25,
              static_cast<double>(rule.fractions()[2]));
  return false;
}

template <class Real>
bool newton_steps_towards_it() {
  phimis::newton_raphson<phimis::chi_squared, Real> rule;
  static_assert(std::is_trivially_copyable<decltype(rule)>::value, "a pixel's state is copied by its bytes");
  learn(rule);
  rule.update();
  const phimis::counts<2> n = phimis::split_largest_remainder(rule.fractions(), 100);
  return n[0] + n[1] == 100 && n[0] < 40 && n[0] > 10;
}

// The linear heuristic finds the mixture of an f in the span of the pdfs from any samples.
template <phimis::negative_fractions Treatment, class Table, class Real>
bool linear_finds_it() {
  // The inverse of the largest f is subnormal: -ffast-math may take it for 0.
  for (const Real scale : {Real(1), static_cast<Real>(std::is_same<Real, float>::value ? 1e38 : 5e307)}) {
    phimis::linear_heuristic<Real, 2, Treatment, Table> rule(phimis::without_floors<Real, 2>());
    static_assert(std::is_trivially_copyable<decltype(rule)>::value, "a pixel's state is copied by its bytes");
    learn(rule, scale);
    rule.update();
    const double distance = static_cast<double>(rule.fractions()[0]) - 0.25;
    const double tolerance = std::is_same<Real, float>::value ? 1e-4 : 1e-12;
    if (!(distance < tolerance && -distance < tolerance)) return false;
  }
  return true;
}

// NaN and infinity by their bits: the compiler must not know that they are there.
template <class Real, class Bits>
Real number(Bits bits) {
  volatile Bits hidden = bits;
  const Bits copy = hidden;
  Real value;
  std::memcpy(&value, &copy, sizeof value);
  return value;
}

template <class Real>
bool counts_what_is_not_finite(Real infinity, Real nan) {
  phimis::newton_raphson<phimis::kullback_leibler, Real> rule;
  rule.observe({nan, {{1, 1}}, 1, 0});
  rule.observe({infinity, {{1, 1}}, 1, 0});
  rule.observe({1, {{nan, 1}}, 1, 0});
  rule.observe({1, {{1, infinity}}, 1, 1});
  rule.observe({1, {{1, 1}}, nan, 1});
  phimis::estimator<Real, 2> estimator;
  estimator.add(0, nan);
  estimator.add(1, infinity);
  estimator.add(1, -infinity);
  return rule.counters().nonfinite == 5 && estimator.nonfinite() == 3 && estimator.estimate() == 0;
}

// Where f = 0 < p, some reversed divergences are infinite; -ffast-math must not hide it.
template <class Divergence, class Real>
bool reports_infinity() {
  phimis::exact_minimiser<Divergence, phimis::fixed_table<Real, 2, 4>> rule;
  rule.observe({1, {{1, 2}}, 1, 0});
  rule.observe({0, {{2, 1}}, 1, 1});
  if (rule.update() == phimis::rule_status::infinite_divergence) return true;
  std::printf("%s: not reported\n", __PRETTY_FUNCTION__);
  return false;
}

template <class Real>
bool all_of(Real infinity, Real nan) {
  bool good = finds_the_optimum<phimis::kullback_leibler, Real>({});
  good = finds_the_optimum<phimis::chi_squared, Real>({}) && good;
  good = finds_the_optimum<phimis::hellinger, Real>({}) && good;
  good = finds_the_optimum<phimis::tsallis, Real>({1.5}) && good;
  good = finds_the_optimum<phimis::reversed<phimis::kullback_leibler>, Real>({}) && good;
  good = finds_the_optimum<phimis::total_variation, Real>({}) && good;
  good = finds_the_optimum<phimis::multi_sample_variance, Real>({}) && good;
  good = gives_up_the_third<phimis::kullback_leibler, Real>({}) && good;
  good = gives_up_the_third<phimis::chi_squared, Real>({}) && good;
  good = gives_up_the_third<phimis::reversed<phimis::tsallis>, Real>({{0.5}}) && good;
  good = gives_up_the_third<phimis::pearson_vajda, Real>({2}) && good;
  good = gives_up_the_third<phimis::multi_sample_variance, Real>({}) && good;
  good = newton_steps_towards_it<Real>() && good;
  good = streams_to_the_optimum<Real>() && good;
  using phimis::negative_fractions;
  good = linear_finds_it<negative_fractions::project, phimis::no_table, Real>() && good;
  good = linear_finds_it<negative_fractions::drop_most_negative, phimis::no_table, Real>() && good;
  good = linear_finds_it<negative_fractions::best_face, phimis::fixed_table<Real, 2, 32>, Real>() && good;
  good = reports_infinity<phimis::reversed<phimis::kullback_leibler>, Real>() && good;
  good = reports_infinity<phimis::reversed<phimis::chi_squared>, Real>() && good;
  good = reports_infinity<phimis::reversed<phimis::pearson_vajda>, Real>() && good;
  if (!counts_what_is_not_finite(infinity, nan)) {
    std::puts("a number that is not finite entered a sum");
    good = false;
  }
  return good;
}

}  // namespace

int main() {
  const bool single = all_of(number<float>(std::uint32_t{0x7f800000}), number<float>(std::uint32_t{0x7fc00000}));
  const bool full =
      all_of(number<double>(std::uint64_t{0x7ff0000000000000}), number<double>(std::uint64_t{0x7ff8000000000000}));
  return single && full ? 0 : 1;
}
