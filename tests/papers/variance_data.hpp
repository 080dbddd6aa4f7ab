// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_PAPERS_VARIANCE_DATA_HPP
#define PHIMIS_TESTS_PAPERS_VARIANCE_DATA_HPP

#include "tsallis_data.hpp"

#include <papers/variance_report.hpp>

#include <cmath>
#include <map>
#include <string>

namespace papers_test {

/// The study of example "V1", "V2", "V3" or "V4".
inline const papers::variance_study& variance_example(const std::string& name) {
  static const papers::four_studies all = papers::variance_studies();
  return all[static_cast<std::size_t>(name[1] - '1')];
}

/// Examples 4 and 5 of "A linear heuristic for multiple importance sampling", Eqs. 23, 24.
inline const phimis::analysis::problem<3>& linear_example_4() {
  using papers::normal_pdf;
  static const phimis::interval domain(-3, 3);
  static const phimis::analysis::problem<3> on(
      [](double x) { return normal_pdf(x, -1.8, 1) + 2 * normal_pdf(x, 1.5, 0.75) + 3 * normal_pdf(x, -0.5, 0.5); },
      phimis::technique_set(phimis::gaussian(-1.5, 1, domain), phimis::gaussian(1.5, 0.75, domain),
                            phimis::gaussian(-0.5, 1, domain)),
      domain);
  return on;
}
inline const phimis::analysis::problem<4>& linear_example_5() {
  using papers::normal_pdf;
  static const phimis::interval domain(-3, 3);
  static const phimis::analysis::problem<4> on(
      [](double x) {
        return normal_pdf(x, -1.8, 1) + 6 * normal_pdf(x, 1.5, 0.75) + 3 * normal_pdf(x, -0.5, 0.5) +
               3 * normal_pdf(x, 0.5, 0.5);
      },
      phimis::technique_set(phimis::gaussian(-1.5, 1, domain), phimis::gaussian(1.5, 0.75, domain),
                            phimis::gaussian(-0.5, 1, domain), phimis::gaussian(0.5, 1, domain)),
      domain);
  return on;
}

/// A quantity of variance_numbers.csv, of technique k from 0.
inline phimis::measured quantity(const papers::variance_study& of, const std::string& name, int k) {
  using namespace phimis::analysis;
  using phimis::measured;
  const auto& costs = papers::variance_setting::costs;
  const auto& parts = of.parts.variance;
  const auto exact = [](double value) { return measured{value, 0}; };
  const auto quotient = [](measured above, measured below) {
    return measured{above.value / below.value, (above.error + below.error * above.value / below.value) / below.value};
  };
  const auto sigma = best_fractions(parts);
  const auto priced_sigma = best_fractions(parts, costs);
  const auto by_sigma = variance_of_parts(parts, sigma);
  if (name == "variance alone") return of.alone[k];
  if (name == "equal multi_sample") return of.equal.variance.multi_sample;
  if (name == "equal one_sample") return of.equal.variance.one_sample;
  if (name == "1/V multi_sample") return of.by_variance.variance.multi_sample;
  if (name == "1/V one_sample") return of.by_variance.variance.one_sample;
  if (name == "equal cost one_sample") return of.equal.one_sample_times_cost();
  if (name == "equal cost multi_sample") return of.equal.multi_sample_times_cost();
  if (name == "1/cV cost one_sample") return of.by_cost_and_variance.one_sample_times_cost();
  if (name == "1/cV cost multi_sample") return of.by_cost_and_variance.multi_sample_times_cost();
  if (name == "true 1/cV cost one_sample") return of.by_cost_and_true_variance.one_sample_times_cost();
  if (name == "quotient of efficiencies") {
    return quotient(of.equal.one_sample_times_cost(), of.by_cost_and_variance.one_sample_times_cost());
  }
  if (name == "1/V fraction") return exact(of.by_variance.alpha[k]);
  if (name == "true 1/V fraction") return exact(of.by_true_variance.alpha[k]);
  if (name == "1/cV fraction") return exact(of.by_cost_and_variance.alpha[k]);
  if (name == "true 1/V multi_sample") return of.by_true_variance.variance.multi_sample;
  if (name == "true 1/V one_sample") return of.by_true_variance.variance.one_sample;
  if (name == "Eq. 52 as printed 1/V") return exact(papers::detail::as_printed_in_eq_52(of, of.by_variance.alpha));
  if (name == "Eq. 52 as printed equal") return exact(papers::detail::as_printed_in_eq_52(of, of.equal.alpha));
  if (name == "part variance") return parts[k];
  if (name == "part mean") return of.parts.mean[k];
  if (name == "sigma fraction") return exact(sigma[k]);
  if (name == "sigma/sqrt(c) fraction") return exact(priced_sigma[k]);
  if (name == "least count_independent") return least_inefficiency(parts);
  if (name == "sigma cost count_independent") {
    const double cost = mean_cost(sigma, costs);
    return {cost * by_sigma.value, cost * by_sigma.error};
  }
  if (name == "least cost count_independent") return least_inefficiency(parts, costs);
  if (name == "sigma/sqrt(c) count_independent") return variance_of_parts(parts, priced_sigma);
  if (name == "gain of sigma") return quotient(of.equal.variance.multi_sample, by_sigma);
  if (name == "gain of sigma/sqrt(c) with costs") {
    return quotient(of.equal.multi_sample_times_cost(), least_inefficiency(parts, costs));
  }
  throw std::runtime_error("no quantity '" + name + "'");
}

}  // namespace papers_test

#endif  // PHIMIS_TESTS_PAPERS_VARIANCE_DATA_HPP
