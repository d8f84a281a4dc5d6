#pragma once

#include "tracker/gaussian.hpp"

namespace dwell {

/// What the states that trail [x vx y vy] in a mode are; modes that have the same exchange them.
enum class TrailingKind {
  kNone,
  kAcceleration,  ///< ax, ay, m/s^2
  kTurnRate,      ///< counter-clockwise positive, rad/s
};

inline constexpr int kMostStates = kStateSize + 2;
using FullState = Eigen::Matrix<double, kMostStates, 1>;
using FullMatrix = Eigen::Matrix<double, kMostStates, kMostStates>;

/// Kinematic and trailing states together. What a mode does not have of the last two is zero, without variance.
struct FullGaussian {
  FullState mean = FullState::Zero();
  FullMatrix covariance = FullMatrix::Zero();
};

/// The trailing states e of a mode, as they are given its kinematic state x:
///
///   e | x ~ N(a + G x, C)
///
/// Sensors measure x alone, and what x is taken to be says nothing new of e given x: every update, of whatever form,
/// leaves a, G and C as they are. With x ~ N(m, P) the mean of e is a + G m, its covariance C + G P G' and that with x
/// G P: positive definite whenever P and C are. C is kept as a root, C = B B': of an acceleration that hardly changes
/// it is by far less than what rounding does to the covariance of e.
struct Trailing {
  Vector2 a = Vector2::Zero();
  Eigen::Matrix<double, 2, kStateSize> g = Eigen::Matrix<double, 2, kStateSize>::Zero();
  Matrix2 b = Matrix2::Zero();
};

inline FullGaussian join(const Gaussian& kinematic, const Trailing& trailing) {
  FullGaussian full;
  full.mean << kinematic.mean, trailing.a + trailing.g * kinematic.mean;
  const Eigen::Matrix<double, 2, kStateSize> cross = trailing.g * kinematic.covariance;
  full.covariance.topLeftCorner<kStateSize, kStateSize>() = kinematic.covariance;
  full.covariance.bottomLeftCorner<2, kStateSize>() = cross;
  full.covariance.topRightCorner<kStateSize, 2>() = cross.transpose();
  full.covariance.bottomRightCorner<2, 2>() = trailing.b * trailing.b.transpose() + cross * trailing.g.transpose();
  return full;
}

}  // namespace dwell
