#pragma once

#include "radar/state.hpp"

namespace dwell {

/// Coordinated turn of known rate w, counter-clockwise positive.
///
///   v' = R(wT) v,   p' = p + S(T) v,   S(T) = integral of R(wt) over 0..T,   R the rotation by an angle.
///
/// White-noise acceleration of density q on each axis, the same in every direction, so that with complex numbers
/// for the rotations (e = exp(i w T)):
///   Q_vv = q T,   Q_pp = 2 q (T - sin(wT)/w) / w^2,   Q_pv = q (T - (1 - 1/e) / (i w)) / (i w).
///
/// Source  Bar-Shalom, Li, Kirubarajan (2001), 11.7.1, for F; Q integrated here, proved by the semigroup law
///         Q(a + b) = F(b) Q(a) F(b)' + Q(b) in the tests.
/// Requires turn_rate_radps != 0 (a rate of zero is ConstantVelocity).
struct CoordinatedTurn {
  double turn_rate_radps;
};

StateMatrix transition(const CoordinatedTurn& motion, double dt_s);
StateMatrix white_noise(const CoordinatedTurn& motion, double q, double dt_s);

}  // namespace dwell
