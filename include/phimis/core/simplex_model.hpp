// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_SIMPLEX_MODEL_HPP
#define PHIMIS_CORE_SIMPLEX_MODEL_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>

#include <cmath>

namespace phimis::detail {

/// The quadratic model of an objective on the simplex, and the step to its minimum.
///
///     min_d ½ d'Hd − e'd,   θ + d ≥ 0,   Σ d = 0,   e_k = G_k − ν
///
/// Coordinates that the minimum would make negative are dropped, dropped ones with a positive multiplier are taken back,
/// first all at once, then one by one. H + δ diag(H) is factorised, δ raised from where it is trusted until it is
/// positive definite: duplicate, flat and dependent coordinates leave it solvable.
///
/// Source  block pivoting: Portugal, Júdice & Vicente 1994.
/// Shapes  hessian[size][size], theta[size], excess[size], step[size].
class simplex_model {
 public:
  PHIMIS_HOST_DEVICE static constexpr int doubles(int m) noexcept { return (m + 3) * m; }

  PHIMIS_HOST_DEVICE simplex_model(int m, double* memory, int* indices) noexcept
      : rhs_(memory), ones_(rhs_ + m), scale_(ones_ + m), factor_(scale_ + m), free_(indices) {}

  /// Keeps H, and takes each coordinate in the scale of its own curvature; a flat one in that of the most curved.
  PHIMIS_HOST_DEVICE void keep(const double* hessian, int size) noexcept {
    hessian_ = hessian;
    size_ = size;
    double most_curved = 0;
    for (int a = 0; a < size; ++a) {
      const double curvature = std::fabs(hessian[a * size + a]);
      if (curvature > most_curved && is_finite(curvature)) most_curved = curvature;
    }
    if (!(most_curved > 0)) most_curved = 1;
    for (int a = 0; a < size; ++a) {
      const double curvature = std::fabs(hessian[a * size + a]);
      scale_[a] = 1 / std::sqrt(is_finite(1 / curvature) && is_finite(curvature) ? curvature : most_curved);
    }
  }

  /// False where the step does not descend. `rounding` is the size of e that means nothing.
  PHIMIS_HOST_DEVICE bool step(const double* theta, const double* excess, double rounding, double delta,
                               double* step) noexcept {
    constexpr int block_passes = 8;
    count_ = 0;
    for (int a = 0; a < size_; ++a) free_[count_++] = a;
    for (int pass = 0; pass < block_passes + 3 * size_; ++pass) {
      const bool single = pass >= block_passes;
      double multiplier = 0;
      if (count_ == 0 || !solve_free(theta, excess, delta, step, multiplier)) return false;
      if (!drop(theta, single, step) && !take_back(excess, multiplier, rounding, single, step)) break;
    }
    double slope = 0;
    for (int a = 0; a < size_; ++a) {
      if (step[a] < -theta[a]) step[a] = -theta[a];
      slope += step[a] * excess[a];
    }
    return slope > 0;
  }

 private:
  /// (H_FF + δ) d_F = e_F − H_FD d_D − multiplier with the others going to 0.
  PHIMIS_HOST_DEVICE bool solve_free(const double* theta, const double* excess, double delta, double* d,
                                     double& multiplier) noexcept {
    for (int a = 0; a < size_; ++a) d[a] = -theta[a];
    for (int i = 0; i < count_; ++i) d[free_[i]] = 0;
    double moved = 0;
    for (int a = 0; a < size_; ++a) moved += d[a];
    for (int i = 0; i < count_; ++i) {
      const int a = free_[i];
      rhs_[i] = (excess[a] - times(a, d)) * scale_[a];
      ones_[i] = scale_[a];
    }
    while (!factorise(delta)) {
      delta *= delta < 1e-3 ? 1000 : 3;  // rounding needs little, a model that is not convex some
      if (delta > 1e30) return false;
    }
    solve(rhs_);
    solve(ones_);
    double sum = 0;
    double total = 0;
    for (int i = 0; i < count_; ++i) {
      sum += rhs_[i] * scale_[free_[i]];
      total += ones_[i] * scale_[free_[i]];
    }
    multiplier = (sum + moved) / total;
    for (int i = 0; i < count_; ++i) d[free_[i]] = (rhs_[i] - multiplier * ones_[i]) * scale_[free_[i]];
    return is_finite(multiplier);
  }

