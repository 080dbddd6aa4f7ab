// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_FUZZ_STREAM_HPP
#define PHIMIS_TESTS_FUZZ_STREAM_HPP

#include "bytes.hpp"
#include "invariants.hpp"

#include <phimis/core/divergence.hpp>

/// Nothing but what holds of every rule.
struct nothing_more {
  template <class Rule, class Fractions>
  void operator()(const Rule&, const Fractions&) const {}
};

/// Updates a rule, and demands what holds after every update: of all rules, and more(rule, fractions before).
template <class Rule, class More>
void update(Rule& rule, const More& more) {
  const auto before = rule.fractions();
  rule.update();
  byte_source::tell("update to ", rule.fractions(), "status ", static_cast<int>(rule.status()));
  demand(invariants::wrong_update(rule, before));
  more(rule, before);
}

/// The rest of the bytes as what a rule meets: observations, of its own and of others that are merged, and updates.
template <class Rule, class More = nothing_more>
void run_stream(Rule rule, byte_source& bytes, const More& more = {}) {
  using Real = typename Rule::real;
  constexpr int M = Rule::techniques;
  demand(invariants::off_simplex(rule.fractions(), rule.options()));
  Rule other = rule;
  while (!bytes.empty()) {
    const int what = bytes.below(16);
    if (what == 0) {
      update(rule, more);
      // What is merged was observed at the same fractions.
      typename Rule::state_type fresh{};
      fresh.fractions = rule.fractions();
      other.resume(fresh);
    } else if (what == 1) {
      byte_source::tell("merge");
      rule.merge(other);
    } else {
      if (what == 2) byte_source::tell("to be merged:");
      (what == 2 ? other : rule).observe(bytes.template observation<Real, M>());
    }
  }
  update(rule, more);
  update(rule, more);
}

/// A divergence of the power family, forward: γ from a byte, ½, 1, 2 and their neighbours among them.
inline phimis::tsallis any_tsallis(byte_source& bytes) {
  constexpr double orders[] = {0.5, 1, 2, 0.1, 0.7, 1.5, 3, 8, 1 + 1e-9, 0.01};
  const double gamma = orders[bytes.below(10)];
  byte_source::tell("gamma ", gamma);
  return {gamma};
}

/// k, with a kink and without.
inline phimis::pearson_vajda any_pearson_vajda(byte_source& bytes) {
  constexpr double orders[] = {2, 1, 1.5, 3, 2.5, 4};
  const double k = orders[bytes.below(6)];
  byte_source::tell("k ", k);
  return {k};
}

#endif  // PHIMIS_TESTS_FUZZ_STREAM_HPP
