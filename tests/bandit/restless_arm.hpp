#pragma once

#include "bandit/restless/problem.hpp"
#include "tests/bandit/scene.hpp"

namespace dwell::testing {

/// A track of one mode under linear sensors as a restless arm; position variance is its cost.
inline restless::Arm arm_of(Scene& scene, const Track& track) {
  const DiscreteBank bank = *scene.situation().bank;
  restless::Arm arm;
  arm.f = bank.f[0];
  arm.q = bank.q[0];
  arm.cost = restless::Matrix::Zero(kStateSize, kStateSize);
  arm.cost(kX, kX) = arm.cost(kY, kY) = 1.0;
  arm.weight = track.weight;
  arm.p0 = track.combined.covariance;
  for (const Sensor* sensor : scene.sensors) {
    arm.sensors.push_back(
        {sensor->jacobian(State::Zero()), sensor->noise(State::Zero()), sensor->detection_probability(State::Zero())});
  }
  return arm;
}

}  // namespace dwell::testing