  /// Σ_b H_ab d_b
  PHIMIS_HOST_DEVICE double times(int a, const double* d) const noexcept {
    double sum = 0;
    for (int b = 0; b < size_; ++b) {
      if (d[b] != 0) sum += hessian_[a * size_ + b] * d[b];
    }
    return sum;
  }

  /// Whether coordinates that would be negative were dropped: all, or the most negative.
  PHIMIS_HOST_DEVICE bool drop(const double* theta, bool single, const double* d) noexcept {
    int worst = -1;
    for (int i = 0; i < count_; ++i) {
      const int a = free_[i];
      if (theta[a] + d[a] < (worst < 0 ? 0 : theta[worst] + d[worst])) worst = a;
    }
    if (worst < 0) return false;
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      const int a = free_[i];
      if (single ? a != worst : !(theta[a] + d[a] < 0)) free_[kept++] = a;
    }
    count_ = kept;
    return true;
  }

  /// Whether dropped coordinates that the model would raise were taken back: all, or the one it would raise most.
  PHIMIS_HOST_DEVICE bool take_back(const double* excess, double multiplier, double rounding, bool single,
                                    const double* d) noexcept {
    const int before = count_;
    int best = -1;
    double most_wanted = 0;
    for (int a = 0; a < size_; ++a) {
      bool is_free = false;
      for (int i = 0; i < before && !is_free; ++i) is_free = free_[i] == a;
      if (is_free) continue;
      const double wish = excess[a] - multiplier - times(a, d);
      if (!(wish > rounding)) continue;
      if (!single) {
        free_[count_++] = a;
      } else if (wish * scale_[a] > most_wanted) {
        most_wanted = wish * scale_[a];
        best = a;
      }
    }
    if (best >= 0) free_[count_++] = best;
    return count_ > before;
  }

  /// Cholesky's factor of the free part, in scale, row by row.
  PHIMIS_HOST_DEVICE bool factorise(double delta) noexcept {
    for (int i = 0; i < count_; ++i) {
      const int a = free_[i];
      double* const row = factor_ + i * size_;
      for (int j = 0; j <= i; ++j) {
        const int b = free_[j];
        const double* const other = factor_ + j * size_;
        double value = hessian_[a * size_ + b] * scale_[a] * scale_[b] + (i == j ? delta : 0);
        for (int l = 0; l < j; ++l) value -= row[l] * other[l];
        if (i != j) {
          row[j] = value / other[j];
        } else if (value > delta / 16 && is_finite(value)) {
          row[i] = std::sqrt(value);
        } else {
          return false;
        }
      }
    }
    return true;
  }

  PHIMIS_HOST_DEVICE void solve(double* x) const noexcept {
    for (int i = 0; i < count_; ++i) {
      for (int l = 0; l < i; ++l) x[i] -= factor_[i * size_ + l] * x[l];
      x[i] /= factor_[i * size_ + i];
    }
    for (int i = count_ - 1; i >= 0; --i) {
      for (int l = i + 1; l < count_; ++l) x[i] -= factor_[l * size_ + i] * x[l];
      x[i] /= factor_[i * size_ + i];
    }
  }

  const double* hessian_ = nullptr;
  int size_ = 0;
  int count_ = 0;
  double* rhs_;
  double* ones_;
  double* scale_;  // of each coordinate: 1/√H_aa
  double* factor_;
  int* free_;
};

}  // namespace phimis::detail

#endif  // PHIMIS_CORE_SIMPLEX_MODEL_HPP
