// SPDX-License-Identifier: MIT
// Pdfs that are hard: nearly the same, heavy-tailed, hardly overlapping, delta-like, defective, over sixty decades.
#include "any_rule.hpp"
#include "cases.hpp"
#include "catch.hpp"
#include "divergences.hpp"

#include <phimis/estimator/batch.hpp>
#include <phimis/integrate.hpp>
#include <phimis/technique/gaussian.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace {

using namespace hard;
using phimis::control_variate;
using phimis::rule_status;

/// p = 1 + slope (x − ½) on [0, 1].
struct tilted {
  double slope;
  double pdf(double x) const { return x < 0 || x > 1 ? 0 : 1 + slope * (x - 0.5); }
  template <class Next>
  double sample(Next&& next) const {
    return next();  // quadrature never samples
  }
};

/// γ of s ∝ t^γ as t → 0: β of a power, 1 − k of a reversed Pearson–Vajda divergence, which `exponent` leaves out; 0 where s(0)
/// is finite or s grows like log t.
double growth_at_zero(const any_divergence& divergence) {
  double growth = 0;
  for_each_divergence([&](const char* name, const auto& of) {
    if (divergence.name != name || !divergence.infinite_at_zero) return;
    const auto size = [&](long double t) { return std::fabs(true_score_at(of, t).value); };
    // Of log t what is left is log(230/253)/log(1e10) = −.004.
    growth = static_cast<double>(std::log(size(1e-100L) / size(1e-110L)) / std::log(1e10L));
  });
  return growth;
}

/// How near to the oracle fractions may be expected that were learnt on another quadrature of the same integrals.
///
/// Both resolve smooth integrands to rounding, which is ε of G_k: α is as far off as that over the slope of ζ, some hundred ε;
/// where φ is flat, √ε. Where s has a jump or a kink it lies within a panel, of which there are 20 between two edges: a node
/// is worth 1/400 of the integral.
template <class Real>
double tolerance(const any_divergence& divergence) {
  if (divergence.steps) return 1e-2;
  if (!divergence.power && !divergence.variance) return 1e-3;
  return is_float<Real> ? 1e-4 : 1e-9;
}

/// The exact rules on quadrature observations against the oracle, from several starts; not by divergences whose score grows like
/// t^least_growth or faster at t = 0.
template <class Real, class Integrand, class Techniques>
void check_oracle(const Integrand& f, const Techniques& techniques, const std::vector<double>& edges,
                  control_variate variate = control_variate::on,
                  phimis::analysis::normalisation promise = phimis::analysis::normalisation::required,
                  double least_growth = -1e300) {
  const std::vector<double> inner(edges.begin() + 1, edges.end() - 1);
  const phimis::analysis::problem on(f, techniques, phimis::interval(edges.front(), edges.back()), inner, promise);
  const auto all = quadrature<Real>(f, techniques, edges);
  const auto rules = exact_rules<Real, 2>({}, variate);
  for (std::size_t i = 0; i < rules.size(); ++i) {
    const any_divergence& divergence = *rules[i].divergence();
    if (growth_at_zero(divergence) <= least_growth + 1e-2) continue;
    auto wanted = divergence.optimum(on, phimis::without_floors<double, 2>());
    for (const double first : {0.0, 0.5, 1.0}) {
      const auto options = starting_at<Real, 2>({{static_cast<Real>(first), static_cast<Real>(1 - first)}});
      if (divergence.variance) wanted = divergence.optimum(on, starting_at<double, 2>({{first, 1 - first}}));
      auto rule = exact_rules<Real, 2>(options, variate)[i];
      const auto status = teach(rule, all);
      CAPTURE(rule.name(), first, wanted.alpha[0], rule.fractions()[0]);
      CHECK(status == (divergence.variance ? rule_status::local : rule_status::updated));
      // An oracle that does not know must not excuse everything.
      CHECK(wanted.error <= tolerance<Real>(divergence));
      CHECK(apart(rule.fractions(), wanted.alpha) <= tolerance<Real>(divergence) + wanted.error);
    }
  }
}

}  // namespace

