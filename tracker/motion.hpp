#pragma once

#include <variant>

#include "tracker/motion/constant_velocity.hpp"
#include "tracker/motion/coordinated_turn.hpp"

namespace dwell {

/// The catalogue of motions. Each gives, over dt seconds, x' = F(dt) x + w:
///   transition(motion, dt)               F(dt), 4 x 4
///   white_noise(motion, q, dt)           Q of white-noise acceleration of density q (m^2/s^3) on each axis
using Motion = std::variant<ConstantVelocity, CoordinatedTurn>;

inline StateMatrix transition(const Motion& motion, double dt_s) {
  return std::visit([&](const auto& model) { return transition(model, dt_s); }, motion);
}

inline StateMatrix white_noise(const Motion& motion, double q, double dt_s) {
  return std::visit([&](const auto& model) { return white_noise(model, q, dt_s); }, motion);
}

}  // namespace dwell
