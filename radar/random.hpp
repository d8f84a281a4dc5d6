#pragma once

#include <cstdint>
#include <string_view>

namespace dwell {

/// A stream of random numbers, named and forked: xoshiro256++ seeded by SplitMix64 of a 64-bit key.
///
/// Forking depends on the parent's key alone, never on how much was drawn from it, so one more draw in one part
/// does not shift the others, and policies are compared on common random numbers.
/// The draws are ours because the standard distributions differ between libraries.
///
/// Source  Blackman, Vigna (2021), "Scrambled linear pseudorandom number generators"; Steele, Lea, Flood (2014).
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed);

  RandomStream fork(std::string_view name) const;
  RandomStream fork(std::uint64_t number) const;

  std::uint64_t bits();
  /// [0, 1), 53 bits.
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// N(0, 1), by Box and Muller; two uniforms a pair, the second normal is kept.
  double normal();
  /// Poisson with the given mean >= 0, by products of uniforms in pieces of at most 500. O(mean).
  int poisson(double mean);

 private:
  std::uint64_t key_;
  std::uint64_t s_[4];
  double spare_normal_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace dwell
