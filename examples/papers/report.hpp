// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_REPORT_HPP
#define PHIMIS_EXAMPLES_PAPERS_REPORT_HPP

#include <papers/comparison.hpp>
#include <papers/gnuplot.hpp>
#include <papers/output_folder.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

// One report of all papers, to which each program adds its part.

namespace papers {

/// A figure, the name of its files, and the sentence that goes with it.
struct captioned_figure {
  std::string name;
  std::string caption;
  figure drawing;
  std::string csv;
};

/// Numbers of a figure's data, to twelve digits.
inline std::string csv_line(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ",") + with_digits(value, 12);
  return text + '\n';
}

/// Where the figures of a report and their data go.
inline output_folder figures_of(const output_folder& report) { return output_folder(report.path() / "figures"); }

inline void write_figures(const std::vector<captioned_figure>& figures, const output_folder& drawings) {
  for (const captioned_figure& one : figures) {
    plot(one.drawing, drawings, one.name);
    drawings.write(one.name + ".csv", one.csv);
  }
}

/// Figures with their captions, for a section of the report.
inline std::string markdown(const std::vector<captioned_figure>& figures) {
  std::string text;
  for (const captioned_figure& one : figures) {
    text += "![" + one.caption + "](figures/" + one.name + ".svg)\n\n" + one.caption + ". Data: [" + one.name +
            ".csv](figures/" + one.name + ".csv).\n\n";
  }
  return text;
}

/// The parts of the report by their keys, in its order: a paper each, and what both T and L render.
inline constexpr const char* part_keys[] = {"T", "L", "V", "direct_lighting", "environment_lighting"};

namespace detail {

/// The contents of a file, empty where there is none.
inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

}  // namespace detail

/// Puts one part's rows and section into the report of a folder, and leaves the other parts.
///
///     tables/KEY.csv, sections/KEY.md     each part's own
///     tables.csv, reproduction.md         all parts that are there, in the order of part_keys
///
/// Requires a section that starts with its "## " heading; the table's key is one of part_keys.
inline void write_report(const output_folder& folder, const comparisons& table, const std::string& section) {
  const output_folder tables(folder.path() / "tables");
  const output_folder sections(folder.path() / "sections");
  tables.write(table.paper() + ".csv", table.csv());
  sections.write(table.paper() + ".md", section);

  std::string rows;
  std::string page =
      "# Reproduction\n\n"
      "Made by `sh examples/reproduce.sh`, which writes this page, `tables.csv`, `images/` and `figures/`, with the "
      "data behind each figure as CSV. Do not edit it: run the command again.\n";
  for (const std::string key : part_keys) {
    const std::string of_part = detail::contents(tables.path() / (key + ".csv"));
    rows += rows.empty() ? of_part : of_part.substr(of_part.find('\n') + 1);  // the header once
    const std::string about = detail::contents(sections.path() / (key + ".md"));
    if (!about.empty()) page += '\n' + about.substr(0, about.find_last_not_of('\n') + 1) + '\n';
  }
  folder.write("tables.csv", rows);
  folder.write("reproduction.md", page);
}

/// Says on the terminal how many rows agree, and which do not agree as they should. Returns the program's exit status.
inline int conclude(const char* program, const comparisons& table) {
  int agree = 0;
  int surprises = 0;
  for (const comparison& row : table.rows()) {
    agree += row.found != agreement::none ? 1 : 0;
    if (row.as_expected()) continue;
    ++surprises;
    std::fprintf(stderr, "%s: %s: printed %s, computed %s, agrees: %s\n", program, row.item.c_str(),
                 row.printed.c_str(), row.computed.c_str(), row.agrees().c_str());
  }
  std::printf("%d of %zu printed numbers and statements agree, the others are %s\n", agree, table.rows().size(),
              surprises == 0 ? "explained in their notes" : "explained in their notes or listed above");
  return surprises == 0 ? 0 : 1;
}

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_REPORT_HPP
