#pragma once

#include <Eigen/Core>

namespace dwell {

/// Kinematic state `[x vx y vy]`: metres and metres a second in the local plane (radar/frames.hpp). Truth and
/// belief share this layout; nothing but the accessors below knows it.
inline constexpr int kStateSize = 4;
using State = Eigen::Matrix<double, kStateSize, 1>;
using StateMatrix = Eigen::Matrix<double, kStateSize, kStateSize>;
using Vector2 = Eigen::Vector2d;
using Matrix2 = Eigen::Matrix2d;

inline constexpr int kX = 0, kVx = 1, kY = 2, kVy = 3;

inline Vector2 position(const State& x) { return {x[kX], x[kY]}; }
inline Vector2 velocity(const State& x) { return {x[kVx], x[kVy]}; }
inline State make_state(const Vector2& position_m, const Vector2& velocity_mps) {
  return {position_m.x(), velocity_mps.x(), position_m.y(), velocity_mps.y()};
}
inline Matrix2 position_block(const StateMatrix& covariance) { return covariance({kX, kY}, {kX, kY}); }

/// Selects x and y: z = H x.
inline Eigen::Matrix<double, 2, kStateSize> position_selector() {
  Eigen::Matrix<double, 2, kStateSize> h = Eigen::Matrix<double, 2, kStateSize>::Zero();
  h(0, kX) = h(1, kY) = 1.0;
  return h;
}

}  // namespace dwell
