#pragma once

#include "tracker/motion/moved.hpp"

namespace dwell {

/// Coordinated turn whose rate w is the fifth state, a random walk: CoordinatedTurn's F at the mean of w, and
///
///   d v' / dw = T J v',   d p' / dw = (T v' - (p' - p)) / w      J the quarter turn to the left
///
/// Q: that of CoordinatedTurn for white acceleration of density q, and q_w times the integral over 0 .. T of g g', g
/// what a change of the rate so long before the end has become of p', v' and w by then; by Gauss-Legendre, exact to
/// rounding. Linearised: the rate's own spread must be well under a turn over the interval. Source  Bar-Shalom, Li,
/// Kirubarajan (2001), 11.7.2.
struct UnknownTurnRate {
  static constexpr TrailingKind kTrailing = TrailingKind::kTurnRate;
  static constexpr bool kLinear = false;
  double acceleration_density;      ///< q, m^2/s^3
  double rate_density;              ///< q_w, rad^2/s^3
  double start_sigma_radps = 0.05;  ///< where nothing is known: a standard-rate turn of 3 deg/s
};

inline Vector2 start_sigma(const UnknownTurnRate& motion) { return {motion.start_sigma_radps, 0.0}; }
Moved move(const UnknownTurnRate& motion, double dt_s, const FullState& x);

}  // namespace dwell
