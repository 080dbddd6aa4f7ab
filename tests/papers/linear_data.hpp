// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_PAPERS_LINEAR_DATA_HPP
#define PHIMIS_TESTS_PAPERS_LINEAR_DATA_HPP

#include "tsallis_data.hpp"

#include <papers/linear_problems.hpp>

#include <phimis/analysis/optimum.hpp>

#include <map>
#include <string>

namespace papers_test {

/// Calls receive(problem) with example 4, 5 or 6 of the linear heuristic's paper on exact integrals.
template <class Receiver>
void with_linear_example(int number, const Receiver& receive) {
  static const auto make = [](auto paper) {
    return phimis::analysis::problem(paper.f, paper.techniques(), paper.domain());
  };
  static const auto fourth = make(papers::linear_4{});
  static const auto fifth = make(papers::linear_5{});
  static const auto sixth = make(papers::linear_6{});
  if (number == 4) return receive(fourth);
  if (number == 5) return receive(fifth);
  if (number == 6) return receive(sixth);
  throw std::runtime_error("no example " + std::to_string(number));
}

/// The columns alpha_1, alpha_2, ... of a row.
template <int M>
phimis::fractions<double, M> alphas(const std::map<std::string, std::string>& row) {
  phimis::fractions<double, M> alpha{};
  for (int k = 0; k < M; ++k) alpha[k] = number(row.at("alpha_" + std::to_string(k + 1)));
  return alpha;
}

/// Whether fractions are those of a reference; what is exactly 0 there must be so here.
template <int M>
bool same_fractions(const phimis::fractions<double, M>& ours, const phimis::fractions<double, M>& truth,
                    double tolerance) {
  for (int k = 0; k < M; ++k) {
    if (!(std::fabs(ours[k] - truth[k]) <= (truth[k] == 0 ? 0 : tolerance))) return false;
  }
  return true;
}

}  // namespace papers_test

#endif  // PHIMIS_TESTS_PAPERS_LINEAR_DATA_HPP
