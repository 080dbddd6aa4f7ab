// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_FUZZ_BYTES_HPP
#define PHIMIS_TESTS_FUZZ_BYTES_HPP

#include <phimis/core/finite.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/observation.hpp>
#include <phimis/core/rule.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

/// Numbers, observations and options from the bytes of a fuzzer: zeros after their end.
class byte_source {
 public:
  byte_source(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool empty() const { return at_ >= size_; }
  int byte() { return empty() ? 0 : data_[at_++]; }
  int below(int n) { return byte() % n; }

  /// Any number. Its first byte says which:
  ///
  ///     0..191    1/64..3: plain numbers cost one byte
  ///     192..207  a special one
  ///     208..223  one of the last eight again: exact duplicates
  ///     224..239  a power of 2 of the next byte, from the least to the largest
  ///     240..255  the bits that follow
  template <class Real>
  Real number() {
    const int kind = byte();
    Real value = 0;
    if (kind < 192) {
      value = static_cast<Real>(kind + 1) / 64;
    } else if (kind < 208) {
      value = special<Real>(kind - 192);
    } else if (kind < 224) {
      return static_cast<Real>(last_[kind % 8]);
    } else if (kind < 240) {
      const int exponent = (byte() - 128) * (sizeof(Real) == 8 ? 8 : 1);
      value = std::ldexp(Real(1), exponent);
    } else {
      unsigned char bits[sizeof(Real)];
      for (unsigned char& one : bits) one = static_cast<unsigned char>(byte());
      std::memcpy(&value, bits, sizeof value);
    }
    last_[next_++ % 8] = static_cast<double>(value);
    return value;
  }

  /// A number that is finite and not negative.
  template <class Real>
  Real density() {
    const Real value = number<Real>();
    return phimis::is_finite(value) ? std::fabs(value) : Real(1);
  }

  /// In [0, 1].
  template <class Real>
  Real unit() {
    return static_cast<Real>(byte()) / 255;
  }

  /// Fractions in proportion to numbers; a budget for those with_floors refuses nothing.
  template <class Real, int M>
  phimis::fractions<Real, M> fractions() {
    phimis::per_technique<Real, M> shares{};
    for (int k = 0; k < M; ++k) shares[k] = density<Real>();
    return phimis::with_floors(shares, phimis::per_technique<Real, M>{});
  }

  /// One byte says what is drawn: 1 any number at all, 2 a density q of its own, the rest the technique.
  template <class Real, int M>
  phimis::observation<Real, M> observation() {
    const int how = byte();
    const bool any = (how & 1) != 0;
    phimis::observation<Real, M> sample{number<Real>(), {}, 0, (how >> 2) % M};
    Real mixture = 0;
    for (int k = 0; k < M; ++k) {
      sample.pdfs[k] = any ? number<Real>() : density<Real>();
      mixture += sample.pdfs[k] / M;
    }
    sample.q = (how & 2) != 0 ? (any ? number<Real>() : density<Real>()) : mixture;
    if (!any && !phimis::is_finite(sample.f)) sample.f = 1;
    tell("observation f ", sample.f, ", technique ", sample.technique, ", q ", sample.q, ", pdfs ", sample.pdfs);
    return sample;
  }

  /// Options, of which a byte says what is not the default. They may be out of range: `accepts` tells.
  template <class Real, int M>
  phimis::rule_options<Real, M> options() {
    phimis::rule_options<Real, M> result;
    const int given = byte();
    if ((given & 1) != 0) result.start = fractions<Real, M>();
    if ((given & 2) != 0) {
      const Real sum = unit<Real>();
      result.floors = fractions<Real, M>();
      for (int k = 0; k < M; ++k) result.floors[k] *= sum;
    }
    if ((given & 4) != 0) result.prior = density<Real>();
    for (int k = 0; k < M && (given & 8) != 0; ++k) result.costs[k] = density<Real>();
    if ((given & 16) != 0) {
      const int frozen = byte();
      for (int k = 0; k < M; ++k) result.frozen[k] = (frozen >> k & 1) != 0;
    }
    tell("options start ", result.start, ", floors ", result.floors, ", prior ", result.prior, ", costs ", result.costs,
         ", frozen ", result.frozen);
    return result;
  }

  /// With PHIMIS_FUZZ_TELL in the environment, what the bytes mean, to be made a test of.
  template <class... Parts>
  static void tell(const Parts&... parts) {
    static const bool wanted = std::getenv("PHIMIS_FUZZ_TELL") != nullptr;
    if (!wanted) return;
    std::ostringstream out;
    out.precision(17);
    (print(out, parts), ...);
    std::fprintf(stderr, "%s\n", out.str().c_str());
  }

 private:
  template <class Part>
  static void print(std::ostream& out, const Part& part) {
    out << part;
  }
  template <class Value, int M>
  static void print(std::ostream& out, const phimis::per_technique<Value, M>& values) {
    for (const Value value : values) out << value << ' ';
  }

  template <class Real>
  static Real special(int which) {
    using limits = std::numeric_limits<Real>;
    const Real numbers[16] = {0,
                              -Real(0),
                              limits::infinity(),
                              -limits::infinity(),
                              limits::quiet_NaN(),
                              limits::denorm_min(),
                              -limits::denorm_min(),
                              limits::min(),
                              limits::max(),
                              limits::lowest(),
                              limits::epsilon(),
                              1 + limits::epsilon(),
                              1 - limits::epsilon() / 2,
                              -1,
                              limits::max() / 2,
                              1 / limits::max()};
    return numbers[which];
  }

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
  double last_[8] = {};
  unsigned next_ = 0;
};

/// Whether a call takes its arguments: what it refuses is an std::invalid_argument, and no finding.
template <class Call>
bool accepts(const Call& call) {
  try {
    call();
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

/// Ends the fuzzer where an invariant is broken.
inline void demand(const std::string& broken) {
  if (broken.empty()) return;
  std::fprintf(stderr, "broken: %s\n", broken.c_str());
  std::abort();
}

#endif  // PHIMIS_TESTS_FUZZ_BYTES_HPP
