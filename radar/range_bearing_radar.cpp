#include "radar/range_bearing_radar.hpp"

#include <algorithm>
#include <cmath>

namespace dwell {
namespace {

constexpr double kSpeedOfLight_mps = 299792458.0;

double detection(const FixedDetection& model, double /*snr*/) { return model.probability; }
double detection(const SwerlingOneDetection& model, double snr) {
  return std::pow(model.false_alarm_probability, 1.0 / (1.0 + snr));
}

}  // namespace

double RangeBearingRadar::range_m(const State& x) const {
  return std::max((position(x) - figures_.position_m).norm(), kLeastRange);
}

double RangeBearingRadar::snr(double range_m) const {
  const double ratio = figures_.reference_range_m / range_m;
  return figures_.snr_reference * ratio * ratio * ratio * ratio;
}

double RangeBearingRadar::range_sigma_m(double range_m) const {
  const double resolution_m = 0.5 * kSpeedOfLight_mps * figures_.pulse_length_s;
  return std::hypot(resolution_m / std::sqrt(2.0 * snr(range_m)), figures_.range_noise_floor_m);
}

double RangeBearingRadar::azimuth_sigma_rad(double range_m) const {
  return std::hypot(figures_.beamwidth_rad / (1.6 * std::sqrt(2.0 * snr(range_m))), figures_.azimuth_noise_floor_rad);
}

Vector2 RangeBearingRadar::measure(const State& x) const {
  const Polar polar = to_polar(figures_.position_m, position(x));
  return {polar.range_m, polar.azimuth_rad};
}

MeasurementJacobian RangeBearingRadar::jacobian(const State& x) const {
  return polar_jacobian(figures_.position_m, position(x)) * position_selector();
}

Matrix2 RangeBearingRadar::noise(const State& x) const {
  const double range = range_m(x);
  const double sigma_range = range_sigma_m(range);
  const double sigma_azimuth = azimuth_sigma_rad(range);
  return Vector2(sigma_range * sigma_range, sigma_azimuth * sigma_azimuth).asDiagonal();
}

Vector2 RangeBearingRadar::residual(const Vector2& z, const Vector2& predicted) const {
  return {z[0] - predicted[0], azimuth_difference(z[1], predicted[1])};
}

double RangeBearingRadar::detection_probability(const State& x) const {
  const double signal = snr(range_m(x));
  return std::visit([&](const auto& model) { return detection(model, signal); }, figures_.detection);
}

bool RangeBearingRadar::covers(const State& x) const {
  const Polar polar = to_polar(figures_.position_m, position(x));
  return polar.range_m >= kLeastRange && polar.range_m <= figures_.max_range_m &&
         std::abs(azimuth_difference(polar.azimuth_rad, figures_.sector_centre_rad)) <= 0.5 * figures_.sector_width_rad;
}

std::optional<Vector2> RangeBearingRadar::position_of(const Vector2& z) const {
  return to_cartesian(figures_.position_m, {z[0], z[1]});
}

std::optional<MeasurementBox> RangeBearingRadar::coverage() const {
  if (!std::isfinite(figures_.max_range_m)) return std::nullopt;
  const Vector2 half(0.5 * figures_.max_range_m, 0.5 * figures_.sector_width_rad);
  return MeasurementBox{{half[0], figures_.sector_centre_rad}, half};
}

Vector2 RangeBearingRadar::footprint_half_extent() const {
  return {figures_.dwell_range_m, figures_.dwell_azimuth_rad};
}

}  // namespace dwell
