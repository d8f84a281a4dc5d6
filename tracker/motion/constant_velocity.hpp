#pragma once

#include "radar/state.hpp"

namespace dwell {

/// Nearly constant velocity: each axis an integrator of its velocity.
///
///   F = [1 T; 0 1] on each axis;   Q = q [T^3/3 T^2/2; T^2/2 T] for white-noise acceleration.
///
/// Source  Bar-Shalom, Li, Kirubarajan (2001), 6.2.2.
struct ConstantVelocity {};

StateMatrix transition(const ConstantVelocity& motion, double dt_s);
StateMatrix white_noise(const ConstantVelocity& motion, double q, double dt_s);

}  // namespace dwell
