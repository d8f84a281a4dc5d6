#pragma once

#include <vector>

#include "bandit/restless/problem.hpp"

namespace dwell::restless::testing {

inline Arm scalar_arm_of(double f, double q, double r, double weight = 1.0, double p_detect = 1.0) {
  const Matrix one = Matrix::Ones(1, 1);
  Arm arm;
  arm.f = f * one;
  arm.q = q * one;
  arm.cost = one;
  arm.weight = weight;
  arm.p0 = r * one;
  arm.sensors = {{one, r * one, p_detect}};
  return arm;
}

/// One axis [x v], T = 1, white-noise acceleration, cost = position variance, one position sensor.
inline Arm constant_velocity_arm(double q, double r, double weight = 1.0, double p_detect = 1.0) {
  Arm arm;
  arm.f.resize(2, 2);
  arm.f << 1, 1, 0, 1;
  arm.q.resize(2, 2);
  arm.q << q / 3, q / 2, q / 2, q;
  arm.cost = Matrix::Zero(2, 2);
  arm.cost(0, 0) = 1.0;
  arm.weight = weight;
  arm.p0.resize(2, 2);
  arm.p0 << r, 0, 0, std::max(q, 0.1 * r);
  Sensor sensor;
  sensor.h.resize(1, 2);
  sensor.h << 1, 0;
  sensor.r = Matrix::Constant(1, 1, r);
  sensor.p_detect = p_detect;
  arm.sensors = {sensor};
  return arm;
}

inline Problem scalars(const std::vector<double>& f, const std::vector<double>& q, const std::vector<double>& r) {
  Problem problem;
  for (std::size_t i = 0; i < f.size(); ++i) problem.arms.push_back(scalar_arm_of(f[i], q[i], r[i]));
  return problem;
}

/// The instances of the published tables.
inline Problem s2a() { return scalars({0.3, 1}, {3, 0.05}, {0.5, 4}); }
inline Problem s2b() {
  Problem problem = scalars({1, 1}, {4, 0.1}, {0.5, 6});
  problem.arms[0].p0(0, 0) = 4.0;
  problem.arms[1].p0(0, 0) = 2.0;
  return problem;
}
inline Problem s4a() { return scalars({0.2, 0.5, 0.95, 1}, {2, 1.5, 0.3, 0.1}, {0.2, 0.5, 4, 8}); }
inline Problem s4b() { return scalars({1, 1, 1, 1}, {1, 0.5, 0.2, 0.1}, {0.5, 2, 5, 10}); }
inline Problem c2() {
  Problem problem;
  problem.arms = {constant_velocity_arm(10, 1), constant_velocity_arm(0.01, 100)};
  return problem;
}
inline Problem c4() {
  Problem problem;
  problem.arms = {constant_velocity_arm(5, 4), constant_velocity_arm(1, 25), constant_velocity_arm(0.1, 100),
                  constant_velocity_arm(0.01, 400)};
  return problem;
}
inline Problem c4w() {
  Problem problem;
  problem.arms = {constant_velocity_arm(1, 25, 1), constant_velocity_arm(1, 100, 2), constant_velocity_arm(0.2, 25, 1),
                  constant_velocity_arm(0.05, 400, 4)};
  return problem;
}
inline Problem c8() {
  Problem problem;
  problem.arms = {constant_velocity_arm(8, 4),      constant_velocity_arm(4, 16),    constant_velocity_arm(2, 25),
                  constant_velocity_arm(1, 25),     constant_velocity_arm(0.5, 100), constant_velocity_arm(0.1, 100),
                  constant_velocity_arm(0.05, 225), constant_velocity_arm(0.01, 400)};
  return problem;
}

/// A sensor that does not see the arm.
inline Sensor blind_sensor(double p_detect = 1.0) { return {Matrix::Zero(1, 1), Matrix::Ones(1, 1), p_detect}; }

}  // namespace dwell::restless::testing
