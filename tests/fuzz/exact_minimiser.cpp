// SPDX-License-Identifier: MIT
// The exact minimiser of every family of divergences: the objective, too, is never above that at the fractions before.
#include "bytes.hpp"
#include "stream.hpp"

#include <phimis/core/exact_minimiser.hpp>
#include <phimis/core/table.hpp>
#include <phimis/solver/rules.hpp>

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace {

using phimis::control_variate;
using phimis::rule_status;

template <class Real, int M, class Divergence>
void learn(const Divergence& divergence, byte_source& bytes) {
  const auto options = bytes.options<Real, M>();
  const auto variate = bytes.below(2) == 0 ? control_variate::on : control_variate::off;
  if (!accepts([&] { phimis::exact_rule<M>(divergence, options, variate); })) return;
  // Small, so that it is full now and then.
  using rule_type = phimis::exact_minimiser<Divergence, phimis::fixed_table<Real, M, 40>>;
  const auto more = [&](const rule_type& rule, const phimis::fractions<Real, M>& before) {
    if constexpr (!std::is_same_v<Divergence, phimis::multi_sample_variance>) {
      const bool local = phimis::detail::is_variance<Divergence>::value && rule.gap() == phimis::infinity<double>;
      const bool updated = rule.status() == rule_status::updated;
      if (local || (!updated && rule.status() != rule_status::not_converged)) return;
      // Without a certificate it has descended all the same, as far as a kink is rounded off.
      const double gap = updated ? rule.gap() : sizeof(Real) == 8 ? 1e-6 : 1e-3;
      const auto view = rule.table().view();
      const phimis::column_pointers<Real> columns{view.u, view.w, view.y, view.n, M};
      const invariants::objective<Divergence, Real> on(divergence, invariants::rows(columns), options.start.value,
                                                       options.costs.value, options.prior, variate);
      demand(invariants::above_start<Real>(on, rule.fractions().value, before.value, gap));
    }
  };
  run_stream(rule_type(divergence, options, variate), bytes, more);
}

template <class Real, int M>
void learn(byte_source& bytes) {
  using phimis::reversed;
  switch (bytes.below(8)) {
    case 0:
      return learn<Real, M>(any_tsallis(bytes), bytes);
    case 1:
      return learn<Real, M>(reversed<phimis::tsallis>{any_tsallis(bytes)}, bytes);
    case 2:
      return learn<Real, M>(phimis::one_sample_variance{}, bytes);
    case 3:
      return learn<Real, M>(phimis::multi_sample_variance{}, bytes);
    case 4:
      return learn<Real, M>(phimis::total_variation{}, bytes);
    case 5:
      return learn<Real, M>(any_pearson_vajda(bytes), bytes);
    case 6:
      return learn<Real, M>(reversed<phimis::pearson_vajda>{any_pearson_vajda(bytes)}, bytes);
    default:
      return learn<Real, M>(reversed<phimis::kullback_leibler>{}, bytes);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  byte_source bytes(data, size);
  switch (bytes.below(6)) {
    case 0:
      learn<double, 2>(bytes);
      break;
    case 1:
      learn<double, 3>(bytes);
      break;
    case 2:
      learn<double, 5>(bytes);
      break;
    case 3:
      learn<float, 2>(bytes);
      break;
    case 4:
      learn<float, 3>(bytes);
      break;
    default:
      learn<float, 5>(bytes);
  }
  return 0;
}
