// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ANALYSIS_ALLOCATION_HPP
#define PHIMIS_ANALYSIS_ALLOCATION_HPP

#include <phimis/analysis/problem.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/weight_heuristic.hpp>
#include <phimis/quadrature/panels.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace phimis::analysis {

namespace detail {

/// Whether ∫ h dx is infinite, h >= 0: whether halves of panels that shrink towards a point keep adding as much.
///
/// They shrink to where double hardly tells their nodes apart. A power |x|^{−s} is told from a divergent one where s <= 0.96.
template <class Function>
bool diverges(const Function& h, double lower, double upper) {
  constexpr int deepest = 200;
  constexpr int levels = 14;
  constexpr double kept = 0.7;
  struct panel {
    double lower, upper;
    std::vector<double> siblings;  // integrals over the other halves on the way down
  };
  std::vector<panel> work;
  double total = 0;
  constexpr int first_panels = 8;
  for (int i = 0; i < first_panels; ++i) {
    const double a = lower + (upper - lower) * i / first_panels;
    const double b = i + 1 == first_panels ? upper : lower + (upper - lower) * (i + 1) / first_panels;
    work.push_back({a, b, {}});
    total += integrate_panel(h, a, b);
  }
  while (!work.empty()) {
    panel p = std::move(work.back());
    work.pop_back();
    const double middle = p.lower + (p.upper - p.lower) / 2;
    const double whole = integrate_panel(h, p.lower, p.upper);
    const double left = integrate_panel(h, p.lower, middle);
    const double right = integrate_panel(h, middle, p.upper);
    if (!is_finite(left) || !is_finite(right)) return true;
    if (std::fabs(whole - left - right) <= 1e-12 * (total + left + right)) continue;
    const double resolved = 64 * epsilon<double> * std::max(std::fabs(p.lower), std::fabs(p.upper));
    if (p.siblings.size() == deepest || !(p.upper - p.lower > resolved)) {
      if (p.siblings.size() < 2 * levels) continue;
      const auto last = p.siblings.end() - levels;
      const double now = std::accumulate(last, p.siblings.end(), 0.0);
      const double before = std::accumulate(last - levels, last, 0.0);
      if (now > kept * before) return true;
      continue;
    }
    panel second{middle, p.upper, p.siblings};
    second.siblings.push_back(left);
    p.siblings.push_back(right);
    work.push_back(std::move(second));
    work.push_back({p.lower, middle, std::move(p.siblings)});
  }
  return false;
}

/// Where a weight jumps, between the nodes of a problem, to the last digit.
template <class Heuristic, int M>
std::vector<double> jumps(const count_independent<Heuristic>& heuristic, const problem<M>& on) {
  const fractions<double, M> equal = equal_fractions<double, M>();
  const auto weights = [&](double x) {
    const per_technique<double, M> p = on.pdfs_at(x);
    per_technique<double, M> w{};
    for (int k = 0; k < M; ++k) w[k] = heuristic(k, equal, p);
    return w;
  };
  const auto distance = [](const per_technique<double, M>& a, const per_technique<double, M>& b) {
    double largest = 0;
    for (int k = 0; k < M; ++k) largest = std::max(largest, std::fabs(a[k] - b[k]));
    return largest;
  };
  constexpr double least = 1e-4;
  std::vector<double> found;
  const std::vector<double>& nodes = on.nodes();
  per_technique<double, M> before = weights(nodes[0]);
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const per_technique<double, M> after = weights(nodes[i]);
    double lower = nodes[i - 1];
    double upper = nodes[i];
    per_technique<double, M> low = before;
    per_technique<double, M> high = after;
    before = after;
    while (distance(low, high) > least) {
      const double middle = lower + (upper - lower) / 2;
      if (!(lower < middle && middle < upper)) {
        found.push_back(middle);
        break;
      }
      const per_technique<double, M> between = weights(middle);
      if (distance(low, between) > distance(between, high)) {
        upper = middle;
        high = between;
      } else {
        lower = middle;
        low = between;
      }
    }
  }
  return found;
}

}  // namespace detail

