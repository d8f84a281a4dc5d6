#include "radar/random.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace dwell {
namespace {

std::uint64_t mix(std::uint64_t z) {  // the output function of SplitMix64
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

std::uint64_t fnv1a(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;

}  // namespace

RandomStream::RandomStream(std::uint64_t seed) : key_(seed) {
  std::uint64_t state = seed;
  for (auto& word : s_) word = mix(state += kGolden);
}

RandomStream RandomStream::fork(std::string_view name) const {
  return RandomStream(mix(mix(key_ + kGolden) ^ fnv1a(name)));
}

RandomStream RandomStream::fork(std::uint64_t number) const {
  return RandomStream(mix(mix(key_ + 2 * kGolden) ^ mix(number + kGolden)));
}

std::uint64_t RandomStream::bits() {
  const std::uint64_t result = std::rotl(s_[0] + s_[3], 23) + s_[0];
  const std::uint64_t t = s_[1] << 17;
  s_[2] ^= s_[0];
  s_[3] ^= s_[1];
  s_[1] ^= s_[2];
  s_[0] ^= s_[3];
  s_[2] ^= t;
  s_[3] = std::rotl(s_[3], 45);
  return result;
}

double RandomStream::uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

double RandomStream::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_normal_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_normal_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

int RandomStream::poisson(double mean) {
  constexpr double kPiece = 500.0;  // exp(-500) is still a normal double
  int count = 0;
  for (double left = mean; left > 0.0; left -= kPiece) {
    const double limit = std::exp(-std::min(left, kPiece));
    for (double product = 1.0 - uniform(); product > limit; product *= 1.0 - uniform()) ++count;
  }
  return count;
}

}  // namespace dwell
