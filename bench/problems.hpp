// SPDX-License-Identifier: MIT
#ifndef PHIMIS_BENCH_PROBLEMS_HPP
#define PHIMIS_BENCH_PROBLEMS_HPP

#include "any_technique.hpp"

#include <papers/hidden_lobe.hpp>
#include <papers/linear_problems.hpp>

#include <phimis/analysis/optimum.hpp>
#include <phimis/solver/minimise.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

/// The problems on which estimates are compared: those of the papers, one in two dimensions, one in five, and one that
/// is made to ruin control variates.
namespace bench {

/// An integrand and techniques, with what is known of them exactly.
template <int M>
struct problem {
  const char* name;
  int dimensions;
  double (*f)(const point&);
  any_techniques<M> techniques;
  point lower, upper;  ///< a box that holds f, for methods that need one
  double mean;
  std::function<double(const phimis::fractions<double, M>&)> variance;  ///< V[F]
  phimis::fractions<double, M> best;                                    ///< the least V[F]
  double least;                                                         ///< V[F] there; 0 where it vanishes
};

/// A density with a known antiderivative, sampled by Newton's method on it between brackets.
struct primitive_density {
  double (*h)(double);
  double (*antiderivative)(double);
  phimis::interval domain;

  double total() const { return antiderivative(domain.upper()) - antiderivative(domain.lower()); }
  double pdf(double x) const { return domain.contains(x) ? h(x) / total_ : 0; }
  template <class Next>
  double sample(Next&& next) const {
    double low = domain.lower();
    double high = domain.upper();
    const double u = next();
    const double target = antiderivative(low) + u * total_;
    double x = low + u * (high - low);
    for (int i = 0; i < 100; ++i) {
      const double excess = antiderivative(x) - target;
      const double step = excess / h(x);
      if (std::fabs(step) < 1e-14 * domain.upper()) break;
      (excess > 0 ? high : low) = x;
      x -= step;
      if (!(x > low && x < high)) x = low + (high - low) / 2;
    }
    return x;
  }
  double total_ = total();
};

/// An isotropic normal density in D dimensions.
template <int D>
struct isotropic_normal {
  point centre;
  double sigma;

