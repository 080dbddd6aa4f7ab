// SPDX-License-Identifier: MIT
// How much memory does a rule take, and how much `minimise`? Two Markdown tables on standard output: bytes of a state, and
// the most that was resident while a million observations of sixteen techniques were solved, over their own size.

#include <phimis/core.hpp>
#include <phimis/solver/minimise.hpp>
#include <phimis/solver/rules.hpp>

#include <Eigen/Core>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

template <class Rule>
void row(const char* name, const char* real) {
  std::printf("| %s | %s | %d | %zu | %zu |\n", name, real, Rule::techniques, sizeof(typename Rule::state_type),
              sizeof(Rule));
}

template <class Real, int M>
void rows(const char* real) {
  using phimis::negative_fractions;
  if constexpr (M == 2) row<phimis::newton_raphson<phimis::tsallis, Real>>("newton_raphson", real);
  row<phimis::streaming_newton<phimis::tsallis, Real, M>>("streaming_newton", real);
  row<phimis::streaming_newton<phimis::multi_sample_variance, Real, M>>("streaming_newton, V[F]", real);
  row<phimis::linear_heuristic<Real, M, negative_fractions::drop_most_negative>>("linear_heuristic, drop", real);
  row<phimis::linear_heuristic<Real, M, negative_fractions::project>>("linear_heuristic, project", real);
  row<phimis::second_order<Real, M>>("second_order", real);
  row<phimis::sigma_proportional<Real, M>>("sigma_proportional", real);
  row<phimis::inverse_variance_fractions<Real, M>>("inverse_variance_fractions", real);
  row<phimis::fixed_fractions<Real, M>>("fixed_fractions", real);
}

/// A field of /proc/self/status, in bytes; 0 where there is none.
double status(const char* field) {
  std::FILE* file = std::fopen("/proc/self/status", "r");
  double kilobytes = 0;
  char line[256];
  while (file != nullptr && std::fgets(line, sizeof line, file) != nullptr) {
    if (std::strncmp(line, field, std::strlen(field)) == 0) kilobytes = std::atof(line + std::strlen(field) + 1);
  }
  if (file != nullptr) std::fclose(file);
  return 1024 * kilobytes;
}

void solve(const char* data, bool copied) {
  constexpr int n = 1000000;
  constexpr int m = 16;
  Eigen::VectorXd f(n);
  Eigen::MatrixXd pdfs(n, m);
  for (int j = 0; j < n; ++j) {
    const double x = (j + 0.5) / n;
    for (int k = 0; k < m; ++k) {
      const double z = (x - (k + 0.5) / m) * m / (1 + k % 3);
      pdfs(j, k) = std::exp(-z * z / 2);
    }
    f[j] = 1 + x * x;
  }
  const Eigen::VectorXd q = Eigen::VectorXd::Ones(n);
  if (copied) f[0] = -1;  // its sign makes no row of it
  const double before = status("VmRSS:");
  const auto found = phimis::minimise(phimis::kullback_leibler{}, f, pdfs, q);
  const double numbers = static_cast<double>(n) * (m + 2) * sizeof(double);
  std::printf("| %s | %d | %d | %.0f | %.0f | %.2f | %d |\n", data, n, m, numbers / 1e6,
              (status("VmHWM:") - before) / 1e6, (status("VmHWM:") - before) / numbers, found.evaluations);
}

}  // namespace

int main() {
  std::puts("| rule | real | m | state, bytes | rule, bytes |");
  std::puts("|---|---|---|---|---|");
  rows<float, 2>("float");
  rows<double, 2>("double");
  rows<float, 5>("float");
  rows<double, 5>("double");
  rows<double, 16>("double");
  std::puts("");
  std::puts("| minimise | n | m | data, MB | besides, at most, MB | of the data | evaluations |");
  std::puts("|---|---|---|---|---|---|---|");
  solve("rows where they lie", false);
  solve("rows copied", true);
}
