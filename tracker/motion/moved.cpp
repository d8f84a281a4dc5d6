#include "tracker/motion/moved.hpp"

#include <array>
#include <cmath>

#include <boost/math/quadrature/gauss.hpp>

namespace dwell {
namespace {

using Axis = Eigen::Vector3d;  // of position, velocity, acceleration

/// What an acceleration of one becomes after t: [A(t) B(t) e^-dt].
Axis response(double decay, double t) {
  const double u = decay * t;
  if (u >= 0.5) {
    const double b = -std::expm1(-u) / decay;
    return {(t - b) / decay, b, std::exp(-u)};
  }
  // A = t^2 sum (-u)^k / (k + 2)!, B = t sum (-u)^k / (k + 1)!
  double term = 1.0;
  double a = 0.0;
  double b = 0.0;
  for (int k = 0; k < 20; ++k) {
    b += term / (k + 1);
    a += term / ((k + 1) * (k + 2));
    term *= -u / (k + 1);
  }
  return {t * t * a, t * b, std::exp(-u)};
}

}  // namespace

Moved move_with_acceleration(double decay_per_s, double q, double dt_s, const FullState& x) {
  Moved moved;
  const Axis here = response(decay_per_s, dt_s);
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
  const int pieces = 1 + static_cast<int>(0.5 * decay_per_s * dt_s);
  const double width = dt_s / pieces;
  using Rule = boost::math::quadrature::gauss<double, 20>;
  for (int piece = 0; piece < pieces; ++piece) {
    for (std::size_t node = 0; node < Rule::abscissa().size(); ++node) {
      for (const double side : {-1.0, 1.0}) {
        const Axis g = response(decay_per_s, width * (piece + 0.5 + 0.5 * side * Rule::abscissa()[node]));
        noise += 0.5 * width * Rule::weights()[node] * q * g * g.transpose();
      }
    }
  }
  constexpr std::array<std::array<int, 3>, 2> kAxes{{{kX, kVx, kStateSize}, {kY, kVy, kStateSize + 1}}};
  for (const auto& axis : kAxes) {
    moved.f(axis[0], axis[1]) = dt_s;
    for (int i = 0; i < 3; ++i) {
      moved.f(axis[i], axis[2]) = here[i];
      for (int j = 0; j < 3; ++j) moved.q(axis[i], axis[j]) = noise(i, j);
    }
  }
  moved.mean = moved.f * x;
  return moved;
}

}  // namespace dwell
