// SPDX-License-Identifier: MIT
#ifndef PHIMIS_BENCH_PEERS_ADAM_HPP
#define PHIMIS_BENCH_PEERS_ADAM_HPP

#include <phimis/core/rule.hpp>

#include <algorithm>
#include <cmath>

namespace bench::peers {

/// The fraction of the first of two techniques by stochastic gradient descent, as in path guiding.
///
///     α = 1/(1 + e^−θ),   g = −(|f|/p(α))^P / q · (p_1 − p_2) α (1 − α) + 0.01 θ,   θ by Adam on the mean of two g
///
/// P = 1 descends the Kullback–Leibler divergence, P = 2 the variance. Of the one-sample model; not scale-free. Samples with
/// f = 0 have no gradient and do not count towards the two.
///
/// Source Vorba et al. 2019, "Path guiding in production", after Müller et al.; Kingma & Ba 2015, "Adam".
class adam : public phimis::rule_base<double, 2> {
 public:
  explicit adam(double power) : rule_base(phimis::rule_options<double, 2>{}), power_(power) {}

  void observe(const phimis::observation<double, 2>& sample) {
    phimis::row<double, 2> ignored;
    if (!admit(sample, ignored) || sample.f == 0) return;
    const double alpha = state_.fractions[0];
    const double p = phimis::mixture(state_.fractions, sample.pdfs);
    if (!(p > 0)) return;
    gradients_ += -std::pow(std::fabs(sample.f) / p, power_) / sample.q * (sample.pdfs[0] - sample.pdfs[1]) * alpha *
                      (1 - alpha) +
                  regularisation * theta_;
    ++pending_;
  }

  phimis::rule_status update() {
    if (pending_ < 2) return status();
    const double g = gradients_ / pending_;
    gradients_ = 0;
    pending_ = 0;
    ++steps_;
    first_ = first_decay * first_ + (1 - first_decay) * g;
    second_ = second_decay * second_ + (1 - second_decay) * g * g;
    const double unbiased = std::sqrt(1 - std::pow(second_decay, steps_)) / (1 - std::pow(first_decay, steps_));
    theta_ -= rate * unbiased * first_ / (std::sqrt(second_) + 1e-8);
    theta_ = std::clamp(theta_, -20.0, 20.0);
    state_.fractions[0] = 1 / (1 + std::exp(-theta_));
    state_.fractions[1] = 1 - state_.fractions[0];
    return end(phimis::rule_status::updated);
  }

  /// The gradients that wait for a step; two descents have no common state.
  void merge(const adam& other) {
    state_.counters.merge(other.state_.counters);
    gradients_ += other.gradients_;
    pending_ += other.pending_;
  }

 private:
  static constexpr double rate = 0.01;
  static constexpr double first_decay = 0.9;
  static constexpr double second_decay = 0.999;
  static constexpr double regularisation = 0.01;

  double power_;
  double theta_ = 0;
  double first_ = 0;
  double second_ = 0;
  double gradients_ = 0;
  int pending_ = 0;
  int steps_ = 0;
};

}  // namespace bench::peers

#endif  // PHIMIS_BENCH_PEERS_ADAM_HPP
