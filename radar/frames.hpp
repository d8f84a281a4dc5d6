#pragma once

#include <numbers>

#include "radar/state.hpp"

namespace dwell {

/// The one frame: a local east-north-up plane, metres, x east, y north. Azimuth from north, clockwise, radians.
inline constexpr double kDegree = std::numbers::pi / 180.0;

struct Polar {
  double range_m = 0.0;
  double azimuth_rad = 0.0;
};

/// The same direction in (-pi, pi].
double wrap_angle(double angle_rad);

/// a - b the short way round, in (-pi, pi]. The only place that subtracts bearings.
double azimuth_difference(double a_rad, double b_rad);

/// `point` as seen from `origin`; azimuth in (-pi, pi], 0 where the two coincide.
Polar to_polar(const Vector2& origin_m, const Vector2& point_m);

Vector2 to_cartesian(const Vector2& origin_m, const Polar& polar);

/// d(range, azimuth) / d(x, y) of `point` as seen from `origin`, 2 x 2: m/m and rad/m.
/// Nearer than kLeastRange it is that of the point in the same direction there; north where the two coincide.
Matrix2 polar_jacobian(const Vector2& origin_m, const Vector2& point_m);

/// Nearer than this a bearing means nothing: sensors do not look, and jacobians are taken here. Metres.
inline constexpr double kLeastRange = 1.0;

}  // namespace dwell
