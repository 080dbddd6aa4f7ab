// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_PROPERTY_RAPIDCHECK_GENERATORS_HPP
#define PHIMIS_TESTS_PROPERTY_RAPIDCHECK_GENERATORS_HPP

#include <phimis/core/fractions.hpp>
#include <phimis/core/observation.hpp>
#include <phimis/core/rule.hpp>

#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <ostream>
#include <vector>

// Numbers, options and observations for rapidcheck, which makes them smaller where a property fails.

namespace phimis {

template <class Value, int M>
std::ostream& operator<<(std::ostream& out, const per_technique<Value, M>& values) {
  for (const Value value : values) out << value << ' ';
  return out;
}

template <class Real, int M>
std::ostream& operator<<(std::ostream& out, const observation<Real, M>& sample) {
  return out << "f " << sample.f << ", pdfs " << sample.pdfs << ", q " << sample.q << ", technique "
             << sample.technique;
}

template <class Real, int M>
std::ostream& operator<<(std::ostream& out, const rule_options<Real, M>& options) {
  return out << "start " << options.start << ", floors " << options.floors << ", prior " << options.prior << ", costs "
             << options.costs << ", frozen " << options.frozen;
}

}  // namespace phimis

namespace generators {

/// Plain numbers, powers of two over many decades, and what is special.
template <class Real>
rc::Gen<Real> numbers() {
  using limits = std::numeric_limits<Real>;
  const auto plain = rc::gen::map(rc::gen::inRange(-192, 193), [](int i) { return static_cast<Real>(i) / 64; });
  const auto powers = rc::gen::map(rc::gen::inRange(-100, 101), [](int i) { return std::ldexp(Real(1), i); });
  return rc::gen::weightedOneOf<Real>(
      {{12, plain},
       {3, powers},
       {1, rc::gen::element(limits::infinity(), -limits::infinity(), limits::quiet_NaN(), limits::max(),
                            limits::lowest(), limits::min(), limits::denorm_min(), Real(0), -Real(0))}});
}

/// Finite and not negative.
template <class Real>
rc::Gen<Real> densities() {
  return rc::gen::map(numbers<Real>(), [](Real x) { return phimis::is_finite(x) ? std::fabs(x) : Real(1); });
}

/// Positive, over few decades: of which powers are numbers, too.
template <class Real>
rc::Gen<Real> moderate() {
  return rc::gen::map(rc::gen::inRange(1, 1025), [](int i) { return static_cast<Real>(i) / 64; });
}

template <class Value, int M>
rc::Gen<phimis::per_technique<Value, M>> of_each(const rc::Gen<Value>& one) {
  return rc::gen::map(rc::gen::container<std::vector<Value>>(M, one), [](const std::vector<Value>& values) {
    phimis::per_technique<Value, M> result{};
    for (int k = 0; k < M; ++k) result[k] = values[static_cast<std::size_t>(k)];
    return result;
  });
}

template <class Real, int M>
rc::Gen<phimis::fractions<Real, M>> fractions() {
  return rc::gen::map(of_each<Real, M>(densities<Real>()), [](const auto& shares) {
    return phimis::with_floors(shares, phimis::per_technique<Real, M>{});
  });
}

/// Valid options: floors that leave room, costs within a few decades.
template <class Real, int M>
rc::Gen<phimis::rule_options<Real, M>> options() {
  return rc::gen::apply(
      [](const auto& start, auto floors, int percent, const auto& costs, int prior) {
        for (int k = 0; k < M; ++k) floors[k] *= static_cast<Real>(percent) / 100;
        return phimis::rule_options<Real, M>{start, floors, static_cast<Real>(prior), costs, {}};
      },
      fractions<Real, M>(), fractions<Real, M>(), rc::gen::inRange(0, 101),
      of_each<Real, M>(moderate<Real>()), rc::gen::inRange(0, 3));
}

/// Drawn from the mixture of their pdfs, of numbers of one kind.
template <class Real, int M>
rc::Gen<std::vector<phimis::observation<Real, M>>> observations(const rc::Gen<Real>& number) {
  return rc::gen::container<std::vector<phimis::observation<Real, M>>>(rc::gen::apply(
      [](Real f, const auto& pdfs, int technique) {
        return phimis::observation<Real, M>{f, pdfs, phimis::mixture(phimis::equal_fractions<Real, M>(), pdfs),
                                            technique};
      },
      number, of_each<Real, M>(number), rc::gen::inRange(0, M)));
}

}  // namespace generators

#endif  // PHIMIS_TESTS_PROPERTY_RAPIDCHECK_GENERATORS_HPP
