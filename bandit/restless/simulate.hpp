#pragma once

#include "bandit/restless/policy.hpp"
#include "radar/random.hpp"

namespace dwell::restless {

struct SimulationSettings {
  int warm_up = 2000;   ///< average cost: scans that do not count
  int scans = 20'000;   ///< average cost: scans that do
  double rest = 1e-12;  ///< discounted: until b^t is below
  RandomStream random = RandomStream(1);
};

struct Simulated {
  double cost = 0.0;              ///< a scan, or discounted
  std::vector<double> look_rate;  ///< looks a scan at each arm
};

/// Runs a policy from its start and p0. An average weights the scans by what rises smoothly over their first quarter
/// and falls over the last (smooth_step): a period need not divide them. Look rates are plain counts.
///
/// Detections are drawn for every arm in every scan, whether it is looked at or not, from streams forked by the arm:
/// policies meet the same luck.
Simulated simulate(const Problem& problem, Policy& policy, const SimulationSettings& settings);

}  // namespace dwell::restless
