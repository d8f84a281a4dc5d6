#include "bandit/predicted_paths.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "bandit/averaged_paths.hpp"
#include "tests/bandit/scene.hpp"
#include "tests/scale.hpp"
#include "tracker/footprint.hpp"

namespace dwell::testing {
namespace {

/// Without a look the path is the filter's own prediction, mode by mode.
TEST(PredictedPaths, WithoutALookAreWhatTheFilterPredicts) {
  for (int seed = 0; seed < scaled(20); ++seed) {
    Scene scene = random_scene(2, static_cast<std::uint64_t>(seed));
    const Situation situation = scene.situation();
    PredictedPaths paths;
    paths.lay(situation, 4);
    for (std::size_t track = 0; track < 2; ++track) {
      ImmEstimate estimate = scene.tracks[track].estimate;
      for (int scan = 0; scan < 4; ++scan) {
        const PredictedPaths::Belief belief = paths.idle(track, scan);
        double cost = 0.0;
        for (std::size_t j = 0; j < 2; ++j) {
          const StateMatrix& expected = estimate.modes[j].covariance;
          EXPECT_TRUE(paths.covariances(belief)[j].isApprox(expected, 1e-12));
          EXPECT_NEAR(paths.probability(track, scan, j), estimate.probability[static_cast<Eigen::Index>(j)], 1e-14);
          cost += estimate.probability[static_cast<Eigen::Index>(j)] * (expected(kX, kX) + expected(kY, kY));
        }
        EXPECT_NEAR(paths.cost(belief), scene.tracks[track].weight * cost, 1e-12 * paths.cost(belief));
        ImmEstimate next;
        ASSERT_EQ(predict(scene.bank, estimate, next), Numerics::kOk);
        estimate = next;
      }
    }
  }
}

/// The first look: each mode's Kalman step, p of it, at the filter's own linearisation.
TEST(PredictedPaths, TheFirstLookIsTheFiltersUpdate) {
  for (int seed = 0; seed < scaled(20); ++seed) {
    Scene scene = random_scene(1, static_cast<std::uint64_t>(seed));
    const Situation situation = scene.situation();
    PredictedPaths paths;
    paths.lay(situation, 1);
    const ImmEstimate& estimate = scene.tracks[0].estimate;
    for (std::size_t s = 0; s < scene.sensors.size(); ++s) {
      std::vector<PredictedMeasurement> seen;
      ASSERT_EQ(predict_measurements(*scene.sensors[s], scene.update, estimate, seen), Numerics::kOk);
      const double p = paths.detection(0, 0, s);
      const PredictedPaths::Belief belief = paths.after(paths.start(0), 1 + static_cast<int>(s));
      for (std::size_t j = 0; j < 2; ++j) {
        const StateMatrix& prior = estimate.modes[j].covariance;
        const StateMatrix after = updated_covariance(prior, seen[j], kalman_gain(prior, seen[j]));
        EXPECT_TRUE(paths.covariances(belief)[j].isApprox(p * after + (1.0 - p) * prior, 1e-12));
      }
    }
  }
}

/// What bounds rest on: more looks leave nowhere more, and all sensors at once nowhere more than any one.
TEST(PredictedPaths, EverySensorAtOnceIsBelowEachOfThem) {
  for (int seed = 0; seed < scaled(30); ++seed) {
    Scene scene = random_scene(1, static_cast<std::uint64_t>(seed));
    const Situation situation = scene.situation();
    PredictedPaths paths;
    paths.lay(situation, 2);
    const auto all = paths.after(paths.start(0), paths.every_sensor());
    const auto all_twice = paths.after(all, paths.every_sensor());
    for (int s = 0; s <= 3; ++s) {
      const auto one = paths.after(paths.start(0), s);
      const auto both = paths.after(one, s);
      for (std::size_t j = 0; j < 2; ++j) {
        const auto below = [&](PredictedPaths::Belief low, PredictedPaths::Belief high) {
          const StateMatrix gap = paths.covariances(high)[j] - paths.covariances(low)[j];
          return gap.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff() >=
                 -1e-10 * paths.covariances(high)[j].trace();
        };
        EXPECT_TRUE(below(all, one));
        EXPECT_TRUE(below(all_twice, both));
      }
    }
  }
}

/// Homogeneous: noise and covariance times a factor, the outcome times the factor.
TEST(PredictedPaths, ScaleMultipliesNoiseAndNothingElse) {
  Scene scene = random_scene(1, 7);
  Scene wide = random_scene(1, 7);
  constexpr double kScale = 1.3;
  for (Gaussian& mode : wide.tracks[0].estimate.modes) mode.covariance *= kScale;
  const Situation situation = scene.situation();
  const Situation wide_situation = wide.situation();
  PredictedPaths paths;
  PredictedPaths scaled_paths(kScale);
  paths.lay(situation, 3);
  scaled_paths.lay(wide_situation, 3);
  auto belief = paths.start(0);
  auto wide_belief = scaled_paths.start(0);
  for (const int choice : {1, 0, 3}) {
    belief = paths.after(belief, choice);
    wide_belief = scaled_paths.after(wide_belief, choice);
    for (std::size_t j = 0; j < 2; ++j) {
      // The footprint's probability is that of the wider belief: all but one here.
      EXPECT_TRUE(scaled_paths.covariances(wide_belief)[j].isApprox(kScale * paths.covariances(belief)[j], 1e-9));
    }
  }
}

TEST(AveragedPaths, TheGradientIsThatOfTheBound) {
  for (int seed = 0; seed < scaled(10); ++seed) {
    Scene scene = random_scene(2, static_cast<std::uint64_t>(seed));
    const Situation situation = scene.situation();
    PredictedPaths paths;
    paths.lay(situation, 3);
    AveragedPaths averaged;
    RandomStream stream(static_cast<std::uint64_t>(seed));
    std::vector<double> q(scene.feasible.size());
    for (double& share : q) share = stream.uniform(0.02, 0.15);
    std::vector<double> gradient(q.size());
    std::vector<double> unused(q.size());
    const double bound = averaged.bound(paths, scene.feasible, q, gradient);
    for (std::size_t i = 0; i < q.size(); ++i) {
      constexpr double kStep = 1e-5;  // central differences: error 1e-10 relative, rounding 1e-11
      std::vector<double> high = q, low = q;
      high[i] += kStep;
      low[i] -= kStep;
      const double slope =
          (averaged.bound(paths, scene.feasible, high, unused) - averaged.bound(paths, scene.feasible, low, unused)) /
          (2.0 * kStep);
      EXPECT_NEAR(gradient[i], slope, 1e-5 * bound);
    }
  }
}

/// With all the probability on one pair the bound is the cost of that schedule.
TEST(AveragedPaths, OfACertainChoiceIsItsCost) {
  Scene scene = random_scene(1, 3);
  const Situation situation = scene.situation();
  PredictedPaths paths;
  paths.lay(situation, 3);
  AveragedPaths averaged;
  std::vector<double> q{0.0, 1.0, 0.0};
  std::vector<double> gradient(3);
  auto belief = paths.start(0);
  double cost = 0.0;
  for (int scan = 0; scan < 3; ++scan) cost += paths.cost(belief = paths.after(belief, 2));
  EXPECT_NEAR(averaged.bound(paths, scene.feasible, q, gradient), cost, 1e-12 * cost);
}

}  // namespace
}  // namespace dwell::testing
