#pragma once

#include "radar/calibration/correction.hpp"
#include "radar/range_bearing_radar.hpp"

namespace dwell {

/// A range-bearing radar with a correction: the truth of a radar that is not what its config says, and the belief
/// in a radar whose calibration is applied. With the default correction it is the radar itself, bit for bit.
///
///   h(x) = radar's h(position + time_bias velocity) + bias       R = D R_radar D, D = diag(e^log_scale)
///   P_d(x) = min(detection_scale P_d,radar(x), 1)
class CorrectedRadar final : public Sensor {
 public:
  explicit CorrectedRadar(const RadarFigures& figures) : radar_(figures), clutter_density_(figures.clutter_density) {}

  const RadarFigures& figures() const { return radar_.figures(); }
  const Correction& correction() const { return correction_; }
  void set_correction(const Correction& correction) { correction_ = correction; }
  /// A factor >= 0 on the configured P_d.
  void set_detection_scale(double scale) { detection_scale_ = scale; }
  double detection_scale() const { return detection_scale_; }
  /// In the place of the configured one.
  void set_clutter_density(double density) { clutter_density_ = density; }
  /// Factor on both sigmas, beyond the correction: 1, or more while the radar is under suspicion.
  void set_distrust(double factor) { distrust_ = factor; }
  double distrust() const { return distrust_; }

  Vector2 measure(const State& x) const override;
  MeasurementJacobian jacobian(const State& x) const override;
  Matrix2 noise(const State& x) const override;
  Vector2 residual(const Vector2& z, const Vector2& predicted) const override { return radar_.residual(z, predicted); }
  double detection_probability(const State& x) const override;
  /// By the config alone.
  Matrix2 configured_noise(const State& x) const { return radar_.noise(x); }
  double configured_detection(const State& x) const { return radar_.detection_probability(x); }
  bool covers(const State& x) const override { return radar_.covers(x); }
  /// Without the biases of range and azimuth; the time bias is not undone: a plot has no velocity.
  std::optional<Vector2> position_of(const Vector2& z) const override;
  Vector2 footprint_half_extent() const override { return radar_.footprint_half_extent(); }
  std::optional<MeasurementBox> coverage() const override { return radar_.coverage(); }
  double clutter_density() const override { return clutter_density_; }
  double largest_range() const override { return radar_.largest_range(); }

 private:
  State shifted(const State& x) const;

  RangeBearingRadar radar_;
  Correction correction_;
  double detection_scale_ = 1.0;
  double clutter_density_;
  double distrust_ = 1.0;
};

}  // namespace dwell
