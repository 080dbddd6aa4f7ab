// SPDX-License-Identifier: MIT
// The solver on tables of any numbers and shapes, and the joint minimiser with control variates.
#include "bytes.hpp"
#include "invariants.hpp"
#include "stream.hpp"

#include <phimis/divergence/phi_divergence.hpp>
#include <phimis/solver/joint_minimiser.hpp>
#include <phimis/solver/minimise.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using phimis::rule_status;

VectorXd densities(byte_source& bytes, Eigen::Index size) {
  VectorXd values(size);
  for (double& value : values) value = bytes.density<double>();
  return values;
}

/// The rows that minimise makes of a table.
struct table_of_rows {
  std::vector<double> u, w;
  std::vector<std::vector<double>> y;

  table_of_rows(const VectorXd& f, const MatrixXd& pdfs, const VectorXd& q) : y(static_cast<std::size_t>(pdfs.cols())) {
    for (Eigen::Index j = 0; j < f.size(); ++j) {
      const VectorXd row = pdfs.row(j);
      VectorXd shares(row.size());
      double of_u = 0;
      double of_w = 0;
      if (!phimis::to_row(f[j], row.data(), static_cast<int>(row.size()), q[j], of_u, of_w, shares.data())) continue;
      u.push_back(of_u);
      w.push_back(of_w);
      for (std::size_t k = 0; k < y.size(); ++k) y[k].push_back(shares[static_cast<Eigen::Index>(k)]);
    }
  }

  invariants::rows rows() const {
    std::vector<const double*> columns;
    for (const auto& column : y) columns.push_back(column.data());
    return invariants::rows(phimis::column_pointers<double>{
        u.data(), w.data(), columns.data(), static_cast<std::ptrdiff_t>(u.size()), static_cast<int>(y.size())});
  }
};

