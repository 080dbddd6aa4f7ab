// SPDX-License-Identifier: MIT
#ifndef PHIMIS_QUADRATURE_PANELS_HPP
#define PHIMIS_QUADRATURE_PANELS_HPP

#include <phimis/core/finite.hpp>
#include <phimis/error.hpp>
#include <phimis/interval.hpp>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace phimis {

/// A value and a bound on how far it may be from the truth.
struct measured {
  double value;
  double error;
};

/// One node of the 31-point Gauss–Kronrod rule on [−1, 1], with its weight in the embedded 15-point Gauss rule (0 where
/// it is no node of that).
struct kronrod_node {
  double x;
  double weight;
  double gauss_weight;
};

/// The nodes of the Gauss–Kronrod rule, from Boost.Math, in increasing order.
inline const std::array<kronrod_node, 31>& kronrod_nodes() {
  static const std::array<kronrod_node, 31> nodes = [] {
    using kronrod = boost::math::quadrature::gauss_kronrod<double, 31>;
    using gauss = boost::math::quadrature::gauss<double, 15>;
    std::array<kronrod_node, 31> result{};
    for (std::size_t i = 0; i < 16; ++i) {
      const double weight = kronrod::weights()[i];
      const double gauss_weight = i % 2 == 0 ? gauss::weights()[i / 2] : 0;
      const double x = kronrod::abscissa()[i];
      result[15 + i] = {x, weight, gauss_weight};
      result[15 - i] = {-x, weight, gauss_weight};
    }
    return result;
  }();
  return nodes;
}

/// The edges of panels on which a family of functions is smooth enough for the Gauss–Kronrod rule: bisected until the
/// difference to the embedded Gauss rule is at most `tolerance` of each function's integral of its absolute value.
///
///     functions(x) -> std::array<double, K>
///
/// Requires a bounded domain; breakpoints (kinks, jumps, and features narrower than 1/100 of the domain, which no node may
///          meet) inside it, in any order.
/// Errors   std::invalid_argument where the domain is unbounded or a function is not finite inside it.
template <class Functions>
std::vector<double> smooth_panels(const Functions& functions, const interval& domain,
                                  std::span<const double> breakpoints = {}, double tolerance = 1e-14) {
  require(domain.bounded(), "domain", "must be bounded", domain.length());
  using values = decltype(functions(0.0));
  constexpr int deepest = 40;
  constexpr int first_panels = 4;
  std::vector<double> edges{domain.lower(), domain.upper()};
  for (const double x : breakpoints) {
    if (x > domain.lower() && x < domain.upper()) edges.push_back(x);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  struct panel {
    double lower, upper;
    int depth;
    values integral, difference;
  };
  const auto measure = [&](double lower, double upper, int depth) {
    panel p{lower, upper, depth, {}, {}};
    const double half = (upper - lower) / 2;
    const double middle = lower + half;
    values signed_difference{};
    for (const kronrod_node& node : kronrod_nodes()) {
      const double x = middle + half * node.x;
      const values v = functions(x);
      for (std::size_t i = 0; i < v.size(); ++i) {
        require(is_finite(v[i]), "function", "must be finite inside its domain; it is not at x", x);
        p.integral[i] += half * node.weight * std::fabs(v[i]);
        signed_difference[i] += half * (node.weight - node.gauss_weight) * v[i];
      }
    }
    for (std::size_t i = 0; i < signed_difference.size(); ++i) p.difference[i] = std::fabs(signed_difference[i]);
    return p;
  };

  std::vector<panel> work;
  values total{};
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    for (int j = 0; j < first_panels; ++j) {
      const double width = (edges[i + 1] - edges[i]) / first_panels;
      const double upper = j + 1 == first_panels ? edges[i + 1] : edges[i] + (j + 1) * width;
      work.push_back(measure(edges[i] + j * width, upper, 0));
      for (std::size_t k = 0; k < total.size(); ++k) total[k] += work.back().integral[k];
    }
  }
  std::vector<double> result{domain.lower()};
  while (!work.empty()) {
    const panel p = work.back();
    work.pop_back();
    bool smooth = true;
    for (std::size_t k = 0; k < total.size(); ++k) smooth = smooth && !(p.difference[k] > tolerance * total[k]);
    const double middle = p.lower + (p.upper - p.lower) / 2;
    if (smooth || p.depth == deepest || !(p.lower < middle && middle < p.upper)) {
      result.push_back(p.upper);
      continue;
    }
    work.push_back(measure(p.lower, middle, p.depth + 1));
    work.push_back(measure(middle, p.upper, p.depth + 1));
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// Integral of one function over one panel.
template <class Function>
double integrate_panel(const Function& function, double lower, double upper) {
  const double half = (upper - lower) / 2;
  const double middle = lower + half;
  double sum = 0;
  for (const kronrod_node& node : kronrod_nodes()) sum += node.weight * function(middle + half * node.x);
  return half * sum;
}

}  // namespace phimis

#endif  // PHIMIS_QUADRATURE_PANELS_HPP
