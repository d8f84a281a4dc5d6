#pragma once

#include <cmath>
#include <optional>

#include "bandit/restless/problem.hpp"

namespace dwell::restless {

/// An arm of one state and one sensor, in plain numbers.
///
///   look at predicted variance p:   m = p r / (p + r)          next predicted variance   f^2 m + q
struct ScalarArm {
  double f = 1.0;
  double q = 0.0;
  double r = 1.0;       ///< of the state: R / H^2, or 1 / (H' R^-1 H); infinite where the sensor does not see it
  double weight = 1.0;  ///< times the cost's only element
  double dwell = 1.0;
  double p_detect = 1.0;

  bool blind() const { return !std::isfinite(r); }
  double after_look(double p) const { return blind() ? p : p * (r / (p + r)); }
  double predict(double m) const { return f * f * m + q; }
};

/// The arm seen by one of its sensors alone; empty where it has more states than one.
std::optional<ScalarArm> scalar_arm(const Arm& arm, const Sensor& sensor);

}  // namespace dwell::restless