/// The variance of each technique alone.  V[G_k] = ∫ (f/p_k − μ)² p_k dx
///
/// Source V App. A, written as a sum of squares. What a defective pdf misses counts as samples of value 0.
/// Errors infinite where p_k = 0 < |f|, or where ∫ f²/p_k diverges as far as double can tell points apart: it does for
///        f²/sin x up to the double nearest to π, though that is less than π. At a singularity that is integrable the error
///        is an estimate, no bound.
template <int M>
per_technique<measured, M> variance_alone(const problem<M>& on) {
  per_technique<measured, M> result{};
  const double mu = on.mean().value;
  for (int k = 0; k < M; ++k) {
    const auto square = [&](double f, const per_technique<double, M>& p) {
      return p[k] > 0 ? f / p[k] * f : f == 0 ? 0.0 : infinity<double>;
    };
    const auto at = [&](double x) { return square(on.f(x), on.pdfs_at(x)); };
    if (detail::diverges(at, on.domain().lower(), on.domain().upper())) {
      result[k] = {infinity<double>, 0};
      continue;
    }
    result[k] = on.refined_for(square).integral([&](double f, const per_technique<double, M>& p, double) {
      return p[k] > 0 ? (f / p[k] - mu) * (f / p[k] - mu) * p[k] : 0.0;
    });
    result[k].value += on.missing_mass()[k] * mu * mu;
  }
  return result;
}

/// What each technique contributes under weights that do not depend on the counts.
///
///     μ_k = ∫ w_k f dx,   σ_k² = ∫ (w_k f/p_k − μ_k)² p_k dx
template <int M>
struct part_moments {
  per_technique<measured, M> mean;
  per_technique<measured, M> variance;
};

/// Moments of w_k f/p_k under p_k for any weight heuristic, evaluated at equal counts.
///
/// Where weights jump, as those of `cutoff` and `maximum` do, the panels are split.
///
/// Source V Eqs. 5–8, 28.   Errors infinite where p_k = 0 < |w_k f|.
template <class Heuristic, int M>
part_moments<M> moments_of_parts(const Heuristic& heuristic, const problem<M>& on) {
  const count_independent<Heuristic> weights{heuristic};
  const fractions<double, M> equal = equal_fractions<double, M>();
  const problem<M> split = on.split_at(detail::jumps(weights, on));
  part_moments<M> result{};
  for (int k = 0; k < M; ++k) {
    const auto part = [&](double f, const per_technique<double, M>& p) { return weights(k, equal, p) * f; };
    const auto square = [&](double f, const per_technique<double, M>& p) {
      const double share = part(f, p);
      return p[k] > 0 ? share / p[k] * share : share == 0 ? 0.0 : infinity<double>;
    };
    const problem<M> refined = split.refined_for(square);
    result.mean[k] =
        refined.integral([&](double f, const per_technique<double, M>& p, double) { return part(f, p); });
    const double mu = result.mean[k].value;
    const auto centred = [&](double f, const per_technique<double, M>& p, double) {
      if (!(p[k] > 0)) return square(f, p);
      const double excess = part(f, p) / p[k] - mu;
      return excess * excess * p[k];
    };
    result.variance[k] = refined.integral(centred);
    // The rounding of w f/p and μ, which is all that is left where σ vanishes.
    constexpr double rounding = 1e-15;
    const double error = rounding * std::fabs(mu);
    result.variance[k].error += (2 * std::sqrt(result.variance[k].value) + error) * error;
    result.variance[k].value += on.missing_mass()[k] * mu * mu;
  }
  return result;
}

/// Mean cost of a sample.  Σ c_k α_k
template <int M>
double mean_cost(const fractions<double, M>& alpha, const per_technique<double, M>& costs) {
  double sum = 0;
  for (int k = 0; k < M; ++k) sum += alpha[k] * costs[k];
  return sum;
}

