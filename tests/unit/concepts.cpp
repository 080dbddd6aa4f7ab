// SPDX-License-Identifier: MIT
// concepts.hpp, and the combination concept: for each concept a model, and a near miss for each clause.
#include "catch.hpp"

#include <phimis/concepts.hpp>
#include <phimis/phimis.hpp>

#include <boost/math/distributions/cauchy.hpp>

#include <random>
#include <string>

namespace {

using phimis::per_technique;

// uniform_source
struct returns_double {
  double operator()() { return 0.5; }
};
struct returns_bits {
  unsigned operator()() { return 1; }
};
struct takes_an_argument {
  double operator()(int) { return 0.5; }
};
static_assert(phimis::uniform_source<returns_double>);
static_assert(phimis::uniform_source<float (*)()>);
static_assert(!phimis::uniform_source<returns_bits>);
static_assert(!phimis::uniform_source<std::mt19937_64>, "bits are no uniform number");
static_assert(!phimis::uniform_source<takes_an_argument>);
static_assert(!phimis::uniform_source<const returns_double>, "a source changes when it is called");

// technique, invertible_technique
struct point {
  float x, y;
};
struct sound_technique {
  template <phimis::uniform_source Next>
  point sample(Next&& next) const {
    return {static_cast<float>(next()), static_cast<float>(next())};
  }
  double pdf(const point&) const { return 1; }
};
struct without_pdf {
  template <class Next>
  point sample(Next&&) const;
};
struct without_sample {
  double pdf(const point&) const;
};
struct pdf_of_another_point : without_pdf {
  double pdf(const std::string&) const;
};
struct pdf_is_no_number : without_pdf {
  point pdf(const point&) const;
};
struct sample_is_not_const {
  template <class Next>
  point sample(Next&&);
  double pdf(const point&) const;
};
struct pdf_is_not_const : without_pdf {
  double pdf(const point&);
};
static_assert(phimis::technique<sound_technique>);
static_assert(phimis::technique<phimis::gaussian> && phimis::technique<phimis::density<double (*)(double)>>);
static_assert(phimis::technique<phimis::distribution<boost::math::cauchy>>);
static_assert(!phimis::technique<without_pdf>);
static_assert(!phimis::technique<without_sample>);
static_assert(!phimis::technique<pdf_of_another_point>);
static_assert(!phimis::technique<pdf_is_no_number>);
static_assert(!phimis::technique<sample_is_not_const>);
static_assert(!phimis::technique<pdf_is_not_const>);

struct inverts : sound_technique {
  double invert(const point&) const;
};
struct inverts_to_no_number : sound_technique {
  point invert(const point&) const;
};
struct inverts_only : without_pdf {
  double invert(const point&) const;
};
static_assert(phimis::invertible_technique<inverts>);
static_assert(phimis::invertible_technique<phimis::gaussian>);
static_assert(!phimis::invertible_technique<sound_technique>);
static_assert(!phimis::invertible_technique<inverts_to_no_number>);
static_assert(!phimis::invertible_technique<inverts_only>);

// divergence
struct by_taylor {
  phimis::phi_taylor<double> taylor(double) const;
};
struct taylor_of_another_type {
  double taylor(double) const;
};
struct by_exponent {
  double exponent() const;
  double phi(double) const;
};
struct exponent_without_phi {
  double exponent() const;
};
struct phi_without_exponent {
  double phi(double) const;
};
static_assert(phimis::divergence<by_taylor> && phimis::divergence<by_exponent>);
static_assert(phimis::divergence<phimis::tsallis> && phimis::divergence<phimis::kullback_leibler>);
static_assert(phimis::divergence<phimis::total_variation> && phimis::divergence<phimis::reversed<phimis::hellinger>>);
static_assert(phimis::divergence<phimis::multi_sample_variance>);
static_assert(!phimis::phi_divergence_policy<phimis::multi_sample_variance>, "V[F] is no φ-divergence");
static_assert(!phimis::divergence<taylor_of_another_type>);
static_assert(!phimis::divergence<exponent_without_phi>);
static_assert(!phimis::divergence<phi_without_exponent>);
static_assert(!phimis::divergence<double>);
static_assert(!phimis::divergence<phimis::reversed<phimis::reversed<phimis::tsallis>>>);
static_assert(!phimis::divergence<phimis::reversed<phimis::multi_sample_variance>>);
static_assert(!phimis::divergence<phimis::reversed<int>>);

// weight_heuristic
struct sound_heuristic {
  template <class Real, int M>
  Real operator()(int, const phimis::fractions<Real, M>&, const per_technique<Real, M>&) const;
};
struct without_fractions {
  template <class Real, int M>
  Real operator()(int, const per_technique<Real, M>&) const;
};
struct weight_is_no_number {
  template <class Real, int M>
  std::string operator()(int, const phimis::fractions<Real, M>&, const per_technique<Real, M>&) const;
};
struct weight_is_not_const {
  template <class Real, int M>
  Real operator()(int, const phimis::fractions<Real, M>&, const per_technique<Real, M>&);
};
static_assert(phimis::weight_heuristic<sound_heuristic>);
static_assert(phimis::weight_heuristic<phimis::balance> && phimis::weight_heuristic<phimis::power>);
static_assert(phimis::weight_heuristic<phimis::cutoff> && phimis::weight_heuristic<phimis::maximum>);
static_assert(!phimis::weight_heuristic<without_fractions>);
static_assert(!phimis::weight_heuristic<weight_is_no_number>);
static_assert(!phimis::weight_heuristic<weight_is_not_const>);

// rule
struct sound_rule {
  using real = double;
  static constexpr int techniques = 2;
  void observe(const phimis::observation<double, 2>&);
  phimis::rule_status update();
  phimis::fractions<double, 2> fractions() const;
  phimis::rule_status status() const;
  void merge(const sound_rule&);
};
struct without_observe : sound_rule {
  void observe() = delete;
  void merge(const without_observe&);
};
struct without_update : sound_rule {
  void update(int);
  void merge(const without_update&);
};
struct update_without_status : sound_rule {
  void update();
  void merge(const update_without_status&);
};
struct fractions_of_three : sound_rule {
  phimis::fractions<double, 3> fractions() const;
  void merge(const fractions_of_three&);
};
struct fractions_are_not_const : sound_rule {
  phimis::fractions<double, 2> fractions();
  void merge(const fractions_are_not_const&);
};
struct without_status : sound_rule {
  void status(int) const;
  void merge(const without_status&);
};
struct without_merge : sound_rule {
  void merge() = delete;
};
struct without_count {
  using real = double;
  void observe(const phimis::observation<double, 2>&);
  phimis::rule_status update();
  phimis::fractions<double, 2> fractions() const;
  phimis::rule_status status() const;
  void merge(const without_count&);
};
static_assert(phimis::rule<sound_rule>);
static_assert(phimis::rule<phimis::fixed_fractions<float, 7>>);
static_assert(phimis::rule<phimis::newton_raphson<phimis::tsallis, float>>);
static_assert(phimis::rule<phimis::exact_minimiser<phimis::total_variation, phimis::table<double, 2>>>);
static_assert(phimis::rule<phimis::exact_minimiser<phimis::multi_sample_variance, phimis::fixed_table<float, 2, 9>>>);
static_assert(!phimis::rule<without_observe>);
static_assert(!phimis::rule<without_update>);
static_assert(!phimis::rule<update_without_status>);
static_assert(!phimis::rule<fractions_of_three>);
static_assert(!phimis::rule<fractions_are_not_const>);
static_assert(!phimis::rule<without_status>);
static_assert(!phimis::rule<without_merge>);
static_assert(!phimis::rule<without_count>);

// combination
struct sound_combination {
  void operator()(std::span<const phimis::iteration_summary>, std::span<double>) const;
};
struct without_weights {
  void operator()(std::span<const phimis::iteration_summary>) const;
};
struct combination_is_not_const {
  void operator()(std::span<const phimis::iteration_summary>, std::span<double>);
};
static_assert(phimis::combination<sound_combination>);
static_assert(phimis::combination<phimis::by_count> && phimis::combination<phimis::square_root>);
static_assert(phimis::combination<phimis::fixed_weights> && phimis::combination<phimis::inverse_variance>);
static_assert(!phimis::combination<phimis::pooled>, "it needs the samples, not the iterations");
static_assert(!phimis::combination<without_weights>);
static_assert(!phimis::combination<combination_is_not_const>);

}  // namespace

