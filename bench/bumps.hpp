// SPDX-License-Identifier: MIT
#ifndef PHIMIS_BENCH_BUMPS_HPP
#define PHIMIS_BENCH_BUMPS_HPP

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

/// Observations f[n], pdfs[n × m], q[n] for those who look for the best fractions.
struct problem {
  Eigen::VectorXd f;
  Eigen::MatrixXd pdfs;
  Eigen::VectorXd q;
};

/// m Gaussian bumps on [0, 1]; f is a mixture of a third of them times a smooth factor; x are drawn from the equal
/// mixture.
inline problem some_problem(int n, int m, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  const auto size = static_cast<std::size_t>(m);
  std::vector<double> centre(size), width(size), mass(size), share(size);
  for (std::size_t k = 0; k < size; ++k) {
    centre[k] = uniform(engine);
    width[k] = 0.02 * std::pow(15, uniform(engine));
    const double root = width[k] * std::sqrt(2.0);
    mass[k] = (std::erf((1 - centre[k]) / root) + std::erf(centre[k] / root)) / 2;
    share[k] = uniform(engine) < 1.0 / 3 ? uniform(engine) : 0;
  }
  share[static_cast<std::size_t>(engine() % size)] += 0.5;
  const double phase = 6 * uniform(engine);
  problem on{Eigen::VectorXd(n), Eigen::MatrixXd(n, m), Eigen::VectorXd(n)};
  for (int j = 0; j < n; ++j) {
    const auto from = static_cast<std::size_t>(engine() % size);
    double x = -1;
    while (x < 0 || x > 1) x = centre[from] + width[from] * normal(engine);
    on.f[j] = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const double z = (x - centre[k]) / width[k];
      const double pdf = std::exp(-z * z / 2) / (2.5066282746310002 * width[k] * mass[k]);
      on.pdfs(j, static_cast<int>(k)) = pdf;
      on.f[j] += share[k] * pdf;
    }
    on.f[j] *= std::exp(0.5 * std::sin(9 * x + phase));
  }
  on.q = on.pdfs.rowwise().mean();
  return on;
}

#endif  // PHIMIS_BENCH_BUMPS_HPP
