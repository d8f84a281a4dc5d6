#pragma once

#include "tracker/motion/moved.hpp"

namespace dwell {

/// Nearly constant acceleration: on each axis a' = w, white-noise jerk of density q.
/// Source  Bar-Shalom, Li, Kirubarajan (2001), 6.2.3.
struct ConstantAcceleration {
  static constexpr TrailingKind kTrailing = TrailingKind::kAcceleration;
  static constexpr bool kLinear = true;
  double jerk_density;             ///< q, m^2/s^5
  double start_sigma_mps2 = 10.0;  ///< of each component where nothing is known: 1 g
};

inline Vector2 start_sigma(const ConstantAcceleration& motion) { return Vector2::Constant(motion.start_sigma_mps2); }

inline Moved move(const ConstantAcceleration& motion, double dt_s, const FullState& x) {
  return move_with_acceleration(0.0, motion.jerk_density, dt_s, x);
}

}  // namespace dwell
