// SPDX-License-Identifier: MIT
// test: --quick --output reproduction
#include <papers/program.hpp>
#include <papers/report.hpp>
#include <papers/tsallis_report.hpp>

#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

// Reproduces the figures and printed numbers of Sbert & Szirmay-Kalos, "Robust Multiple Importance Sampling with
// Tsallis φ-Divergences", Entropy 24 (2022) 1240, Secs. 5 to 7 and 9.

namespace {

constexpr int full_repetitions = 200;

std::vector<papers::captioned_figure> figures(const papers::tsallis_study& first, const papers::tsallis_study& second,
                                              const papers::tsallis_study& third) {
  using namespace papers;
  const auto multi_sample = [](const order& at) { return at.multi_sample; };
  const std::string best = with_decimals(gamma_of_least(third, multi_sample), 1);
  return {integrand_figure(first, "Gauss(2, 1)", "Gauss(8, 2)"),
          variance_figure(first, "Fig. 2, example 1: V[F] and V[ℱ] are nearly the same for every γ"),
          zoomed_out(first, "Fig. 3, example 1: every γ nearly halves the variance of equal counts"),
          integrand_figure(second, "Gauss(–1.5, 1)", "Gauss(1.5, 0.75)"),
          variance_figure(second, "Fig. 5, example 2: every γ has the same optimum, of zero variance"),
          zoomed_out(second, "Fig. 6, example 2: noise is all that keeps the dots from zero variance"),
          integrand_figure(third, "(2 – x) / Z_1", "sin^2(x) / Z_2"),
          variance_figure(third, "Fig. 8, example 3: V[ℱ] is least at γ = 2, V[F] at γ = " + best),
          zoomed_out(third, "Fig. 9, example 3: every γ cuts the variance of equal counts to a third"),
          exact_figure(first, "Example 1: with 500 samples the exact minimiser comes near the least variance"),
          exact_figure(second, "Example 2: the zero-variance mixture is found exactly, up to rounding"),
          exact_figure(third, "Example 3: the exact minimiser stays near the optimum of every γ")};
}

std::string runs_table(const std::vector<const papers::tsallis_study*>& studies) {
  std::string text =
      "| example | γ | Newton–Raphson: median, 90 % | left [0, 1] | exact minimiser: median, 90 % |\n"
      "|---|---|---|---|---|\n";
  for (const papers::tsallis_study* of : studies) {
    const bool zero = of->least_multi.value <= of->least_multi.error;
    const double unit = zero ? of->equal_multi : of->least_multi.value;
    for (const int tenths : {1, 5, 10, 20, 40, 80}) {
      const papers::order& at = of->orders[static_cast<std::size_t>(tenths - 1)];
      const auto show = [&](double variance) {
        return zero && variance < 1e-20 ? std::string("0") : papers::with_digits(variance / unit, 4);
      };
      text += "| " + std::to_string(of->number) + " | " + papers::with_digits(at.gamma, 2) + " | " +
              show(at.newton_runs.median) + ", " + show(at.newton_runs.high) + " | " +
              papers::with_decimals(100 * at.newton_runs.left, 1) + " % | " + show(at.exact_runs.median) + ", " +
              show(at.exact_runs.high) + " |\n";
    }
  }
  return text;
}

std::string section(const papers::comparisons& table, const std::vector<papers::captioned_figure>& all,
                    const std::vector<const papers::tsallis_study*>& studies, const papers::arguments& given) {
  std::ostringstream text;
  text << "## Tsallis divergences\n\n"
          "M. Sbert, L. Szirmay-Kalos: Robust Multiple Importance Sampling with Tsallis φ-Divergences. Entropy 24 "
          "(2022) 1240. Every pdf is truncated to the integration domain and renormalised there; the paper does not "
          "say so, but no other reading gives its numbers. Variances are for N = 1 sample. Made by `tsallis_figures"
       << given.effort() << "`.\n\n### Printed numbers and statements\n\n"
       << table.markdown() << "\n### Figures\n\n"
       << papers::markdown(all);
  if (given.full) {
    text << "### Repeated runs\n\n"
            "V[F] at the fractions learnt from 5 × 100 samples over "
         << full_repetitions
         << " runs, relative to the least V[F]; in example 2, where that is 0, to V[F] of equal counts. \"Left\" is "
            "the share of runs in which a Newton–Raphson iterate left [0, 1]; it went on from the nearer end. Data: "
            "[tsallis_repeated_runs.csv](figures/tsallis_repeated_runs.csv).\n\n"
         << runs_table(studies);
  }
  return text.str();
}

int reproduce(const papers::arguments& given) {
  using namespace papers;
  require_gnuplot();
  const output_folder folder(given.output);
  const output_folder drawings = figures_of(folder);

  const int stride = given.quick ? 10 : 1;
  const int repetitions = given.full ? full_repetitions : 0;
  const tsallis_study first = study(1, tsallis_1{}, given.seed, stride, repetitions);
  const tsallis_study second = study(2, tsallis_2{}, given.seed, stride, repetitions);
  const tsallis_study third = study(3, tsallis_3{}, given.seed, stride, repetitions);
  const std::vector<const tsallis_study*> studies{&first, &second, &third};

  const std::vector<captioned_figure> all = figures(first, second, third);
  write_figures(all, drawings);
  if (given.full) drawings.write("tsallis_repeated_runs.csv", repeated_runs_csv(studies));
  const comparisons table = tsallis_comparisons(first, second, third);
  write_report(folder, table, section(table, all, studies, given));

  std::printf(
      "V[F] for N = 1; learnt from 5 x 100 samples at gamma = 1\n"
      "example          mu  equal counts         least  Newton-Raphson  exact minimiser\n");
  for (const tsallis_study* of : studies) {
    const order& at = of->orders[9];
    std::printf("%7d  %10.6g    %10.6g    %10.4g      %10.4g       %10.4g\n", of->number, of->problem.mean().value,
                of->equal_multi, of->least_multi.value, at.newton.variance, at.exact.variance);
  }
  std::printf("%s: reproduction.md, tables.csv, figures/ (%zu figures)\n", folder.path().c_str(), all.size());
  return conclude("tsallis_figures", table);
}

}  // namespace

int main(int argc, char** argv) {
  return papers::run_program(
      argc, argv,
      {.name = "tsallis_figures",
       .about = "Figures 1 to 9 and the printed numbers of \"Robust Multiple Importance Sampling with Tsallis "
                "phi-Divergences\"",
       .quick = "dots at 8 values of gamma in place of 80",
       .full = "also 200 repeated runs for each dot, summarised"},
      reproduce);
}
