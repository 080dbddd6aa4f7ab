// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_PAPERS_TSALLIS_DATA_HPP
#define PHIMIS_TESTS_PAPERS_TSALLIS_DATA_HPP

#include <papers/tsallis_problems.hpp>

#include <phimis/analysis/optimum.hpp>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace papers_test {

using fractions = phimis::fractions<double, 2>;
using problem = phimis::analysis::problem<2>;

/// The rows of a file of data/, by column name.
inline std::vector<std::map<std::string, std::string>> read_data(const std::string& file) {
  const auto path = std::filesystem::path(__FILE__).parent_path() / "data" / file;
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  const auto fields = [](const std::string& line) {
    std::vector<std::string> result;
    std::istringstream stream(line + ',');
    for (std::string field; std::getline(stream, field, ',');) result.push_back(field);
    return result;
  };
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = fields(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> values = fields(line);
    if (values.size() != names.size()) throw std::runtime_error(file + ": " + line);
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = values[i];
  }
  return rows;
}

inline double number(const std::string& field) { return std::stod(field); }

/// Example 1, 2 or 3 on exact integrals.
inline const problem& example(int number) {
  static const auto make = [](auto paper) { return problem(paper.f, paper.techniques(), paper.domain()); };
  static const problem all[] = {make(papers::tsallis_1{}), make(papers::tsallis_2{}), make(papers::tsallis_3{})};
  return all[number - 1];
}

/// Whether a computed value is the true one within the error that it claims and a few roundings.
inline bool within_error(const phimis::measured& computed, double truth, double scale) {
  return std::fabs(computed.value - truth) <= computed.error + 4e-16 * scale;
}

}  // namespace papers_test

#endif  // PHIMIS_TESTS_PAPERS_TSALLIS_DATA_HPP
