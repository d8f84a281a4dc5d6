#include "bandit/largest_variance.hpp"

#include <gtest/gtest.h>

#include "tests/bandit/expected_cost_oracle.hpp"
#include "tests/bandit/scene.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

double weighted_variance(const Track& track) { return track.weight * cost_parts(track.estimate).position; }

/// Expected reduction of the position variance by the oracle.
double reduction(const Scene& scene, const Track& track, std::size_t sensor) {
  const PredictedState state{"", track.estimate, scene.owned[sensor], scene.update};
  return cost_parts(track.estimate).position - oracle_parts(state).position;
}

TEST(LargestVariance, LooksAtTheLargestWeightedVarianceWithItsBestSensor) {
  LargestVariance policy{LargestVarianceSettings{}};
  Decision decision;
  for (int seed = 0; seed < scaled(100); ++seed) {
    Scene scene = random_scene(4, static_cast<std::uint64_t>(seed));
    policy.decide(scene.situation(), decision);
    const Track& chosen = scene.tracks[decision.pair(0).track];
    for (const Track& track : scene.tracks)
      EXPECT_LE(weighted_variance(track), weighted_variance(chosen) * (1.0 + 1e-12));
    for (std::size_t s = 0; s < scene.sensors.size(); ++s) {
      // The policy's rule is within 2 % of the variance of each reduction.
      EXPECT_LE(reduction(scene, chosen, s),
                reduction(scene, chosen, decision.pair(0).sensor) + 0.04 * cost_parts(chosen.estimate).position);
    }
  }
}

/// Variances 2 and 18, weights 10 and 1: 20 against 18.
TEST(LargestVariance, TheWeightCounts) {
  LargestVariance policy{LargestVarianceSettings{}};
  Scene scene = plain_scene(2, {1, 2});
  for (Gaussian& mode : scene.tracks[1].estimate.modes) mode.covariance *= 9.0;
  Decision decision;
  policy.decide(scene.situation(), decision);
  EXPECT_EQ(choice_of(scene, decision), Choice(1, 2));
  EXPECT_DOUBLE_EQ(decision.candidates[decision.chosen[0]].score, 18.0);
  scene.tracks[0].weight = 10.0;
  policy.decide(scene.situation(), decision);
  EXPECT_EQ(choice_of(scene, decision), Choice(1, 1));
  EXPECT_DOUBLE_EQ(decision.candidates[decision.chosen[0]].score, 20.0);
}

/// One mode, P = I on x and y: r = 1 takes 1 of 2 away, r = 3 takes .5, so its share is a half.
TEST(LargestVariance, TheScoreIsSharedByWhatASensorReduces) {
  LargestVariance policy{LargestVarianceSettings{}};
  Scene scene = plain_scene(1, {1});
  scene.add_sensor(std::make_shared<LinearSensor>(position_selector(), 3.0 * Matrix2::Identity(), 1.0));
  Decision decision;
  policy.decide(scene.situation(), decision);
  EXPECT_NEAR(decision.candidates[0].score, 2.0, 1e-14);
  EXPECT_NEAR(decision.candidates[1].score, 1.0, 1e-14);
}

/// A track whose numbers fail with one sensor is looked at with another; with all, it keeps its place.
TEST(LargestVariance, APairThatFailsIsOfNoUse) {
  LargestVariance policy{LargestVarianceSettings{}};
  Scene scene = plain_scene(1, {1, 2});
  const MeasurementJacobian velocity = (MeasurementJacobian() << 0, 1, 0, 0, 0, 0, 0, 1).finished();
  scene.add_sensor(std::make_shared<LinearSensor>(velocity, Matrix2::Identity(), 1.0));
  scene.tracks[0].estimate.modes[0].covariance *= 5.0;
  scene.tracks[0].estimate.modes[0].covariance(kVx, kVx) = -7.0;  // S of the second sensor is indefinite
  Decision decision;
  policy.decide(scene.situation(), decision);
  EXPECT_EQ(choice_of(scene, decision), Choice(1, 1));
  EXPECT_EQ(decision.candidates[1].score, 0.0);
}

}  // namespace
}  // namespace dwell::testing
