#include "tracker/motion/coordinated_turn.hpp"

#include <cmath>

namespace dwell {
namespace {

/// Places a + b i, acting on the plane, as the block that maps (x, y) of columns to (x, y) of rows.
void place(StateMatrix& m, int row_x, int row_y, int column_x, int column_y, double a, double b) {
  m(row_x, column_x) = m(row_y, column_y) = a;
  m(row_y, column_x) = b;
  m(row_x, column_y) = -b;
}

/// (1 - cos u) / u without cancellation.
double one_minus_cos_over(double u) { return std::sin(0.5 * u) * std::sin(0.5 * u) * 2.0 / u; }

/// (u - sin u) / u^2, by its series where the difference would cancel.
double u_minus_sin_over_square(double u) {
  if (std::abs(u) > 0.1) return (u - std::sin(u)) / (u * u);
  const double u2 = u * u;
  return u / 6.0 * (1.0 - u2 / 20.0 * (1.0 - u2 / 42.0 * (1.0 - u2 / 72.0 * (1.0 - u2 / 110.0))));
}

}  // namespace

StateMatrix transition(const CoordinatedTurn& motion, double dt_s) {
  const double w = motion.turn_rate_radps;
  const double u = w * dt_s;
  StateMatrix f = StateMatrix::Zero();
  place(f, kX, kY, kX, kY, 1.0, 0.0);
  if (dt_s != 0.0) place(f, kX, kY, kVx, kVy, std::sin(u) / w, dt_s * one_minus_cos_over(u));
  place(f, kVx, kVy, kVx, kVy, std::cos(u), std::sin(u));
  return f;
}

StateMatrix white_noise(const CoordinatedTurn& motion, double q, double dt_s) {
  StateMatrix noise = StateMatrix::Zero();
  if (dt_s == 0.0) return noise;
  const double w = motion.turn_rate_radps;
  const double u = w * dt_s;
  const double lag = q * dt_s * dt_s * u_minus_sin_over_square(u);  // q (T - sin(wT)/w) / w
  const double along = q * dt_s / w * one_minus_cos_over(u);        // q (1 - cos(wT)) / w^2
  place(noise, kX, kY, kX, kY, 2.0 * lag / w, 0.0);
  place(noise, kX, kY, kVx, kVy, along, -lag);
  place(noise, kVx, kVy, kX, kY, along, lag);
  place(noise, kVx, kVy, kVx, kVy, q * dt_s, 0.0);
  return noise;
}

}  // namespace dwell
