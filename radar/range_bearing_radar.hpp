#pragma once

#include <variant>

#include "radar/frames.hpp"
#include "radar/sensor.hpp"

namespace dwell {

/// P_d the same at every range.
struct FixedDetection {
  double probability = 1.0;
};

/// Swerling I: P_d = P_fa^(1 / (1 + SNR)). Source: Skolnik (2001), 2.6; exact for one pulse and an exponential RCS.
struct SwerlingOneDetection {
  double false_alarm_probability = 1e-6;
};

/// The figures of one range-bearing radar.
///
///   SNR(R)        = snr_reference (reference_range / R)^4
///   sigma_range   = sqrt((c tau / 2)^2 / (2 SNR) + range_noise_floor^2),      c tau / 2 = 7.5 m at 50 ns
///   sigma_azimuth = sqrt((beamwidth / 1.6)^2 / (2 SNR) + azimuth_noise_floor^2)
///
/// The floors stand for what does not improve with SNR (timing, encoder, pointing) and are independent of it.
/// Source  Evans et al. (2005), V, read as in the README of this folder; Barton (2005), 8.2, for the 1.6.
struct RadarFigures {
  Vector2 position_m = Vector2::Zero();
  double beamwidth_rad = 1.0 * kDegree;
  double pulse_length_s = 50e-9;
  double snr_reference = 1e5;  ///< ratio, 50 dB: scenario 1 of Evans
  double reference_range_m = 100e3;
  double range_noise_floor_m = 0.0;
  double azimuth_noise_floor_rad = 0.0;
  std::variant<FixedDetection, SwerlingOneDetection> detection = FixedDetection{};
  double max_range_m = std::numeric_limits<double>::infinity();
  double sector_centre_rad = 0.0;
  double sector_width_rad = 360.0 * kDegree;
  double clutter_density = 0.0;              ///< per metre and radian
  double dwell_azimuth_rad = 3.0 * kDegree;  ///< half width: three of the default beamwidths
  double dwell_range_m = 10e3;               ///< half depth: a 10 s coast at 1000 m/s stays inside
};

class RangeBearingRadar final : public Sensor {
 public:
  explicit RangeBearingRadar(const RadarFigures& figures) : figures_(figures) {}

  const RadarFigures& figures() const { return figures_; }
  double snr(double range_m) const;
  double range_sigma_m(double range_m) const;
  double azimuth_sigma_rad(double range_m) const;

  Vector2 measure(const State& x) const override;
  MeasurementJacobian jacobian(const State& x) const override;
  Matrix2 noise(const State& x) const override;
  Vector2 residual(const Vector2& z, const Vector2& predicted) const override;
  double detection_probability(const State& x) const override;
  bool covers(const State& x) const override;
  std::optional<Vector2> position_of(const Vector2& z) const override;
  Vector2 footprint_half_extent() const override;
  std::optional<MeasurementBox> coverage() const override;
  double clutter_density() const override { return figures_.clutter_density; }
  double largest_range() const override { return figures_.max_range_m; }

 private:
  double range_m(const State& x) const;

  RadarFigures figures_;
};

}  // namespace dwell
