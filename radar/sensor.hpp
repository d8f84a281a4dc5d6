#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "radar/declaration.hpp"
#include "radar/plot.hpp"
#include "radar/state.hpp"

namespace dwell {

using MeasurementJacobian = Eigen::Matrix<double, 2, kStateSize>;

/// A part of the measurement space: centre +- half.
struct MeasurementBox {
  Vector2 centre;
  Vector2 half;
};

/// What a sensor measures of a target, z = h(x) + v with v ~ N(0, R(x)), and when it sees it.
///
/// One object is the truth that the simulation draws from, another the belief of tracker and policy: calibration
/// changes the second. Measurements have two components; their units are the sensor's.
/// Models  RangeBearingRadar (radar/range_bearing_radar.hpp), LinearSensor (radar/linear_sensor.hpp).
class Sensor {
 public:
  virtual ~Sensor() = default;

  /// h(x).
  virtual Vector2 measure(const State& x) const = 0;
  /// dh/dx at x, 2 x 4.
  virtual MeasurementJacobian jacobian(const State& x) const = 0;
  /// R(x), 2 x 2, positive definite.
  virtual Matrix2 noise(const State& x) const = 0;
  /// z - predicted; bearings the short way round.
  virtual Vector2 residual(const Vector2& z, const Vector2& predicted) const = 0;
  /// P_d(x) in [0, 1] of a target inside the coverage and the footprint.
  virtual double detection_probability(const State& x) const = 0;
  /// In the field of view and range.
  virtual bool covers(const State& x) const = 0;
  /// The position that z stands for; empty for a sensor whose measurement is not a position.
  virtual std::optional<Vector2> position_of(const Vector2& z) const = 0;
  /// What one look returns plots from: h(pointing) +- this. Infinite for a sensor without a beam.
  virtual Vector2 footprint_half_extent() const { return Vector2::Constant(std::numeric_limits<double>::infinity()); }
  /// What a surveillance look returns plots from; empty where that has no end.
  virtual std::optional<MeasurementBox> coverage() const { return std::nullopt; }
  /// Mean number of false plots per unit of measurement volume (range-bearing: per metre and radian).
  virtual double clutter_density() const { return 0.0; }
  /// The first measurement component lies in [0, this]: where false plots can be.
  virtual double largest_range() const { return std::numeric_limits<double>::infinity(); }

  /// What its plots say of the class of their target; null: nothing.
  const Declaration* declaration() const { return declaration_ ? &*declaration_ : nullptr; }
  void set_declaration(Declaration declaration) { declaration_ = std::move(declaration); }

 private:
  std::optional<Declaration> declaration_;
};

}  // namespace dwell
