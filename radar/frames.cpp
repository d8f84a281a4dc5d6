#include "radar/frames.hpp"

#include <algorithm>
#include <cmath>

namespace dwell {

double wrap_angle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

double azimuth_difference(double a_rad, double b_rad) { return wrap_angle(a_rad - b_rad); }

Polar to_polar(const Vector2& origin_m, const Vector2& point_m) {
  const Vector2 d = point_m - origin_m;
  return {std::hypot(d.x(), d.y()), wrap_angle(std::atan2(d.x(), d.y()))};
}

Vector2 to_cartesian(const Vector2& origin_m, const Polar& polar) {
  return origin_m + polar.range_m * Vector2(std::sin(polar.azimuth_rad), std::cos(polar.azimuth_rad));
}

Matrix2 polar_jacobian(const Vector2& origin_m, const Vector2& point_m) {
  const Vector2 d = point_m - origin_m;
  const double distance_m = d.norm();
  const Vector2 u = distance_m > 0.0 ? Vector2(d / distance_m) : Vector2(0.0, 1.0);
  const double range_m = std::max(distance_m, kLeastRange);
  Matrix2 jacobian;
  jacobian << u.x(), u.y(), u.y() / range_m, -u.x() / range_m;
  return jacobian;
}

}  // namespace dwell