TEMPLATE_TEST_CASE(
    "Pdfs that are hardly apart have the better one found by every divergence, in the last digits at least not the worse",
    "", float, double) {
  // f/p_2 and p_1/p_2 rise: technique 1 alone is best, by a difference of G of .1 δ of chi squared, .01 δ where s itself is
  // nearly flat; the slope of V[F] is −∫f²(p_1 − p_2) = −½δ.
  using Real = TestType;
  const auto f = [](double x) { return 1 + x; };
  // 1e-12 apart is the same in float, and in double no more than the rounding of G where s is nearly flat.
  for (const double delta : {is_float<Real> ? 1e-2 : 1e-6, 1e-12}) {
    const phimis::technique_set pair(tilted{delta}, tilted{-delta});
    const auto options = starting_at<Real, 2>({{Real(0.4), Real(0.6)}});
    for (auto& rule : exact_rules<Real, 2>(options, control_variate::off)) {
      const auto status = teach(rule, quadrature<Real>(f, pair, {0, 1}, 3));
      CAPTURE(rule.name(), delta, rule.fractions()[0]);
      CHECK(status == (rule.divergence()->variance ? rule_status::local : rule_status::updated));
      const bool left = same(rule.fractions(), options.start);
      if (delta > 1e-9) {
        CHECK(rule.fractions()[0] == 1);
      } else if (is_float<Real>) {
        CHECK(left);
      } else {
        CHECK((left || rule.fractions()[0] == 1));
      }
    }
  }
}

TEMPLATE_TEST_CASE(
    "Pdfs that are the same up to rounding leave the fractions or take a vertex, never leave the simplex", "", float,
    double) {
  const auto f = [](double x) { return 1 + x; };
  for (const double delta : {1e-6, 1e-12, 1e-15, 0.0}) {
    const phimis::technique_set three(tilted{delta}, tilted{-delta}, tilted{0.5});
    for (auto& rule : every_rule<TestType, 3>()) {
      CAPTURE(delta);
      teach(rule, drawn<TestType>(f, three, 60), 3);  // which checks
    }
  }
}

TEMPLATE_TEST_CASE("Pdfs that are identical leave fractions where they are", "", float, double) {
  const auto f = [](double x) { return 1 + x * x; };
  const phimis::technique_set pair(power_of{1}, power_of{1});
  const auto options = starting_at<TestType, 2>({{TestType(0.25), TestType(0.75)}});
  for (const auto variate : {control_variate::on, control_variate::off}) {
    for (auto& rule : every_rule<TestType, 2>(options, variate)) {
      teach(rule, drawn<TestType>(f, pair, 60), 3);
      if (rule.how() != way::at_once) continue;
      CAPTURE(rule.name(), static_cast<int>(variate));
      CHECK(same(rule.fractions(), options.start));
    }
  }
}

TEMPLATE_TEST_CASE("Of two identical pdfs and another, the two share what one would have", "", float, double) {
  const auto f = [](double x) { return 0.4 + x * x; };
  const phimis::technique_set pair(power_of{1}, power_of{0});
  const phimis::technique_set three(power_of{1}, power_of{1}, power_of{0});
  auto of_pair = exact_rules<TestType, 2>(phimis::without_floors<TestType, 2>());
  auto of_three = exact_rules<TestType, 3>(phimis::without_floors<TestType, 3>());
  for (std::size_t i = 0; i < of_pair.size(); ++i) {
    teach(of_pair[i], quadrature<TestType>(f, pair, {0, 1}, 3));
    teach(of_three[i], quadrature<TestType>(f, three, {0, 1}, 3));
    CAPTURE(of_pair[i].name(), of_pair[i].fractions()[1], of_three[i].fractions()[2]);
    // A step lies between nodes, of which the largest has .0255, .153 of a panel's half, times p <= 2. The kink of three
    // techniques is rounded off within `width`. Else ζ is known to some ten ε of λ, each solution's, and its slope is
    // β ∫(2x − 1)²/(x + ½) dx ≈ .4 β of it, β >= .1.
    const bool kink = of_pair[i].name().find("Vajda 1.5") != std::string::npos;
    const double width = is_float<TestType> ? 1e-4 : 1e-6;
    const double digits = 1000.0 * std::numeric_limits<TestType>::epsilon();
    const double allowed = of_pair[i].divergence()->steps ? 0.05 : kink ? width : digits;
    CHECK(std::fabs(static_cast<double>(of_pair[i].fractions()[1] - of_three[i].fractions()[2])) <= allowed);
  }
}

