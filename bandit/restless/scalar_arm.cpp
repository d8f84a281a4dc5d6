#include "bandit/restless/scalar_arm.hpp"

#include <Eigen/Cholesky>

namespace dwell::restless {

std::optional<ScalarArm> scalar_arm(const Arm& arm, const Sensor& sensor) {
  if (arm.states() != 1) return std::nullopt;
  ScalarArm scalar;
  scalar.f = arm.f(0, 0);
  scalar.q = arm.q(0, 0);
  scalar.r = 1.0 / (sensor.h.transpose() * sensor.r.llt().solve(sensor.h))(0, 0);
  scalar.weight = arm.weight * arm.cost(0, 0);
  scalar.dwell = arm.dwell;
  scalar.p_detect = sensor.p_detect;
  return scalar;
}

}  // namespace dwell::restless
