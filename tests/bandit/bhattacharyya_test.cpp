#include "bandit/bhattacharyya.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/bandit/scene.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

double bound(const PredictedState& state) {
  std::vector<PredictedMeasurement> predicted;
  EXPECT_EQ(predict_measurements(*state.sensor, state.update, state.estimate, predicted), Numerics::kOk);
  return bhattacharyya_bound(*state.sensor, state.update, state.estimate.probability, predicted);
}

PredictedState two_modes(double c, double variance_a, double variance_b, double apart) {
  const auto sensor = std::make_shared<LinearSensor>(position_selector(), Matrix2::Identity(), 1.0);
  PredictedState state{"", make_estimate({}, Eigen::Vector2d(c, 1.0 - c)), sensor, UpdateForm::kEkf};
  state.estimate.modes[0].covariance = variance_a * StateMatrix::Identity();
  state.estimate.modes[1].covariance = variance_b * StateMatrix::Identity();
  state.estimate.modes[1].mean[kX] = apart;
  return state;
}

/// S = I (P + R of 1 + 3): k = d^2 / 8 / 4. S = 2 and 8: |mean| / sqrt(|S_a| |S_b|) = 25 / 16.
TEST(Bhattacharyya, HandValues) {
  EXPECT_NEAR(bound(two_modes(0.5, 3.0, 3.0, 0.0)), 0.5, 1e-15);
  EXPECT_NEAR(bound(two_modes(0.8, 3.0, 3.0, 4.0)), 0.4 * std::exp(-0.5), 1e-15);
  EXPECT_NEAR(bound(two_modes(0.5, 1.0, 7.0, 0.0)), 0.5 * std::sqrt(16.0 / 25.0), 1e-15);
}

/// Two modes of equal S, d sigma apart: the likeliest mode is wrong with probability
/// c_1 Phi(-(d / 2 + l / d)) + c_2 Phi(-(d / 2 - l / d)), l = log(c_1 / c_2).
TEST(Bhattacharyya, IsABoundOnTheModeError) {
  for (const double c : {0.5, 0.7, 0.99}) {
    for (const double d : {0.5, 1.0, 2.0, 4.0}) {
      const double l = std::log(c / (1.0 - c)) / d;
      const auto below = [](double x) { return 0.5 * std::erfc(x / std::sqrt(2.0)); };
      const double error = c * below(0.5 * d + l) + (1.0 - c) * below(0.5 * d - l);
      EXPECT_GE(bound(two_modes(c, 3.0, 3.0, 2.0 * d)), error) << c << " " << d;
    }
  }
}

/// sum sqrt(c_i c_j) exp(-k) with k >= 0: a look never raises the bound.
TEST(Bhattacharyya, NoScoreIsNegative) {
  Bhattacharyya policy{BhattacharyyaSettings{}};
  Decision decision;
  for (int seed = 0; seed < scaled(100); ++seed) {
    Scene scene = random_scene(3, static_cast<std::uint64_t>(seed));
    policy.decide(scene.situation(), decision);
    for (const Candidate& candidate : decision.candidates) EXPECT_GE(candidate.score, 0.0);
  }
}

/// Weight 3, P_d .5, c = (.8, .2), k = 1/2.
TEST(Bhattacharyya, TheScoreIsTheFallOfTheBound) {
  Scene scene;
  scene.add_sensor(std::make_shared<LinearSensor>(position_selector(), Matrix2::Identity(), 0.5));
  scene.add_track(1, two_modes(0.8, 3.0, 3.0, 4.0).estimate, 3.0);
  Bhattacharyya policy{BhattacharyyaSettings{}};
  Decision decision;
  policy.decide(scene.situation(), decision);
  EXPECT_NEAR(decision.candidates[0].score, 3.0 * 0.5 * 0.4 * (1.0 - std::exp(-0.5)), 1e-15);
}

TEST(Bhattacharyya, APairThatFailsIsOfNoUse) {
  Scene scene;
  scene.add_sensor(std::make_shared<LinearSensor>(position_selector(), Matrix2::Identity(), 1.0));
  scene.add_track(1, two_modes(0.5, 3.0, 3.0, 4.0).estimate);
  scene.add_track(2, two_modes(0.5, -3.0, 3.0, 4.0).estimate);
  Bhattacharyya policy{BhattacharyyaSettings{}};
  Decision decision;
  policy.decide(scene.situation(), decision);
  EXPECT_GT(decision.candidates[0].score, 0.0);
  EXPECT_EQ(decision.candidates[1].score, 0.0);
}

}  // namespace
}  // namespace dwell::testing