template <class Divergence>
void solve(const Divergence& divergence, byte_source& bytes) {
  const Eigen::Index n = 1 + bytes.below(70);
  const Eigen::Index m = 1 + bytes.below(6);
  const int given = bytes.byte();
  phimis::minimise_options options;
  options.variate = (given & 1) != 0 ? phimis::control_variate::off : phimis::control_variate::on;
  if ((given & 2) != 0) {
    options.start = densities(bytes, m);
    options.start /= options.start.sum();
  }
  if ((given & 4) != 0) {
    options.floors = densities(bytes, m);
    options.floors *= bytes.unit<double>() / options.floors.sum();
  }
  if ((given & 8) != 0) options.costs = densities(bytes, m);
  if ((given & 16) != 0) options.prior = bytes.number<double>();
  if ((given & 32) != 0) options.frozen = {bytes.below(8) - 1, bytes.below(8)};
  VectorXd f(n);
  MatrixXd pdfs(n, m);
  VectorXd q(n);
  const bool any = (given & 64) != 0;
  const auto one = [&] { return any ? bytes.number<double>() : bytes.density<double>(); };
  for (Eigen::Index j = 0; j < n; ++j) {
    f[j] = one();
    for (Eigen::Index k = 0; k < m; ++k) pdfs(j, k) = one();
    q[j] = (given & 128) != 0 ? one() : pdfs.row(j).mean();
  }

  phimis::minimum found;
  if (!accepts([&] { found = phimis::minimise(divergence, f, pdfs, q, options); })) return;
  const auto or_all = [m](const VectorXd& values, double otherwise) {
    return values.size() > 0 ? values : VectorXd::Constant(m, otherwise);
  };
  const auto span = [](const VectorXd& values) {
    return std::span<const double>(values.data(), static_cast<std::size_t>(values.size()));
  };
  const VectorXd start = or_all(options.start, 1.0 / static_cast<double>(m));
  const VectorXd floors = or_all(options.floors, 0);
  const VectorXd costs = or_all(options.costs, 1);
  const auto frozen = std::make_unique<bool[]>(static_cast<std::size_t>(m));
  for (const int k : options.frozen) frozen[static_cast<std::size_t>(k)] = true;
  const std::span<const bool> held(frozen.get(), static_cast<std::size_t>(m));
  byte_source::tell("n ", n, ", m ", m, ", status ", static_cast<int>(found.status), "\nf ", f.transpose(), "\nq ",
                    q.transpose(), "\npdfs\n", pdfs, "\nstart ", start.transpose(), "\nfloors ", floors.transpose(),
                    "\ncosts ", costs.transpose(), "\nprior ", options.prior, ", variate ",
                    static_cast<int>(options.variate), "\nfractions ", found.fractions.transpose(), "\nresidual ",
                    found.residual, " gap ", found.gap);
  demand(invariants::off_simplex<double>(span(found.fractions), span(floors), span(start), held));
  // Nothing known, no move; but a start below its floors is raised to them.
  const bool told = found.status != rule_status::no_information && found.status != rule_status::infinite_divergence;
  if (!told && (start.array() >= floors.array()).all() && found.fractions != start) {
    demand(invariants::words("fractions left ", start.transpose(), " without information"));
  }
  if constexpr (requires { true_phi_at(divergence, real(1)); } || phimis::has_exponent<Divergence>::value) {
    if (found.status != rule_status::updated || found.gap == phimis::infinity<double>) return;
    // A start below its floors is raised to them: only one that is not is compared with.
    for (Eigen::Index k = 0; k < m; ++k) {
      if (!frozen[static_cast<std::size_t>(k)] && start[k] < floors[k]) return;
    }
    // Rows divide f by Σp: of a subnormal one nothing may be left where rows that lie in place still have it.
    if (std::any_of(f.begin(), f.end(), [](double v) { return v != 0 && !std::isnormal(v); })) return;
    const invariants::rows rows = table_of_rows(f, pdfs, q).rows();
    // A technique without density in the table has given up its fraction, which no term of the objective knows.
    bool given_up = false;
    for (Eigen::Index k = 0; k < m; ++k) {
      const auto& y = rows.y[static_cast<std::size_t>(k)];
      const bool silent = std::all_of(y.begin(), y.end(), [](auto share) { return !(share > 0); });
      if (silent && (pdfs.col(k).array() > 0).any()) return;  // so of a pdf
      if (!silent || frozen[static_cast<std::size_t>(k)] || (options.prior > 0 && start[k] > 0)) continue;
      given_up = true;
      if (found.fractions[k] != floors[k]) {
        demand(invariants::words("silent technique ", k, " has ", found.fractions[k], " for its floor ", floors[k]));
      }
    }
    if (given_up) return;
    const invariants::objective<Divergence, double> on(divergence, rows, span(start), span(costs), options.prior,
                                                       options.variate);
    demand(invariants::above_start<double>(on, span(found.fractions), span(start), found.gap));
  }
}

template <int M>
void solve_jointly(byte_source& bytes) {
  const auto options = bytes.options<double, M>();
  const auto variate = bytes.below(2) == 0 ? phimis::control_variate::on : phimis::control_variate::off;
  if (!accepts([&] { phimis::joint_rule<M>(options, variate); })) return;
  byte_source rest = bytes;
  phimis::joint_minimiser<M> rule(options, variate);
  for (int left = 40; !rest.empty() && left > 0; --left) rule.observe(rest.observation<double, M>());
  update(rule, nothing_more{});
  update(rule, nothing_more{});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  byte_source bytes(data, size);
  using phimis::reversed;
  switch (bytes.below(10)) {
    case 0:
      solve(any_tsallis(bytes), bytes);
      break;
    case 1:
      solve(reversed<phimis::tsallis>{any_tsallis(bytes)}, bytes);
      break;
    case 2:
      solve(phimis::one_sample_variance{}, bytes);
      break;
    case 3:
      solve(phimis::multi_sample_variance{}, bytes);
      break;
    case 4:
      solve(phimis::total_variation{}, bytes);
      break;
    case 5:
      solve(any_pearson_vajda(bytes), bytes);
      break;
    case 6:
      solve(reversed<phimis::pearson_vajda>{any_pearson_vajda(bytes)}, bytes);
      break;
    case 7:
      // Jensen–Shannon: a divergence of the user's own.
      solve(phimis::phi_divergence([](auto t) { return t * log(t) - (1 + t) * log((1 + t) / 2); }), bytes);
      break;
    case 8:
      solve_jointly<2>(bytes);
      break;
    default:
      solve_jointly<3>(bytes);
  }
  return 0;
}
