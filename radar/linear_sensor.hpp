#pragma once

#include "radar/sensor.hpp"

namespace dwell {

/// z = C x + v, v ~ N(0, R): sees everything, everywhere. Source: Liu, Hwang (2011), (5).
class LinearSensor final : public Sensor {
 public:
  LinearSensor(const MeasurementJacobian& c, const Matrix2& r, double detection_probability)
      : c_(c), r_(r), detection_probability_(detection_probability) {}

  Vector2 measure(const State& x) const override { return c_ * x; }
  MeasurementJacobian jacobian(const State& /*x*/) const override { return c_; }
  Matrix2 noise(const State& /*x*/) const override { return r_; }
  Vector2 residual(const Vector2& z, const Vector2& predicted) const override { return z - predicted; }
  double detection_probability(const State& /*x*/) const override { return detection_probability_; }
  bool covers(const State& /*x*/) const override { return true; }
  std::optional<Vector2> position_of(const Vector2& /*z*/) const override { return std::nullopt; }

 private:
  MeasurementJacobian c_;
  Matrix2 r_;
  double detection_probability_;
};

}  // namespace dwell
