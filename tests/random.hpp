// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_RANDOM_HPP
#define PHIMIS_TESTS_RANDOM_HPP

#include <phimis/core/uniform.hpp>

#include <cmath>
#include <cstdint>

/// Random numbers for tests, the same on every platform: splitmix64 (Steele, Lea & Flood 2014).
class random_numbers {
 public:
  /// Seeds are scattered: neighbours must not be the same sequence one step apart.
  explicit random_numbers(std::uint64_t seed) : state_(scatter(~seed)) {}

  std::uint64_t bits() { return scatter(state_ += 0x9e3779b97f4a7c15u); }
  /// In [0, 1).
  double operator()() { return phimis::uniform(bits()); }
  double between(double lower, double upper) { return lower + (upper - lower) * (*this)(); }
  /// Log-uniform.
  double over_decades(double lower, double upper) { return lower * std::pow(upper / lower, (*this)()); }
  int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }

 private:
  static std::uint64_t scatter(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

#endif  // PHIMIS_TESTS_RANDOM_HPP