/// V[F] for N = 1 where the weights do not depend on the counts.  Σ_k σ_k²/α_k, 0 for a technique with σ_k = 0
///
/// Source V Eqs. 9, 13, 29.   Errors infinite where α_k = 0 < σ_k.
template <int M>
measured variance_of_parts(const per_technique<measured, M>& variance, const fractions<double, M>& alpha) {
  measured sum{0, 0};
  for (int k = 0; k < M; ++k) {
    if (variance[k].value == 0 && variance[k].error == 0) continue;
    sum.value += variance[k].value > 0 ? variance[k].value / alpha[k] : 0;
    sum.error += variance[k].error / alpha[k];
  }
  return sum;
}

/// Fractions of the least cost × V[F]:  α_k ∝ σ_k/√c_k, equal where every σ_k is 0; it is 0 within its error
///
/// Source V Eqs. 11, 14, 31, Theorems 2 and 3.
template <int M>
fractions<double, M> best_fractions(const per_technique<measured, M>& variance,
                                    const per_technique<double, M>& costs = equal_costs<double, M>()) {
  per_technique<double, M> shares{};
  for (int k = 0; k < M; ++k) {
    if (variance[k].value > variance[k].error) shares[k] = std::sqrt(variance[k].value / costs[k]);
  }
  return with_floors(shares, per_technique<double, M>{});
}

/// The least cost × V[F] for N = 1, (Σ σ_k √c_k)²; with costs of 1 the least V[F].
///
/// Source V Eqs. 12, 15.
template <int M>
measured least_inefficiency(const per_technique<measured, M>& variance,
                            const per_technique<double, M>& costs = equal_costs<double, M>()) {
  double sum = 0;
  double above = 0;
  for (int k = 0; k < M; ++k) {
    const double value = std::max(variance[k].value, 0.0);
    sum += std::sqrt(value * costs[k]);
    above += std::sqrt((value + variance[k].error) * costs[k]);
  }
  return {sum * sum, above * above - sum * sum};
}

/// What the minimum of V[F] with the balance heuristic makes equal for all techniques above their floors, −∂V[F]/∂α_j;
/// without floors the common value is the minimum.
///
///     σ'_j² + 2 μ'_j² − 2 ∫ f p_j (Σ_i α_i μ'_i p_i) / p(α)² dx,   μ'_j = E_{p_j}[f/p(α)],   σ'_j² = V_{p_j}[f/p(α)]
///
/// Source V App. C, Eq. 43.
/// - The printed condition, and Eqs. 67, 68 and Table 1 with it, loses p_i in ∂μ'_i/∂α_j = −∫ f p_i p_j/p² dx and has the
///   wrong sign at μ'_j²; this is the right one.
template <int M>
per_technique<double, M> multi_sample_condition(const problem<M>& on, const fractions<double, M>& alpha) {
  using pdfs = per_technique<double, M>;
  per_technique<double, M> mean{};
  per_technique<double, M> result{};
  for (int j = 0; j < M; ++j) {
    const auto own = [&](double f, const pdfs& p, double) { return f == 0 ? 0.0 : p[j] * f / mixture(alpha, p); };
    mean[j] = on.integral(own).value;
  }
  for (int j = 0; j < M; ++j) {
    const auto spread = [&](double f, const pdfs& p, double) {
      const double q = mixture(alpha, p);
      if (!(q > 0)) return f == 0 ? 0.0 : infinity<double>;
      double weighted = 0;  // Σ_i α_i μ'_i p_i / p − μ'_j
      for (int i = 0; i < M; ++i) weighted += alpha[i] * (mean[i] - mean[j]) * p[i] / q;
      return p[j] * (f / q - mean[j]) * (f / q - mean[j]) - 2 * (f / q) * p[j] * weighted;
    };
    result[j] = on.integral(spread).value + on.missing_mass()[j] * mean[j] * mean[j];
  }
  return result;
}

/// Efficiency of an estimator.  1 / (cost × variance), infinite at zero variance
///
/// Source V Sec. 2.1.
inline double efficiency(double cost, double variance) { return 1 / (cost * variance); }

}  // namespace phimis::analysis

#endif  // PHIMIS_ANALYSIS_ALLOCATION_HPP
