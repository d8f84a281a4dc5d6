#pragma once

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace dwell {

/// `count`, or a tenth of it where the environment says DWELL_TEST_SCALE=small (sanitizers, slow machines).
/// Bounds are derived from the scaled count, so a small run is as strict as its size allows.
inline int scaled(int count) {
  const char* scale = std::getenv("DWELL_TEST_SCALE");
  const bool small = scale != nullptr && std::string_view(scale) == "small";
  return small ? std::max(1, count / 10) : count;
}

/// `full` in the long tests (./dev soak), `light` in the others: of a source that both have.
inline int soaked(int full, int light) { return std::getenv("DWELL_SOAK") != nullptr ? full : light; }

}  // namespace dwell
