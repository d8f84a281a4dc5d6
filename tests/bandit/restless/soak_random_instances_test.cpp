// Random instances, seeds 1 .. 200, none chosen: each policy's gap, and how often the index policy loses to the myopic
// rule.

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "bandit/restless/bound.hpp"
#include "bandit/restless/simulate.hpp"
#include "radar/random.hpp"
#include "tests/bandit/restless/instances.hpp"
#include "tests/scale.hpp"

namespace dwell::restless::testing {
namespace {

/// Two to four arms: one state or position and velocity, one to three sensors, P_d = 1 or .5 .. 1, weights 1 .. 4.
Problem random_problem(std::uint64_t seed) {
  RandomStream random = RandomStream(seed).fork("restless");
  const bool scalar = random.uniform() < 0.5;
  const bool misses = random.uniform() < 0.5;
  const int arms = 2 + static_cast<int>(3.0 * random.uniform());
  const int sensors = 1 + static_cast<int>(3.0 * random.uniform());
  Problem problem;
  for (int i = 0; i < arms; ++i) {
    const double q = std::pow(10.0, random.uniform(-2.0, 1.0));
    const double r = std::pow(10.0, random.uniform(-1.0, 2.0));
    const double weight = random.uniform(1.0, 4.0);
    Arm arm = scalar ? scalar_arm_of(random.uniform(0.3, 1.0), q, r, weight) : constant_velocity_arm(q, r, weight);
    const Sensor first = arm.sensors.front();
    for (int s = 1; s < sensors; ++s) {
      arm.sensors.push_back(first);
      arm.sensors.back().r *= std::pow(10.0, random.uniform(-0.5, 0.5));
    }
    for (Sensor& sensor : arm.sensors) sensor.p_detect = misses ? random.uniform(0.5, 1.0) : 1.0;
    problem.arms.push_back(std::move(arm));
  }
  return problem;
}

TEST(RestlessSoak, IndexOverRandomInstances) {
  const int instances = scaled(200);
  double sum_index = 0.0;
  double sum_myopic = 0.0;
  double worst = 0.0;
  int wins = 0;
  int losses = 0;
  for (int seed = 1; seed <= instances; ++seed) {
    const Problem problem = random_problem(static_cast<std::uint64_t>(seed));
    const Analysis analysis = analyse(problem);
    bool misses = false;
    for (const Sensor& sensor : problem.arms.front().sensors) misses = misses || sensor.p_detect < 1.0;
    const int runs = misses ? 10 : 1;
    double index = 0.0, myopic = 0.0, difference = 0.0, squares = 0.0;
    for (int run = 0; run < runs; ++run) {
      SimulationSettings settings;
      settings.seed = static_cast<std::uint64_t>(1000 * seed + run);
      settings.scans = 4000;
      settings.warm_up = 500;
      const double a = simulate(problem, *make_policy(IndexSettings{2}, problem, analysis.priced), settings).cost;
      const double b = simulate(problem, *make_policy(MyopicSettings{}, problem, analysis.priced), settings).cost;
      index += a / runs;
      myopic += b / runs;
      difference += (a - b) / runs;
      squares += (a - b) * (a - b) / runs;
    }
    // Student's t, 9 degrees: 2.262.
    const double spread = runs > 1 ? std::sqrt(std::max(0.0, squares - difference * difference) / (runs - 1)) : 0.0;
    const double gap = 100.0 * (index / analysis.bound.value - 1.0);
    sum_index += gap;
    sum_myopic += 100.0 * (myopic / analysis.bound.value - 1.0);
    worst = std::max(worst, gap);
    if (difference < 0.0) ++wins;
    if (difference - 2.262 * spread > 0.005 * myopic) {
      ++losses;
      std::printf("seed %d: index %.6g, sa_imm %.6g, bound %.6g\n", seed, index, myopic, analysis.bound.value);
    }
  }
  std::printf(
      "%d instances: mean gap index %.2f %%, sa_imm %.2f %%; worst of index %.2f %%; index better in %d, "
      "worse by over .5 %% beyond its interval in %d\n",
      instances, sum_index / instances, sum_myopic / instances, worst, wins, losses);
  EXPECT_LT(sum_index, sum_myopic);
}

}  // namespace
}  // namespace dwell::restless::testing
