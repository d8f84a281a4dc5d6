#include "bandit/restless/simulate.hpp"

#include <algorithm>
#include <cmath>

#include "bandit/restless/covariance.hpp"
#include "bandit/restless/smooth_step.hpp"

namespace dwell::restless {
namespace {

/// Part of the scans over which the weights of an average rise, and fall.
constexpr double kRise = 0.25;

/// Of scan t of `scans`.
double average_weight(int t, int scans) {
  const double u = (t + 0.5) / scans;
  return smooth_step(u / kRise) * smooth_step((1.0 - u) / kRise);
}

}  // namespace

Simulated simulate(const Problem& problem, Policy& policy, const SimulationSettings& settings) {
  const std::size_t arms = problem.arms.size();
  std::vector<Matrix> predicted;
  std::vector<RandomStream> luck;
  double bucket_size = problem.looks_per_scan;
  const RandomStream root = settings.random.fork("detections");
  for (std::size_t i = 0; i < arms; ++i) {
    predicted.push_back(problem.arms[i].p0);
    luck.push_back(root.fork(static_cast<std::uint64_t>(i)));
    bucket_size = std::max(bucket_size, problem.arms[i].dwell);
  }
  const bool average = !problem.discount;
  const int first = average ? settings.warm_up : 0;
  const int last = average ? settings.warm_up + settings.scans
                           : 1 + static_cast<int>(std::ceil(std::log(settings.rest) / std::log(*problem.discount)));
  Simulated result;
  result.look_rate.assign(arms, 0.0);
  double bucket = 0.0;
  double power = 1.0;
  double weights = 0.0;
  policy.reset();
  std::vector<Look> looks;
  std::vector<Matrix> after(arms);
  for (int t = 0; t < last; ++t) {
    bucket = std::min(bucket_size, bucket + problem.looks_per_scan);
    policy.choose(predicted, bucket, looks);
    after = predicted;
    std::vector<double> draws(arms);
    for (std::size_t i = 0; i < arms; ++i) draws[i] = luck[i].uniform();
    for (const Look& look : looks) {
      const Arm& arm = problem.arms[look.arm];
      const Sensor& sensor = arm.sensors[look.sensor];
      bucket -= arm.dwell;
      if (draws[look.arm] < sensor.p_detect) after[look.arm] = look_update(sensor, predicted[look.arm]).covariance;
      if (t >= first) result.look_rate[look.arm] += 1.0;
    }
    const double weight = !average ? power : t >= first ? average_weight(t - first, settings.scans) : 0.0;
    double cost = 0.0;
    for (std::size_t i = 0; i < arms; ++i) {
      cost += scan_cost(problem.arms[i], after[i]);
      predicted[i] = predict(problem.arms[i], after[i]);
    }
    result.cost += weight * cost;
    weights += weight;
    if (!average) power *= *problem.discount;
  }
  const double counted = last - first;
  for (double& rate : result.look_rate) rate /= counted;
  if (average) result.cost /= weights;
  return result;
}

}  // namespace dwell::restless