TEMPLATE_TEST_CASE("A technique whose variance is infinite gets the fractions of the oracle, from that end too", "",
                   float, double) {
  // x = u⁴ turns 1/(2√x) under p_1 = 1 and x^{−3/4}/4 into 2u under 4u³ and 1: ∫f²/p_1 diverges like log, with 6u⁵ like u^{−2}.
  // ∫p_2²/f diverges, too: the reversed divergences that have it are infinite wherever α_2 > 0.
  const auto f = [](double u) { return 2 * u; };
  for (const int n : {3, 5}) {
    check_oracle<TestType>(f, phimis::technique_set(power_of{n}, power_of{0}), {0, 1e-9, 1e-7, 1e-5, 1e-3, 0.1, 1},
                           control_variate::on, phimis::analysis::normalisation::required, -1);
  }
}

TEST_CASE("An estimate is honest where one technique has an infinite variance") {
  // Floors keep p(α) >= .01: f/p <= 200. |z| < 5 by the standard error of 2000 samples.
  const phimis::technique_set pair(power_of{5}, power_of{0});
  const auto f = [](double u) { return 2 * u; };
  for (const auto& rule : every_rule<double, 2>()) {
    const auto run =
        phimis::integrate(f, pair, {.budget = 2000, .iterations = 4, .growth = 4}, rule, phimis::square_root{});
    CAPTURE(rule.name(), run.estimate, run.standard_error);
    CHECK(phimis::is_finite(run.standard_error));
    CHECK(std::fabs(run.estimate - 1) <= 5 * run.standard_error);
  }
}

TEMPLATE_TEST_CASE("Supports that overlap in 1e-4 of the domain, or not at all, have the fractions of the oracle", "",
                   float, double) {
  const auto f = [](double x) { return x < 0.5 ? 1 + x : 3 * x * x; };
  for (const double overlap : {0.0, 1e-4}) {
    const double first = 0.5 + overlap / 2;
    const double second = 0.5 - overlap / 2;
    const phimis::technique_set pair(uniform_on{0, first}, uniform_on{second, 1});
    std::vector<double> edges{0, 0.5, 1};
    if (overlap > 0) edges = {0, second, 0.5, first, 1};
    check_oracle<TestType>(f, pair, edges);
  }
}

TEST_CASE("Of disjoint supports powers have fractions by formula") {
  // G_k = α_k^{−β} E_k[(f/p_k)^β] is the same for both.
  const auto f = [](double x) { return x < 0.5 ? 1 + x : 3 * x * x; };
  const phimis::technique_set pair(uniform_on{0, 0.5}, uniform_on{0.5, 1});
  const auto moment = [](double beta, int k) {  // ∫ (f/2)^β 2 dx over half k
    double sum = 0;
    for (int j = 0; j < 20000; ++j) {
      const double x = (j + 0.5) / 40000 + 0.5 * k;
      sum += std::pow((k == 0 ? 1 + x : 3 * x * x) / 2, beta) / 20000;
    }
    return sum;
  };
  for (auto& rule : exact_rules<double, 2>(phimis::without_floors<double, 2>())) {
    if (!rule.divergence()->power || rule.divergence()->exponent == 0) continue;
    teach(rule, quadrature(f, pair, {0, 0.5, 1}));
    const double beta = rule.divergence()->exponent;
    CAPTURE(rule.name(), beta);
    const double ratio = std::pow(moment(beta, 0) / moment(beta, 1), 1 / beta);
    // The midpoint rule is off by 1/(24 · 20000²) of second derivatives of up to 100.
    CHECK(rule.fractions()[0] / rule.fractions()[1] == Approx(ratio).epsilon(1e-7));
  }
}

TEMPLATE_TEST_CASE("Pdfs from 1e-30 to 1e+30 have a mixture of zero variance found by every divergence", "", float,
                   double) {
  // Three parts of the space, of measure 1e-30, 1 and 1e+30; technique k reaches part k, and the last two the first as well.
  const phimis::fractions<double, 3> wanted{{0.25, 0.25, 0.5}};
  const double pdfs[4][3] = {{1e30, 1, 1e-30}, {0, 1, 0}, {0, 0, 1e-30}, {0, 0, 1e-30}};
  observations<TestType, 3> all;
  for (int j = 0; j < 96; ++j) {
    phimis::observation<TestType, 3> o{0, {}, 0, std::min(j % 4, 2)};
    double f = 0;
    for (int k = 0; k < 3; ++k) {
      o.pdfs[k] = static_cast<TestType>(pdfs[j % 4][k]);
      f += wanted[k] * pdfs[j % 4][k];
    }
    o.f = static_cast<TestType>(f);
    o.q = o.f;
    all.push_back(o);
  }
  // One rounding of f and of p each, so t = 1 to 2ε; its share over that of the smallest fraction; √ε where φ is flat.
  const double epsilon = std::numeric_limits<TestType>::epsilon();
  for (auto& rule : exact_rules<TestType, 3>(phimis::without_floors<TestType, 3>())) {
    if (rule.divergence()->variance) continue;  // 0 at any fractions: each part has its technique
    teach(rule, all);
    CAPTURE(rule.name(), rule.fractions()[0], rule.fractions()[1], rule.fractions()[2]);
    const bool flat = rule.name().find("Vajda 3") != std::string::npos;
    CHECK(apart(rule.fractions(), wanted) <= 30 * std::max(flat ? std::sqrt(epsilon) : 4 * epsilon, 1e-7));
  }
}

