#pragma once

#include "tracker/motion/moved.hpp"

namespace dwell {

/// Singer's target: on each axis a stationary random acceleration of variance sigma^2 that is forgotten with time
/// constant tau, a' = -a / tau + w, w white of density 2 sigma^2 / tau.
/// Source  Singer (1970), IEEE T-AES 6(4); Bar-Shalom, Li, Kirubarajan (2001), 8.2.3.
struct Singer {
  static constexpr TrailingKind kTrailing = TrailingKind::kAcceleration;
  static constexpr bool kLinear = true;
  double sigma_mps2;
  double time_constant_s;
};

inline Vector2 start_sigma(const Singer& motion) { return Vector2::Constant(motion.sigma_mps2); }

inline Moved move(const Singer& motion, double dt_s, const FullState& x) {
  const double density = 2.0 * motion.sigma_mps2 * motion.sigma_mps2 / motion.time_constant_s;
  return move_with_acceleration(1.0 / motion.time_constant_s, density, dt_s, x);
}

}  // namespace dwell
