// SPDX-License-Identifier: MIT
// test: --quick --output reproduction
#include <papers/linear_report.hpp>
#include <papers/program.hpp>
#include <papers/report.hpp>

#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

// Reproduces the 1-D figures and the printed numbers of Sbert & Szirmay-Kalos, "A linear heuristic for multiple importance
// sampling", EURASIP J. Adv. Signal Process. 2023, 31, Sec. 6.1.

namespace {

constexpr int quick_runs = 20;
constexpr int full_runs = 1000;

std::vector<papers::captioned_figure> figures(const papers::linear_studies& all) {
  using namespace papers;
  const std::string newton = "V[F] at the fractions after 4 Newton–Raphson iterations of 50 samples";
  const std::string linear = "V[F] at the fractions of the linear heuristic, from 100 samples of each technique";
  const std::string neither = "neither pdf alone is proportional to the integrand f";
  const std::string none = "no pdf alone is proportional to the integrand f";
  const std::string first = "Gauss(–1.5, 1)";
  const std::string second = "Gauss(1.5, 0.75)";
  const std::string third = "Gauss(–0.5, 1)";
  return {
      means_figure(all.first, 1),
      means_figure(all.first, 2),
      means_figure(all.second, 1),
      means_figure(all.third, 1),
      means_figure(all.third, 2),
      linear_integrand(all.first, "2", neither, {"Gauss(2, 1)", "Gauss(8, 2)"}),
      runs_figure(all.first, 3, "Newton–Raphson now and then ends far from the least V[F]", newton,
                  &linear_run::newton),
      runs_figure(all.first, 4, "the linear heuristic always comes near the least V[F]", linear,
                  &linear_run::dropped),
      linear_integrand(all.second, "5", neither, {first, second}),
      runs_figure(all.second, 6, "noise keeps Newton–Raphson from zero variance", newton, &linear_run::newton),
      runs_figure(all.second, 7, "the linear heuristic finds the zero-variance mixture", linear,
                  &linear_run::dropped),
      linear_integrand(all.third, "8", neither, {"(2 – x) / Z_1", "sin^2(x) / Z_2"}),
      runs_figure(all.third, 9, "Newton–Raphson often ends above equal counts", newton, &linear_run::newton),
      runs_figure(all.third, 10, "the linear heuristic always comes near the least V[F]", linear,
                  &linear_run::dropped),
      linear_integrand(all.fourth, "11", none, {first, second, third}),
      runs_figure(
          all.fourth, 12, "the linear heuristic halves the variance of equal counts",
          linear +
              "; negative solutions are sorted out by the second technique of Sec. 5.1, the paper does not say how",
          &linear_run::best_face),
      linear_integrand(all.fifth, "13", none, {first, second, third, "Gauss(0.5, 1)"}),
      runs_figure(
          all.fifth, 14, "the linear heuristic cuts the variance of equal counts to a sixth",
          linear +
              "; negative solutions are sorted out by the second technique of Sec. 5.1, the paper does not say how",
          &linear_run::best_face),
      linear_integrand(all.sixth, "15", none, {"x / Z_1", "(x^2 – x / π) / Z_2", "sin(x) / Z_3"}),
      runs_figure(all.sixth, 16, "with α_1 = 0 the linear heuristic comes near the least V[F]",
                  linear + ", of the second and third alone", &linear_run::without_1),
      runs_figure(all.sixth, 17, "the first technique comes near the least V[F]",
                  linear + ", the most negative fraction set to 0 until none is negative", &linear_run::dropped),
      runs_figure(all.sixth, 18, "the second technique comes as near",
                  linear + ", the fraction set to 0 that leaves the least sample variance", &linear_run::best_face),
      runs_figure(
          all.fifth,
          {"example_5_project", "Example 5: from sums alone, the projection mostly comes near the least V[F]",
           "not in the paper: V[F] at the fractions learnt from the same 100 samples of each technique, by both "
           "techniques of the paper, by ours, and by the exact minimiser, which keeps the samples (triangles: above "
           "the picture)"},
          {{"first technique", "first_technique_V_F", &linear_run::dropped, circles, colour::vermillion},
           {"second technique", "second_technique_V_F", &linear_run::best_face, squares, colour::green},
           {"projection (ours)", "projected_V_F", &linear_run::projected, dots, colour::blue},
           {"exact minimiser", "exact_V_F", &linear_run::exact, dots, colour::black}},
          runs_range::near_the_least)};
}

std::string section(const papers::comparisons& table, const std::vector<papers::captioned_figure>& drawn,
                    const papers::linear_studies& all, const papers::arguments& given) {
  std::ostringstream text;
  text << "## Linear heuristic\n\n"
          "M. Sbert, L. Szirmay-Kalos: A linear heuristic for multiple importance sampling. EURASIP Journal on "
          "Advances in "
          "Signal Processing 2023, 31. Pdfs are truncated to the domain and renormalised there. Variances are for N "
          "= 1 "
          "sample. Figure 19 is a rendering. Made by `linear_heuristic_figures"
       << given.effort() << "`.\n\n### Printed numbers and statements of the linear heuristic\n\n"
       << table.markdown()
       << "\n### Negative solutions\n\n"
          "V[F] at the fractions learnt from 100 samples of each technique (Newton–Raphson: 4 × 50), relative to the "
          "least "
          "V[F]; in example 2, where that is 0, to V[F] of equal counts. Median and 90th percentile of "
       << all.first.runs.size()
       << " runs; \"ours\" is `negative_fractions::project`. Data: "
          "[linear_repeated_runs.csv](figures/linear_repeated_runs.csv).\n\n"
       << papers::linear_runs_table(all) << "\nWith infinitely many samples, by quadrature:\n\n"
       << papers::linear_limits_table(all) << "\n### Figures of the linear heuristic\n\n"
       << papers::markdown(drawn);
  return text.str();
}

int reproduce(const papers::arguments& given) {
  using namespace papers;
  require_gnuplot();
  const output_folder folder(given.output);
  const output_folder drawings = figures_of(folder);

  const int runs = given.full ? full_runs : given.quick ? quick_runs : static_cast<int>(shown_runs);
  linear_studies all{study_linear(1, tsallis_1{}, given.seed, runs), study_linear(2, tsallis_2{}, given.seed, runs),
                     study_linear(3, tsallis_3{}, given.seed, runs), study_linear(4, linear_4{}, given.seed, runs),
                     study_linear(5, linear_5{}, given.seed, runs),  study_linear(6, linear_6{}, given.seed, runs)};
  const comparisons table = linear_comparisons(all);
  drawings.write("linear_repeated_runs.csv", linear_runs_csv(all));
  const std::vector<captioned_figure> drawn = figures(all);
  write_figures(drawn, drawings);
  write_report(folder, table, section(table, drawn, all, given));

  std::printf(
      "median V[F] of %d runs, 100 samples a technique\n"
      "example  equal counts         least   first technique   second technique        ours\n",
      runs);
  all.each([](const auto& of) {
    std::printf("%7d    %10.6g    %10.4g        %10.4g         %10.4g  %10.4g\n", of.number, of.equal, of.least.value,
                detail::quantile(of, &linear_run::dropped, 0.5), detail::quantile(of, &linear_run::best_face, 0.5),
                detail::quantile(of, &linear_run::projected, 0.5));
  });
  std::printf("%s: reproduction.md, tables.csv, figures/ (%zu figures)\n", folder.path().c_str(), drawn.size());
  return conclude("linear_heuristic_figures", table);
}

}  // namespace

int main(int argc, char** argv) {
  return papers::run_program(
      argc, argv,
      {.name = "linear_heuristic_figures",
       .about = "Figures 1 to 18 and the printed numbers of \"A linear heuristic for multiple importance sampling\"",
       .quick = "20 runs in place of 100",
       .full = "1000 runs for the table of repeated runs; figures show 100"},
      reproduce);
}
