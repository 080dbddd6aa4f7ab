// SPDX-License-Identifier: MIT
// The rules that ask which technique drew a sample, or solve one system: fixed fractions, σ-proportional, inverse
// variance, second order, and the linear heuristic with each of its treatments.
#include "bytes.hpp"
#include "stream.hpp"

#include <phimis/core/weight_heuristic.hpp>
#include <phimis/solver/rules.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace {

template <class Make>
void learn(const Make& make, byte_source& bytes) {
  std::optional<decltype(make())> rule;
  if (accepts([&] { rule.emplace(make()); })) run_stream(*rule, bytes);
}

template <class Real, int M>
void learn(byte_source& bytes) {
  using phimis::negative_fractions;
  const int which = bytes.below(M > 1 ? 8 : 5);  // the linear heuristic has no equations of one technique
  const auto options = bytes.options<Real, M>();
  switch (which) {
    case 0: {
      // Whatever the floors: they are those that its start respects.
      auto plain = options;
      plain.floors = {};
      return learn([&] { return phimis::fixed_rule<M>(plain); }, bytes);
    }
    case 1:
      return learn([&] { return phimis::sigma_rule<M>(options); }, bytes);
    case 2:
      return learn([&] { return phimis::sigma_rule<M>(options, phimis::power{2}); }, bytes);
    case 3:
      return learn([&] { return phimis::inverse_variance_rule<M>(options); }, bytes);
    case 4:
      return learn([&] { return phimis::second_order_rule<M>(options); }, bytes);
    default:
      break;
  }
  if constexpr (M > 1) {
    if (which == 5) {
      learn([&] { return phimis::linear_rule<M, negative_fractions::project, Real>(options); }, bytes);
    } else if (which == 6) {
      learn([&] { return phimis::linear_rule<M, negative_fractions::drop_most_negative, Real>(options); }, bytes);
    } else {
      learn([&] { return phimis::linear_rule<M, negative_fractions::best_face, Real>(options); }, bytes);
    }
  }
}

template <class Real>
void learn(byte_source& bytes) {
  switch (bytes.below(4)) {
    case 0:
      return learn<Real, 1>(bytes);
    case 1:
      return learn<Real, 2>(bytes);
    case 2:
      return learn<Real, 3>(bytes);
    default:
      return learn<Real, 5>(bytes);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  byte_source bytes(data, size);
  if (bytes.below(2) == 0) {
    learn<double>(bytes);
  } else {
    learn<float>(bytes);
  }
  return 0;
}
