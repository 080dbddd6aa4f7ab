// SPDX-License-Identifier: MIT
#ifndef PHIMIS_BENCH_PEERS_MULTICHANNEL_HPP
#define PHIMIS_BENCH_PEERS_MULTICHANNEL_HPP

#include <phimis/core/rule.hpp>

#include <cmath>

namespace bench::peers {

/// Multichannel integration: what a channel did for the variance in the last iteration, to a power, changes its fraction.
///
///     W_k = (1/n) Σ_j p_kj/q_j (f_j/p(α, x_j))²,   α_k ← α_k W_k^β, normalised, then raised to the floors
///
/// β = ¼, ½ and 1 are in use. Of the one-sample model; its programs combine iterations by inverse variance.
///
/// Source Kleiss & Pittau 1994, "Weight optimization in multichannel Monte Carlo".
template <int M>
class multichannel : public phimis::rule_base<double, M> {
 public:
  explicit multichannel(double exponent)
      : phimis::rule_base<double, M>(phimis::rule_options<double, M>{}), exponent_(exponent) {}

  void observe(const phimis::observation<double, M>& sample) {
    phimis::row<double, M> ignored;
    if (!this->admit(sample, ignored) || sample.f == 0) return;
    const double t = sample.f / phimis::mixture(this->state_.fractions, sample.pdfs);
    for (int k = 0; k < M; ++k) sums_[k] += sample.pdfs[k] / sample.q * t * t;
  }

  phimis::rule_status update() {
    double total = 0;
    for (int k = 0; k < M; ++k) total += this->state_.fractions[k] * sums_[k];
    if (!(total > 0)) return this->end(phimis::rule_status::no_information);
    phimis::fractions<double, M> shares = this->state_.fractions;
    for (int k = 0; k < M; ++k) shares[k] *= std::pow(sums_[k] / total, exponent_);
    this->state_.fractions = phimis::share_budget(shares, this->options_);
    sums_ = {};
    return this->end(phimis::rule_status::updated);
  }

  void merge(const multichannel& other) {
    this->state_.counters.merge(other.state_.counters);
    for (int k = 0; k < M; ++k) sums_[k] += other.sums_[k];
  }

 private:
  double exponent_;
  phimis::per_technique<double, M> sums_{};
};

}  // namespace bench::peers

#endif  // PHIMIS_BENCH_PEERS_MULTICHANNEL_HPP
