// What the grid of value sets costs: `index` on tracks against the same index with the exact sets of each target.

#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "bandit/index.hpp"
#include "bandit/restless/bound.hpp"
#include "bandit/restless/covariance.hpp"
#include "bandit/restless/simulate.hpp"
#include "tests/bandit/restless_arm.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

constexpr int kWarmUp = 500;
constexpr int kScans = 4000;

/// Eight tracks of weights 1 to 30 that move alike, one or two sensors of position: axes in any direction, variances
/// over four decades about what a scan adds.
Scene random_targets(std::uint64_t seed) {
  RandomStream random = RandomStream(seed).fork("grid");
  Scene scene;
  const int sensors = random.uniform() < 0.5 ? 1 : 2;
  for (int s = 0; s < sensors; ++s) {
    const Matrix2 turn = Eigen::Rotation2Dd(random.uniform(0.0, std::numbers::pi)).toRotationMatrix();
    const Vector2 variances(std::pow(10.0, random.uniform(0.0, 4.0)), std::pow(10.0, random.uniform(0.0, 4.0)));
    const Matrix2 r = turn * variances.asDiagonal() * turn.transpose();
    scene.add_sensor(std::make_shared<LinearSensor>(position_selector(), r, 1.0));
  }
  for (std::uint32_t number = 1; number <= 8; ++number) {
    const double weight = std::pow(30.0, random.uniform());
    scene.add_track(number, make_estimate({State::Zero(), 1e3 * StateMatrix::Identity()}, Eigen::VectorXd::Ones(1)),
                    weight);
  }
  scene.bank = plain_bank(1);
  return scene;
}

/// Weighted position variance a scan, after the looks.
double cost_of(Policy& policy, Scene scene, const std::vector<restless::Arm>& arms) {
  Decision decision;
  double sum = 0.0;
  for (int scan = 0; scan < kWarmUp + kScans; ++scan) {
    policy.decide(scene.situation(), decision);
    const Pair look = decision.pair(0);
    for (std::size_t i = 0; i < arms.size(); ++i) {
      restless::Matrix p = scene.tracks[i].combined.covariance;
      if (i == look.track) p = restless::look_update(arms[i].sensors[look.sensor], p).covariance;
      if (scan >= kWarmUp) sum += restless::scan_cost(arms[i], p);
      Gaussian& mode = scene.tracks[i].estimate.modes.front();
      mode.covariance = restless::predict(arms[i], p);
      scene.tracks[i].combined = mode;
    }
    ++scene.scans;
  }
  return sum / kScans;
}

TEST(IndexGrid, CostsLittleAgainstExactSets) {
  const int scenes = scaled(40);
  for (const int depth : {1, 2}) {
    double sum = 0.0, squares = 0.0, worst = 0.0;
    for (int seed = 1; seed <= scenes; ++seed) {
      Scene scene = random_targets(static_cast<std::uint64_t>(seed));
      restless::Problem problem;
      for (const Track& track : scene.tracks) problem.arms.push_back(arm_of(scene, track));
      const restless::Analysis analysis = restless::analyse(problem);
      const auto exact = restless::make_policy(restless::IndexSettings{depth}, problem, analysis.priced);
      restless::SimulationSettings settings;
      settings.warm_up = kWarmUp;
      settings.scans = kScans;
      const double best = restless::simulate(problem, *exact, settings).cost;
      Index index(IndexSettings{depth});
      const double loss = 100.0 * (cost_of(index, scene, problem.arms) / best - 1.0);
      sum += loss;
      squares += loss * loss;
      worst = std::max(worst, loss);
      std::printf("depth %d seed %d: %.2f %%\n", depth, seed, loss);
      std::fflush(stdout);
    }
    const double mean = sum / scenes;
    const double error = std::sqrt((squares / scenes - mean * mean) / (scenes - 1));
    std::printf("depth %d: the grid costs %.2f +- %.2f %%, worst %.2f %%\n", depth, mean, error, worst);
    EXPECT_LT(mean, 1.0);
  }
}

}  // namespace
}  // namespace dwell::testing
