#include "tracker/motion/unknown_turn_rate.hpp"

#include <algorithm>
#include <cmath>

#include <boost/math/quadrature/gauss.hpp>

#include "tracker/motion/coordinated_turn.hpp"

namespace dwell {
namespace {

constexpr int kRate = kStateSize;
constexpr double kStraight = 1e-14;  // rad/s: no turn, where dividing by none fails

Vector2 left_of(const Vector2& v) { return {-v.y(), v.x()}; }

/// d [x vx y vy] / dw after t of a turn that began with velocity v.
State slope_of_rate(double rate, double t, const Vector2& v) {
  const State after = transition(CoordinatedTurn{rate}, t) * make_state(Vector2::Zero(), v);
  const double u = rate * t;
  Vector2 of_position = (t * velocity(after) - position(after)) / rate;
  if (std::abs(u) < 1e-3) {  // its series, where the difference would cancel: T^2 (i/2 - u/3 - i u^2/8 + u^3/30) v
    of_position = t * t * ((0.5 - u * u / 8.0) * left_of(v) - (u / 3.0 - u * u * u / 30.0) * v);
  }
  return make_state(of_position, t * left_of(velocity(after)));
}

}  // namespace

Moved move(const UnknownTurnRate& motion, double dt_s, const FullState& x) {
  const double rate = std::abs(x[kRate]) < kStraight ? kStraight : x[kRate];
  const CoordinatedTurn turn{rate};
  const State before = x.head<kStateSize>();
  Moved moved;
  moved.f.topLeftCorner<kStateSize, kStateSize>() = transition(turn, dt_s);
  moved.mean << moved.f.topLeftCorner<kStateSize, kStateSize>() * before, x.tail<2>();
  moved.f.block<kStateSize, 1>(0, kRate) = slope_of_rate(rate, dt_s, velocity(before));
  moved.q.topLeftCorner<kStateSize, kStateSize>() = white_noise(turn, motion.acceleration_density, dt_s);
  constexpr double kMostPieces = 16.0;  // five turns over the interval: beyond, what is linearised means nothing
  const int pieces = 1 + static_cast<int>(std::min(kMostPieces, 0.5 * std::abs(rate) * dt_s));
  const double width = dt_s / pieces;
  using Rule = boost::math::quadrature::gauss<double, 10>;
  for (int piece = 0; piece < pieces; ++piece) {
    for (std::size_t node = 0; node < Rule::abscissa().size(); ++node) {
      for (const double side : {-1.0, 1.0}) {
        const double age_s = width * (piece + 0.5 + 0.5 * side * Rule::abscissa()[node]);
        const Vector2 v = velocity(State(transition(turn, dt_s - age_s) * before));
        FullState g = FullState::Zero();
        g << slope_of_rate(rate, age_s, v), 1.0, 0.0;
        moved.q += 0.5 * width * Rule::weights()[node] * motion.rate_density * g * g.transpose();
      }
    }
  }
  return moved;
}

}  // namespace dwell
