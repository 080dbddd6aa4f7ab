// SPDX-License-Identifier: MIT
// The programs of several papers write one report.
#include "catch.hpp"

#include <papers/report.hpp>

#include <filesystem>
#include <string>

namespace {

using papers::comparisons;
using papers::write_report;

comparisons table_of(const std::string& paper, const std::string& item) {
  comparisons table(paper);
  table.number(item, "0.5", 0.5);
  return table;
}

}  // namespace

TEST_CASE("Programs keep their parts of a report, in the same order, whichever program runs when") {
  const papers::output_folder folder(std::filesystem::temp_directory_path() / "phimis_report_test");
  std::filesystem::remove_all(folder.path());
  const papers::output_folder fresh(folder.path());
  const std::string header = "paper,item,printed,computed,agrees,note\n";
  const auto tables = [&] { return papers::detail::contents(folder.path() / "tables.csv"); };
  const auto page = [&] { return papers::detail::contents(folder.path() / "reproduction.md"); };

  write_report(fresh, table_of("V", "first"), "## Variance\n\nv\n\n");
  CHECK(tables() == header + "V,first,0.5,0.5,yes,\n");
  write_report(fresh, table_of("T", "t"), "## Tsallis\n\nt");
  write_report(fresh, table_of("L", "l"), "## Linear\n\nl\n");
  const std::string rest = "T,t,0.5,0.5,yes,\nL,l,0.5,0.5,yes,\n";
  CHECK(tables() == header + rest + "V,first,0.5,0.5,yes,\n");
  write_report(fresh, table_of("V", "second"), "## Variance\n\nw\n");
  CHECK(tables() == header + rest + "V,second,0.5,0.5,yes,\n");

  comparisons rendered("direct_lighting");
  rendered.append(table_of("T", "image"));
  rendered.append(table_of("L", "image"));
  write_report(fresh, rendered, "## Direct lighting\n\nd");
  write_report(fresh, table_of("V", "third"), "## Variance\n\nx\n");
  write_report(fresh, rendered, "## Direct lighting\n\ne");
  CHECK(tables() == header + rest + "V,third,0.5,0.5,yes,\nT,image,0.5,0.5,yes,\nL,image,0.5,0.5,yes,\n");

  const std::string sections =
      "\n## Tsallis\n\nt\n\n## Linear\n\nl\n\n## Variance\n\nx\n\n## Direct lighting\n\ne\n";
  CHECK(page().find("# Reproduction\n\nMade by `sh examples/reproduce.sh`") == 0);
  CHECK(page().size() > sections.size());
  CHECK(page().substr(page().size() - sections.size()) == sections);
  std::filesystem::remove_all(folder.path());
}

TEST_CASE("A program ends with 1 where a row does not agree as it should") {
  comparisons table("L");
  table.number("right", "0.5", 0.5);
  table.number("wrong, and known to be", "0.5", 0.7, 0, papers::expectation::differs, "a reason");
  CHECK(papers::conclude("test", table) == 0);
  table.number("right, but believed wrong", "0.5", 0.5, 0, papers::expectation::differs, "a reason");
  CHECK(papers::conclude("test", table) == 1);
}