  double pdf(const point& x) const {
    double square = 0;
    for (std::size_t i = 0; i < D; ++i) square += (x[i] - centre[i]) * (x[i] - centre[i]);
    return at_distance(std::sqrt(square));
  }
  double at_distance(double r) const {
    return std::exp(-r * r / (2 * sigma * sigma)) / std::pow(std::sqrt(2 * std::numbers::pi) * sigma, D);
  }
  template <class Next>
  point sample(Next&& next) const {
    point x{};
    for (std::size_t i = 0; i < D; i += 2) {
      const double r = sigma * std::sqrt(-2 * std::log1p(-next()));
      const double angle = 2 * std::numbers::pi * next();
      x[i] = centre[i] + r * std::cos(angle);
      if (i + 1 < D) x[i + 1] = centre[i + 1] + r * std::sin(angle);
    }
    return x;
  }
};

namespace detail {

/// A variance that is nothing but rounding is none.
inline double or_zero(double variance, double mean) { return variance > 1e-24 * mean * mean ? variance : 0; }

/// What analysis knows of a problem on an interval, put into one.
template <int M>
problem<M> with_exact(problem<M> made, const phimis::analysis::problem<M>& exact) {
  using namespace phimis::analysis;
  const auto shared = std::make_shared<const phimis::analysis::problem<M>>(exact);
  made.mean = exact.mean().value;
  made.best = optimum(phimis::multi_sample_variance{}, exact).alpha;
  made.variance = [shared, mean = made.mean](const phimis::fractions<double, M>& alpha) {
    return or_zero(variance(*shared, alpha).multi_sample.value, mean);
  };
  made.least = made.variance(made.best);
  return made;
}

/// One of a paper, with techniques of its own or others of the same densities that are faster to sample.
template <class Paper, int M>
problem<M> of_paper(const any_techniques<M>& techniques) {
  const phimis::interval domain = Paper::domain();
  problem<M> made{Paper::name,
                  1,
                  [](const point& x) { return Paper::f(x[0]); },
                  techniques,
                  {domain.lower()},
                  {domain.upper()},
                  0,
                  {},
                  {},
                  0};
  return with_exact<M>(made, {Paper::f, Paper::techniques(), domain});
}
template <class Paper, class... Techniques>
auto of_paper_with(Techniques... each) {
  return of_paper<Paper, static_cast<int>(sizeof...(Techniques))>(
      any_techniques<static_cast<int>(sizeof...(Techniques))>(any_technique(each)...));
}

/// The techniques of the variance paper.
template <class Paper>
problem<3> of_variance_paper() {
  static constexpr double pi = std::numbers::pi;
  const phimis::interval domain = Paper::domain();
  return of_paper_with<Paper>(
      primitive_density{Paper::linear, [](double x) { return x * x / 2; }, domain},
      primitive_density{Paper::quadratic, [](double x) { return x * x * (x / 3 - 1 / (2 * pi)); }, domain},
      primitive_density{Paper::sine, [](double x) { return -std::cos(x); }, domain});
}

}  // namespace detail

inline problem<2> tsallis_1() {
  const phimis::interval domain = papers::tsallis_1::domain();
  return detail::of_paper_with<papers::tsallis_1>(phimis::gaussian(2, 1, domain), phimis::gaussian(8, 2, domain));
}
inline problem<2> tsallis_2() {
  const phimis::interval domain = papers::tsallis_2::domain();
  return detail::of_paper_with<papers::tsallis_2>(phimis::gaussian(-1.5, 1, domain),
                                                  phimis::gaussian(1.5, 0.75, domain));
}
inline problem<2> tsallis_3() {
  const phimis::interval domain = papers::tsallis_3::domain();
  return detail::of_paper_with<papers::tsallis_3>(
      primitive_density{[](double x) { return 2 - x; }, [](double x) { return x * (2 - x / 2); }, domain},
      primitive_density{[](double x) { return std::sin(x) * std::sin(x); },
                        [](double x) { return x / 2 - std::sin(2 * x) / 4; }, domain});
}
inline problem<3> linear_4() {
  const phimis::interval domain = papers::linear_4::domain();
  return detail::of_paper_with<papers::linear_4>(
      phimis::gaussian(-1.5, 1, domain), phimis::gaussian(1.5, 0.75, domain), phimis::gaussian(-0.5, 1, domain));
}
inline problem<4> linear_5() {
  const phimis::interval domain = papers::linear_5::domain();
  return detail::of_paper_with<papers::linear_5>(phimis::gaussian(-1.5, 1, domain),
                                                 phimis::gaussian(1.5, 0.75, domain),
                                                 phimis::gaussian(-0.5, 1, domain), phimis::gaussian(0.5, 1, domain));
}
inline problem<3> variance_1() { return detail::of_variance_paper<papers::variance_1>(); }
/// Example 6 of the linear heuristic's paper, too.
inline problem<3> variance_2() { return detail::of_variance_paper<papers::variance_2>(); }
inline problem<3> variance_3() { return detail::of_variance_paper<papers::variance_3>(); }
inline problem<3> variance_4() { return detail::of_variance_paper<papers::variance_4>(); }

/// Three normal bumps, rippled, by four normal densities of other centres and widths.
///
/// The whole plane: sums over a square grid, which converge exponentially for what decays like this. With half the
/// spacing the mean, the fractions and V[F] are the same within 1e-10.
struct plane {
  static double f(const point& x) {
    const double bumps = 2 * isotropic_normal<2>{{-1.4, 0.1}, 0.6}.pdf(x) +
                         isotropic_normal<2>{{1.5, 0.5}, 0.9}.pdf(x) +
                         0.5 * isotropic_normal<2>{{0, 1.5}, 0.8}.pdf(x);
    return bumps * (1 + 0.5 * std::sin(2 * x[0] + x[1]));
  }
  static std::array<isotropic_normal<2>, 4> densities() {
    return {{{{-1.5, 0}, 0.7}, {{1.5, 0.5}, 1}, {{0, -1.5}, 0.8}, {{0, 0}, 2}}};
  }

