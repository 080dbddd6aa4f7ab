// SPDX-License-Identifier: MIT
// The split of a budget: shares with floors, frozen techniques, both roundings, and the pick of one technique.
#include "bytes.hpp"
#include "invariants.hpp"

#include <phimis/core/counts.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/uniform.hpp>
#include <phimis/validate.hpp>

#include <cstddef>
#include <cstdint>

namespace {

template <class Real, int M>
void split(byte_source& bytes) {
  const auto options = bytes.options<Real, M>();
  if (!accepts([&] { phimis::validate(options); })) return;
  phimis::per_technique<Real, M> shares{};
  for (int k = 0; k < M; ++k) shares[k] = bytes.density<Real>();
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i) bits = bits << 8 | static_cast<std::uint64_t>(bytes.byte());
  const double u = phimis::uniform(bits);
  // Largest remainder hands out what rounding of Σα leaves one by one: of a float, 1e-7 of the budget.
  const std::int64_t budget = static_cast<std::int64_t>(bits & 0xffffffff) >> bytes.below(32);
  byte_source::tell("shares ", shares, "budget ", budget, ", u ", u);

  const auto alpha = phimis::share_budget(shares, options);
  demand(invariants::off_simplex(alpha, options));
  demand(invariants::wrong_counts(phimis::split_largest_remainder(alpha, budget), alpha, budget));
  demand(invariants::wrong_counts(phimis::split_systematic(alpha, budget, u), alpha, budget));
  const int picked = phimis::pick_technique(alpha, u);
  demand(picked >= 0 && picked < M && alpha[picked] > 0 ? "" : "a technique without a fraction was picked");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  byte_source bytes(data, size);
  switch (bytes.below(8)) {
    case 0:
      split<double, 1>(bytes);
      break;
    case 1:
      split<double, 2>(bytes);
      break;
    case 2:
      split<double, 3>(bytes);
      break;
    case 3:
      split<double, 5>(bytes);
      break;
    case 4:
      split<float, 1>(bytes);
      break;
    case 5:
      split<float, 2>(bytes);
      break;
    case 6:
      split<float, 3>(bytes);
      break;
    default:
      split<float, 5>(bytes);
  }
  return 0;
}
