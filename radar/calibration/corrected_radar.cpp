#include "radar/calibration/corrected_radar.hpp"

#include <algorithm>
#include <cmath>

namespace dwell {

State CorrectedRadar::shifted(const State& x) const {
  return make_state(position(x) + correction_.time_bias_s * velocity(x), velocity(x));
}

Vector2 CorrectedRadar::measure(const State& x) const {
  const Vector2 z = radar_.measure(shifted(x));
  if (correction_.range_bias_m == 0.0 && correction_.azimuth_bias_rad == 0.0) return z;
  return {z[0] + correction_.range_bias_m, wrap_angle(z[1] + correction_.azimuth_bias_rad)};
}

/// d h(position + tau velocity) / d(x, vx, y, vy): the columns of the velocity are tau times those of the position.
MeasurementJacobian CorrectedRadar::jacobian(const State& x) const {
  MeasurementJacobian h = radar_.jacobian(shifted(x));
  h.col(kVx) = correction_.time_bias_s * h.col(kX);
  h.col(kVy) = correction_.time_bias_s * h.col(kY);
  return h;
}

Matrix2 CorrectedRadar::noise(const State& x) const {
  const Vector2 scale(distrust_ * std::exp(correction_.log_range_scale),
                      distrust_ * std::exp(correction_.log_azimuth_scale));
  return scale.asDiagonal() * radar_.noise(x) * scale.asDiagonal();
}

double CorrectedRadar::detection_probability(const State& x) const {
  return std::min(detection_scale_ * radar_.detection_probability(x), 1.0);
}

std::optional<Vector2> CorrectedRadar::position_of(const Vector2& z) const {
  return radar_.position_of({z[0] - correction_.range_bias_m, z[1] - correction_.azimuth_bias_rad});
}

}  // namespace dwell
