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

/// Whether this is one of the long tests (./dev soak): of a source that both have.
inline bool soak() { return std::getenv("DWELL_SOAK") != nullptr; }
/// `full` there, `light` elsewhere.
inline int soaked(int full, int light) { return soak() ? full : light; }

}  // namespace dwell