  static problem<4> exact(double spacing = 0.2) {
    const auto each = densities();
    const auto steps = static_cast<int>(std::lround(9 / spacing));
    const Eigen::Index side = 2 * steps + 1;
    const Eigen::Index n = side * side;
    const auto f_at = std::make_shared<Eigen::VectorXd>(n);
    const auto pdfs = std::make_shared<Eigen::MatrixXd>(n, 4);
    const double weight = spacing * spacing;
    for (Eigen::Index j = 0; j < n; ++j) {
      const point x{spacing * static_cast<double>(j / side - steps), spacing * static_cast<double>(j % side - steps)};
      (*f_at)[j] = f(x);
      for (std::size_t k = 0; k < 4; ++k) (*pdfs)(j, static_cast<Eigen::Index>(k)) = each[k].pdf(x);
    }
    problem<4> made{"2-D",
                    2,
                    f,
                    any_techniques<4>(any_technique(each[0]), any_technique(each[1]), any_technique(each[2]),
                                      any_technique(each[3])),
                    {-9, -9},
                    {9, 9},
                    weight * f_at->sum(),
                    {},
                    {},
                    0};
    made.variance = [=](const phimis::fractions<double, 4>& alpha) {
      const Eigen::Map<const Eigen::Vector4d> a(alpha.value);
      const Eigen::VectorXd mixture = *pdfs * a;
      const Eigen::VectorXd ratio = f_at->cwiseQuotient(mixture);
      const Eigen::Vector4d means = weight * (pdfs->transpose() * ratio);
      return weight * ratio.dot(*f_at) - a.dot(means.cwiseProduct(means));
    };
    // A node is an observation with density 1/(n · weight).
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(n, 1 / (weight * static_cast<double>(n)));
    const auto found =
        phimis::minimise(phimis::multi_sample_variance{}, *f_at, *pdfs, q, {.variate = phimis::control_variate::off});
    for (int k = 0; k < 4; ++k) made.best[k] = found.fractions[k];
    made.least = made.variance(made.best);
    return made;
  }
};

/// Two concentric normal densities, rippled in the distance r from their centre, by three of other widths.
///
/// All is a function of r: an integral in five dimensions is one over r with the area 8π²/3 r⁴ of a sphere, which analysis does.
struct ball {
  static double at_distance(double r) {
    return (isotropic_normal<5>{{}, 0.5}.at_distance(r) + 2 * isotropic_normal<5>{{}, 1.2}.at_distance(r)) *
           (1 + 0.5 * std::sin(3 * r));
  }
  static double f(const point& x) {
    double square = 0;
    for (const double c : x) square += c * c;
    return at_distance(std::sqrt(square));
  }

  static double area(double r) { return 8 * std::numbers::pi * std::numbers::pi / 3 * r * r * r * r; }
  /// The density of r.
  struct radial {
    double sigma;
    double pdf(double r) const { return area(r) * isotropic_normal<5>{{}, sigma}.at_distance(r); }
    template <class Next>
    double sample(Next&&) const {
      return 0;  // analysis takes no samples
    }
  };

  static problem<3> exact() {
    constexpr double narrow = 0.6;
    constexpr double middle = 1;
    constexpr double wide = 1.6;
    problem<3> made{"5-D",
                    5,
                    f,
                    any_techniques<3>(any_technique(isotropic_normal<5>{{}, narrow}),
                                      any_technique(isotropic_normal<5>{{}, middle}),
                                      any_technique(isotropic_normal<5>{{}, wide})),
                    {-8, -8, -8, -8, -8},
                    {8, 8, 8, 8, 8},
                    0,
                    {},
                    {},
                    0};
    return detail::with_exact<3>(
        made, {[](double r) { return area(r) * at_distance(r); },
               phimis::technique_set(radial{narrow}, radial{middle}, radial{wide}), phimis::interval(0, 16)});
  }
};

inline problem<2> hidden_lobe() {
  using papers::hidden_lobe;
  const any_techniques<2> techniques(any_technique(hidden_lobe::uniform{}), any_technique(hidden_lobe::lobed{}));
  return detail::with_exact<2>({hidden_lobe::name,
                                1,
                                [](const point& x) { return hidden_lobe::f(x[0]); },
                                techniques,
                                {0},
                                {1},
                                0,
                                {},
                                {},
                                0},
                               hidden_lobe::exact());
}

inline problem<4> two_dimensions() { return plane::exact(); }
inline problem<3> five_dimensions() { return ball::exact(); }

/// Calls receive(problem) with each.
template <class Receiver>
void for_each_problem(const Receiver& receive) {
  receive(tsallis_1());
  receive(tsallis_2());
  receive(tsallis_3());
  receive(linear_4());
  receive(linear_5());
  receive(variance_1());
  receive(variance_2());
  receive(variance_3());
  receive(variance_4());
  receive(two_dimensions());
  receive(five_dimensions());
  receive(hidden_lobe());
}

}  // namespace bench

#endif  // PHIMIS_BENCH_PROBLEMS_HPP