TEST_CASE("Concepts take their models and refuse near misses") {
  SUCCEED("at compile time, above");
  CHECK(sound_technique{}.pdf(sound_technique{}.sample(returns_double{})) == 1);
}

TEST_CASE("A technique set samples the technique it is asked for and has all pdfs in order") {
  const phimis::technique_set set(phimis::gaussian(0, 1, {0, 1}), phimis::gaussian(5, 1, {5, 6}),
                                  phimis::density([](double) { return 1.0; }, phimis::interval(8, 10)));
  static_assert(set.techniques == 3);
  returns_double next;
  CHECK((set.sample(0, next) > 0 && set.sample(0, next) < 1));
  CHECK((set.sample(1, next) > 5 && set.sample(1, next) < 6));
  CHECK(set.sample(2, next) == Approx(9));
  const auto pdfs = set.pdfs(9.5);
  CHECK(pdfs[0] == 0);
  CHECK(pdfs[1] == 0);
  CHECK(pdfs[2] == Approx(0.5));
  CHECK(set.pdfs(5.5)[1] == phimis::gaussian(5, 1, {5, 6}).pdf(5.5));
}

TEST_CASE("A technique set takes points of any type") {
  const phimis::technique_set set(sound_technique{}, sound_technique{});
  returns_double next;
  const point x = set.sample(1, next);
  CHECK(x.y == 0.5f);
  CHECK(set.pdfs(x)[1] == 1);
}

TEMPLATE_TEST_CASE("A growing table is a fixed table with room for all", "", float, double) {
  phimis::table<TestType, 2> growing;
  phimis::fixed_table<TestType, 2, 300> fixed;
  CHECK(growing.size() == 0);
  CHECK(growing.view().n == 0);
  for (int j = 0; j < 300; ++j) {
    const TestType x = static_cast<TestType>(j);
    const phimis::row<TestType, 2> row{x, 2 * x, {3 * x, 4 * x}};
    REQUIRE(growing.push(row));
    REQUIRE(fixed.push(row));
  }
  CHECK(growing.push({1, 1, {1, 1}}));
  CHECK_FALSE(fixed.push({1, 1, {1, 1}}));
  REQUIRE(growing.size() == 301);
  const auto a = growing.view();
  const auto b = fixed.view();
  REQUIRE(a.n == 301);
  REQUIRE(b.n == 300);
  for (std::ptrdiff_t j = 0; j < 300; ++j) {
    REQUIRE(a.u[j] == b.u[j]);
    REQUIRE(a.w[j] == b.w[j]);
    for (int k = 0; k < 2; ++k) REQUIRE(a.y[k][j] == b.y[k][j]);
    REQUIRE(growing[j].u == fixed[j].u);
    REQUIRE(growing[j].w == fixed[j].w);
    for (int k = 0; k < 2; ++k) REQUIRE(growing[j].y[k] == fixed[j].y[k]);
  }
}
