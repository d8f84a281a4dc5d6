#pragma once

#include <memory>

#include "radar/sensor.hpp"

namespace dwell {

/// Sees the position itself, with false plots everywhere. A beam, where it is given one, is a square.
class PositionSensor final : public Sensor {
 public:
  PositionSensor(const Matrix2& r, double p_d, double clutter_density,
                 double half_m = std::numeric_limits<double>::infinity())
      : r_(r), p_d_(p_d), clutter_density_(clutter_density), half_m_(half_m) {}

  Vector2 measure(const State& x) const override { return position(x); }
  MeasurementJacobian jacobian(const State& /*x*/) const override { return position_selector(); }
  Matrix2 noise(const State& /*x*/) const override { return r_; }
  Vector2 residual(const Vector2& z, const Vector2& predicted) const override { return z - predicted; }
  double detection_probability(const State& /*x*/) const override { return p_d_; }
  bool covers(const State& /*x*/) const override { return true; }
  std::optional<Vector2> position_of(const Vector2& z) const override { return z; }
  std::optional<MeasurementBox> coverage() const override {
    return MeasurementBox{Vector2::Zero(), Vector2::Constant(half_m_)};
  }
  Vector2 footprint_half_extent() const override { return Vector2::Constant(half_m_); }
  double clutter_density() const override { return clutter_density_; }

 private:
  Matrix2 r_;
  double p_d_;
  double clutter_density_;
  double half_m_;
};

}  // namespace dwell
