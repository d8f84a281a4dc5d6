#include "bandit/restless/orbit_index.hpp"

#include <algorithm>

namespace dwell::restless {
namespace {

/// Least difference of discounted looks that is divided by: near 0 both orbits are in phase and the ratio is noise.
constexpr double kLeastWork = 0.05;

Matrix expected_covariance(const Sensor& sensor, const Matrix& predicted) {
  return sensor.p_detect * look_update(sensor, predicted).covariance + (1.0 - sensor.p_detect) * predicted;
}

Matrix best_look(const Arm& arm, const Matrix& predicted) {
  Matrix best = predicted;
  double least = scan_cost(arm, predicted);
  for (const Sensor& sensor : arm.sensors) {
    const Matrix after = expected_covariance(sensor, predicted);
    const double cost = scan_cost(arm, after);
    if (cost >= least) continue;
    least = cost;
    best = after;
  }
  return best;
}

struct Orbit {
  double cost;
  double looks;
};

Orbit follow(const Arm& arm, Matrix after, bool looked, double level, const OrbitSettings& settings) {
  Orbit sum{scan_cost(arm, after), looked ? 1.0 : 0.0};
  double power = 1.0;
  for (int t = 1; t < settings.steps; ++t) {
    power *= settings.discount;
    const Matrix predicted = predict(arm, after);
    const bool look = scan_cost(arm, predicted) >= level;
    after = look ? best_look(arm, predicted) : predicted;
    sum.cost += power * scan_cost(arm, after);
    if (look) sum.looks += power;
  }
  return sum;
}

}  // namespace

double orbit_index(const Arm& arm, std::size_t sensor, const Matrix& predicted, const OrbitSettings& settings) {
  const double level = scan_cost(arm, predicted);
  const Orbit idle = follow(arm, predicted, false, level, settings);
  const Orbit look = follow(arm, expected_covariance(arm.sensors[sensor], predicted), true, level, settings);
  return (idle.cost - look.cost) / std::max(kLeastWork, look.looks - idle.looks) / arm.dwell;
}

}  // namespace dwell::restless
