// SPDX-License-Identifier: MIT
// test: --quick --output reproduction
#include <papers/program.hpp>
#include <papers/report.hpp>
#include <papers/variance_report.hpp>

#include <cstdio>
#include <string>

// Reproduces Tables 3, 4, 5 and the printed numbers of Sbert, Havran & Szirmay-Kalos, "Variance Analysis of Multi-sample
// and One-sample Multiple Importance Sampling", Pacific Graphics 2016.

namespace {

using namespace papers;

std::string listed(const triple& alpha, int digits) {
  std::string text;
  for (const double a : alpha) text += (text.empty() ? "(" : ", ") + with_digits(a, digits);
  return text + ")";
}

/// What the paper did not look for: the fractions of the least variance and of the least cost × variance.
std::string least_table(const four_studies& of) {
  const auto shown = [](const phimis::measured& least) {
    return least.value < 1e-20 ? std::string("0") : with_digits(least.value, 9);
  };
  const auto row = [&](const variance_study& s, const char* what, const triple& alpha,
                       const phimis::measured& least) {
    return "| " + std::to_string(s.number) + " | " + what + " | " + listed(alpha, 9) + " | " + shown(least) + " |\n";
  };
  std::string text = "| example | least | at α | value |\n|---|---|---|---|\n";
  for (const variance_study& s : of) {
    const auto& costs = variance_setting::costs;
    text += row(s, "V[F]", s.least_multi_sample.alpha, s.least_multi_sample.variance.multi_sample);
    text += row(s, "V[ℱ]", s.least_one_sample.alpha, s.least_one_sample.variance.one_sample);
    text += row(s, "cost × V[F]", s.cheapest_multi_sample.alpha, s.cheapest_multi_sample.multi_sample_times_cost());
    text += row(s, "cost × V[ℱ]", s.cheapest_one_sample.alpha, s.cheapest_one_sample.one_sample_times_cost());
    text +=
        row(s, "cost × V[F], count-independent weights", phimis::analysis::best_fractions(s.parts.variance, costs),
            phimis::analysis::least_inefficiency(s.parts.variance, costs));
  }
  return text;
}

/// V[F] of every weight heuristic at equal counts and at n_i ∝ σ_i, and the least cost × V[F].  V after Eq. 30
std::string heuristics_table(const four_studies& of) {
  using namespace phimis;
  std::string text =
      "| example | weight heuristic | V[F] of equal counts | at n_i ∝ σ_i | least cost × V[F] "
      "|\n|---|---|---|---|---|\n";
  const auto add = [&](const variance_study& s, const char* name, const auto& heuristic) {
    const auto parts = analysis::moments_of_parts(heuristic, s.problem);
    const auto shown = [](const measured& v) {
      return v.value <= v.error ? std::string("0") : with_digits(v.value, 9);
    };
    text += "| " + std::to_string(s.number) + " | " + name + " | " +
            shown(analysis::variance_of_parts(parts.variance, equal_fractions<double, 3>())) + " | " +
            shown(analysis::least_inefficiency(parts.variance)) + " | " +
            shown(analysis::least_inefficiency(parts.variance, variance_setting::costs)) + " |\n";
  };
  for (const variance_study& s : of) {
    add(s, "balance", balance{});
    add(s, "power, β = 2", power{2});
    add(s, "cutoff, a = 0.1", cutoff{0.1});
    add(s, "maximum", maximum{});
  }
  return text;
}

std::string section(const comparisons& table, const four_studies& studies) {
  return "## Variance analysis\n\n"
         "M. Sbert, V. Havran, L. Szirmay-Kalos: Variance Analysis of Multi-sample and One-sample Multiple "
         "Importance "
         "Sampling. Pacific Graphics 2016. Techniques x, x² − x/π and sin x on [3/(2π), π], normalised there; costs "
         "1, "
         "6.24, 3.28. Variances are for N = 1 sample, costs are the mean of a sample.\n\n"
         "### Printed numbers and statements\n\n" +
         table.markdown() +
         "\n### The least variance and the least cost × variance\n\n"
         "The paper compares given fractions. The best ones, of all, are these: in examples 1 and 2 the cheapest "
         "technique alone has a cost × variance that none of the tables reaches, and example 3 has a mixture of zero "
         "variance.\n\n" +
         least_table(studies) +
         "\n### Weights that do not depend on the counts\n\n"
         "Any weight heuristic, evaluated at equal counts, gains by n_i ∝ σ_i; with costs by n_i ∝ σ_i/√c_i.\n\n" +
         heuristics_table(studies);
}

int reproduce(const arguments& given) {
  const output_folder folder(given.output);
  const four_studies studies = variance_studies();
  const comparisons table = variance_comparisons(studies);
  write_report(folder, table, section(table, studies));

  std::printf(
      "cost x variance for N = 1\n"
      "example  equal counts  1/(c V[G]), one-sample  sigma/sqrt(c)  least of all\n");
  for (const variance_study& of : studies) {
    const double best = phimis::analysis::least_inefficiency(of.parts.variance, variance_setting::costs).value;
    std::printf("%7d    %10.6g              %10.6g     %10.4g    %10.4g\n", of.number,
                of.equal.multi_sample_times_cost().value, of.by_cost_and_variance.one_sample_times_cost().value, best,
                of.cheapest_multi_sample.multi_sample_times_cost().value);
  }
  std::printf("%s: reproduction.md, tables.csv\n", folder.path().c_str());
  return conclude("variance_tables", table);
}

}  // namespace

int main(int argc, char** argv) {
  return run_program(argc, argv,
                     {.name = "variance_tables",
                      .about = "Tables 3, 4, 5 and the printed numbers of \"Variance Analysis of Multi-sample "
                               "and One-sample Multiple Importance Sampling\"",
                      .quick = "changes nothing: all is exact",
                      .full = "changes nothing: all is exact"},
                     reproduce);
}
