// SPDX-License-Identifier: MIT
// The rules that keep sums of powers: Newton–Raphson of two techniques, and its kin of many.
#include "bytes.hpp"
#include "stream.hpp"

#include <phimis/solver/rules.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace {

/// make(): a rule, of whatever options it takes.
template <class Make>
void learn(const Make& make, byte_source& bytes) {
  std::optional<decltype(make())> rule;
  if (accepts([&] { rule.emplace(make()); })) run_stream(*rule, bytes);
}

template <class Real, class Divergence>
void learn_newton(const Divergence& divergence, byte_source& bytes) {
  const auto options = bytes.options<Real, 2>();
  const auto form = bytes.below(2) == 0 ? phimis::newton_form::safeguarded : phimis::newton_form::paper;
  learn([&] { return phimis::newton_rule<Divergence, Real>(divergence, form, options); }, bytes);
}

template <class Real, int M, class Divergence>
void learn_streaming(const Divergence& divergence, byte_source& bytes) {
  const auto options = bytes.options<Real, M>();
  const auto retention = bytes.unit<Real>();
  learn([&] { return phimis::streaming_rule<M>(divergence, options, retention); }, bytes);
}

template <class Real>
void learn(byte_source& bytes) {
  using phimis::reversed;
  using phimis::tsallis;
  const auto streaming = [&](const auto& divergence) {
    switch (bytes.below(3)) {
      case 0:
        return learn_streaming<Real, 2>(divergence, bytes);
      case 1:
        return learn_streaming<Real, 3>(divergence, bytes);
      default:
        return learn_streaming<Real, 5>(divergence, bytes);
    }
  };
  switch (bytes.below(5)) {
    case 0:
      return learn_newton<Real>(any_tsallis(bytes), bytes);
    case 1:
      return learn_newton<Real>(reversed<tsallis>{any_tsallis(bytes)}, bytes);
    case 2:
      return streaming(any_tsallis(bytes));
    case 3:
      return streaming(reversed<tsallis>{any_tsallis(bytes)});
    default:
      return streaming(phimis::multi_sample_variance{});
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
