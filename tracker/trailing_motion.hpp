#pragma once

#include <variant>

#include "tracker/motion/constant_acceleration.hpp"
#include "tracker/motion/singer.hpp"
#include "tracker/motion/unknown_turn_rate.hpp"

namespace dwell {

/// The catalogue of motions with trailing states, noise included. Each gives
///   kTrailing                  what these states are
///   kLinear                    whether F and Q are the same from any state
///   start_sigma(motion)        standard deviations of them where nothing is known; their mean is zero
///   move(motion, dt, x)        where x goes over dt seconds, linearised: mean, F = d mean / dx, Q, each of six states
using TrailingMotion = std::variant<ConstantAcceleration, Singer, UnknownTurnRate>;

inline TrailingKind trailing_kind(const TrailingMotion& motion) {
  return std::visit([](const auto& model) { return model.kTrailing; }, motion);
}

inline bool is_linear(const TrailingMotion& motion) {
  return std::visit([](const auto& model) { return model.kLinear; }, motion);
}

inline Vector2 start_sigma(const TrailingMotion& motion) {
  return std::visit([](const auto& model) { return start_sigma(model); }, motion);
}

inline Moved move(const TrailingMotion& motion, double dt_s, const FullState& x) {
  return std::visit([&](const auto& model) { return move(model, dt_s, x); }, motion);
}

}  // namespace dwell
