// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_COMPARISON_HPP
#define PHIMIS_EXAMPLES_PAPERS_COMPARISON_HPP

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

// Printed numbers beside computed ones.

namespace papers {

/// Whether a printed number is right, and how.
enum class agreement { rounded, cut, none };

/// What is known to be wrong in a paper is expected to differ.
enum class expectation { agrees, differs };

/// A number with a given count of decimals, never "-0".
inline std::string with_decimals(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  const std::string result = text;
  return result.find_first_not_of("-0.") == std::string::npos && result[0] == '-' ? result.substr(1) : result;
}

inline std::string with_digits(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

/// Compares as many decimals as are printed: rounded, or else with the last digit cut.
///
/// A printed "0" without decimals means zero: the computed value must be zero within the error of its computation.
inline agreement compare(const std::string& printed, double computed, double error = 0) {
  if (printed == "0") return std::fabs(computed) <= error ? agreement::rounded : agreement::none;
  const auto point = printed.find('.');
  const int decimals = point == std::string::npos ? 0 : static_cast<int>(printed.size() - point - 1);
  if (with_decimals(computed, decimals) == printed) return agreement::rounded;
  const double scale = std::pow(10, decimals);
  return with_decimals(std::trunc(computed * scale) / scale, decimals) == printed ? agreement::cut : agreement::none;
}

struct comparison {
  std::string paper;
  std::string item;
  std::string printed;
  std::string computed;
  agreement found;
  expectation expected;
  std::string note;

  std::string agrees() const {
    return found == agreement::rounded ? "yes" : found == agreement::cut ? "yes (last digit cut)" : "no";
  }
  bool as_expected() const { return (found != agreement::none) == (expected == expectation::agrees); }
};

/// The table of one paper, or of one part of the report with rows of several.
class comparisons {
 public:
  explicit comparisons(std::string paper) : paper_(std::move(paper)) {}

  void number(const std::string& item, const std::string& printed, double computed, double error = 0,
              expectation expected = expectation::agrees, const std::string& note = "") {
    const std::string zero =
        printed == "0" ? "zero within the error of the computation, " + with_digits(error, 1) : "";
    rows_.push_back({paper_, item, printed, with_digits(computed, 12), compare(printed, computed, error), expected,
                     note + (note.empty() || zero.empty() ? "" : "; ") + zero});
  }

  /// A statement, and whether the computation bears it out.
  void statement(const std::string& item, const std::string& printed, const std::string& computed, bool holds,
                 expectation expected = expectation::agrees, const std::string& note = "") {
    rows_.push_back({paper_, item, printed, computed, holds ? agreement::rounded : agreement::none, expected, note});
  }

  /// Adds the rows of another paper.
  void append(const comparisons& other) { rows_.insert(rows_.end(), other.rows_.begin(), other.rows_.end()); }

  const std::string& paper() const noexcept { return paper_; }
  const std::vector<comparison>& rows() const noexcept { return rows_; }

  /// paper,item,printed,computed,agrees,note
  std::string csv() const {
    std::string text = "paper,item,printed,computed,agrees,note\n";
    for (const comparison& row : rows_) {
      text += field(row.paper) + ',' + field(row.item) + ',' + field(row.printed) + ',' + field(row.computed) + ',' +
              field(row.agrees()) + ',' + field(row.note) + '\n';
    }
    return text;
  }

  std::string markdown() const {
    std::string text = "| where | printed | computed | agrees | note |\n|---|---|---|---|---|\n";
    for (const comparison& row : rows_) {
      text += '|';
      for (const std::string& cell : {row.item, row.printed, row.computed, row.agrees(), row.note}) {
        text += ' ';
        for (const char c : cell) text += c == '|' ? std::string("\\|") : std::string(1, c);
        text += " |";
      }
      text += '\n';
    }
    return text;
  }

 private:
  static std::string field(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) {
      result += c;
      if (c == '"') result += c;
    }
    return result + '"';
  }

  std::string paper_;
  std::vector<comparison> rows_;
};

/// A row of which noise may decide: `z` standard errors are between it and the edge of agreement, below 0 beyond it.
///
/// What three of them could turn is as expected either way. The note is for what does not agree.
inline void add_noisy(comparisons& table, const std::string& item, const std::string& printed,
                      const std::string& computed, double z, expectation expected, const std::string& note) {
  const bool agrees = z >= 0;
  const bool chance = std::fabs(z) <= 3;
  const std::string why = expected == expectation::differs ? note
                          : chance                         ? "noise: three standard errors reach what agrees"
                                                           : "";
  if (chance) expected = agrees ? expectation::agrees : expectation::differs;
  table.statement(item, printed, computed, agrees, expected, agrees ? "" : why);
}

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_COMPARISON_HPP
