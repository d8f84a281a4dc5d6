#pragma once

#include <cmath>

namespace dwell::restless {

/// From 0 at x <= 0 to 1 at x >= 1 with all derivatives: s / (s + s'), s = exp(-1 / x), s' = exp(-1 / (1 - x)).
///
/// Under weights that rise and fall like this the mean of a sequence with period T over N terms differs from that of
/// one period by less than any power of T / N.
inline double smooth_step(double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  return 1.0 / (1.0 + std::exp(1.0 / x - 1.0 / (1.0 - x)));
}

}  // namespace dwell::restless
