#include "tracker/motion/constant_velocity.hpp"

namespace dwell {

StateMatrix transition(const ConstantVelocity& /*motion*/, double dt_s) {
  StateMatrix f = StateMatrix::Identity();
  f(kX, kVx) = f(kY, kVy) = dt_s;
  return f;
}

StateMatrix white_noise(const ConstantVelocity& /*motion*/, double q, double dt_s) {
  StateMatrix noise = StateMatrix::Zero();
  noise(kX, kX) = noise(kY, kY) = q * dt_s * dt_s * dt_s / 3.0;
  noise(kX, kVx) = noise(kVx, kX) = noise(kY, kVy) = noise(kVy, kY) = q * dt_s * dt_s / 2.0;
  noise(kVx, kVx) = noise(kVy, kVy) = q * dt_s;
  return noise;
}

}  // namespace dwell
