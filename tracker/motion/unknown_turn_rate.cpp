#include "tracker/motion/unknown_turn_rate.hpp"

#include <cmath>

#include "tracker/motion/coordinated_turn.hpp"

namespace dwell {
namespace {

constexpr int kRate = kStateSize;
constexpr double kStraight = 1e-9;  // rad/s: a turn in two centuries

Vector2 left_of(const Vector2& v) { return {-v.y(), v.x()}; }

}  // namespace

Matrix2 start_covariance(const UnknownTurnRate& motion) {
  Matrix2 covariance = Matrix2::Zero();
  covariance(0, 0) = motion.start_sigma_radps * motion.start_sigma_radps;
  return covariance;
}

Moved move(const UnknownTurnRate& motion, double dt_s, const FullState& x) {
  const double rate = std::abs(x[kRate]) < kStraight ? kStraight : x[kRate];
  const CoordinatedTurn turn{rate};
  const State before = x.head<kStateSize>();
  const StateMatrix f = transition(turn, dt_s);
  const State after = f * before;
  Moved moved;
  moved.mean << after, x.tail<2>();
  moved.f.topLeftCorner<kStateSize, kStateSize>() = f;
  const Vector2 v = velocity(before);
  const double u = rate * dt_s;
  Vector2 position_slope = (dt_s * velocity(after) - (position(after) - position(before))) / rate;
  if (std::abs(u) < 1e-3) {  // its series, where the difference would cancel: T^2 (i/2 - u/3 - i u^2/8 + u^3/30) v
    position_slope = dt_s * dt_s * ((0.5 - u * u / 8.0) * left_of(v) - (u / 3.0 - u * u * u / 30.0) * v);
  }
  moved.f.block<kStateSize, 1>(0, kRate) = make_state(position_slope, dt_s * left_of(velocity(after)));
  moved.q.topLeftCorner<kStateSize, kStateSize>() = white_noise(turn, motion.acceleration_density, dt_s);
  moved.q(kRate, kRate) = motion.rate_density * dt_s;
  return moved;
}

}  // namespace dwell