TEMPLATE_TEST_CASE("A delta-like pdf beside a uniform one is weighed right by every divergence", "", float, double) {
  const phimis::gaussian narrow(0.5, 1e-8, phimis::interval(0, 1));
  const phimis::technique_set pair(narrow, uniform_on{0, 1});
  const double epsilon = std::numeric_limits<TestType>::epsilon();
  for (const double share : {0.0, 0.5, 1.0}) {
    const auto f = [&](double x) { return share * narrow.pdf(x) + (1 - share) * uniform_on{0, 1}.pdf(x); };
    for (auto& rule : exact_rules<TestType, 2>(phimis::without_floors<TestType, 2>())) {
      if (rule.infinite_at_zero() && share == 1) continue;  // f is 0 where the uniform pdf is not
      if (rule.divergence()->variance) continue;            // 0 at any fractions: each part has its technique
      teach(rule, drawn<TestType>(f, pair, 200));
      CAPTURE(rule.name(), share, rule.fractions()[0]);
      // t = 1 up to 2 ε; s and its sum up to ε each, which is t up to 10 ε where s = t^.1, up to √ε where φ is flat.
      const bool flat = rule.name().find("Vajda 3") != std::string::npos;
      CHECK(apart(rule.fractions(), phimis::fractions<double, 2>{{share, 1 - share}}) <=
            (flat ? std::sqrt(epsilon) : 30 * epsilon));
    }
  }
}

TEST_CASE("The integral of a delta on a plane is exact once the mixture is learnt") {
  const phimis::gaussian narrow(0.5, 1e-8, phimis::interval(0, 1));
  const phimis::technique_set pair(narrow, uniform_on{0, 1});
  const auto f = [&](double x) { return 0.25 * narrow.pdf(x) + 0.75 * uniform_on{0, 1}.pdf(x); };
  const auto run = phimis::integrate(f, pair, {.budget = 400, .iterations = 4, .growth = 1},
                                     phimis::exact_rule(phimis::chi_squared{}), phimis::square_root{});
  for (const auto& line : run.trace) {
    if (line.index > 0) CHECK(line.estimate == Approx(1).epsilon(1e-12));
  }
}

TEMPLATE_TEST_CASE("A defective pdf has the fractions of the oracle under every divergence, lost samples or not", "",
                   float, double) {
  struct half {  // of which the upper half is lost
    double pdf(double x) const { return x < 0.5 ? power_of{0}.pdf(x) : 0; }
    double sample(double (*next)()) const { return next(); }
  };
  const phimis::technique_set lossy(half{}, power_of{1});
  const auto f = [](double x) { return 1 + x * x; };
  check_oracle<TestType>(f, lossy, {0, 0.5, 1}, control_variate::off, phimis::analysis::normalisation::defective);
  // As many samples again, all lost: sums are the same to the last bit, for n and 1/q are twice what they were.
  auto all = quadrature<TestType>(f, lossy, {0, 0.5, 1});
  auto with_lost = all;
  for (auto& o : with_lost) o.q /= 2;
  with_lost.resize(2 * all.size(), {0, {{0, 0}}, 0, 0});
  auto without = exact_rules<TestType, 2>(phimis::without_floors<TestType, 2>(), control_variate::off);
  auto with = without;
  for (std::size_t i = 0; i < with.size(); ++i) {
    CAPTURE(with[i].name());
    teach(without[i], all);
    const auto status = teach(with[i], with_lost);
    if (with[i].infinite_at_zero()) {
      CHECK(status == rule_status::infinite_divergence);
    } else {
      CHECK(same(with[i].fractions(), without[i].fractions()));
    }
  }
}
