#include "tracker/track_splitting.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/tracker/matrices.hpp"
#include "tests/tracker/position_sensor.hpp"
#include "tracker/tracker.hpp"

namespace dwell {
namespace {

using matrices::near;

constexpr double kDetection = 0.8;
constexpr double kDensity = 1e-3;
constexpr double kNoGate = std::numeric_limits<double>::infinity();
const Matrix2 kNoise = 9.0 * Matrix2::Identity();

Plot plot_at(double x, double y) { return {kStreamStart, RadarId{1}, {x, y}, std::nullopt}; }

DiscreteBank one_mode() {
  return {.f = {transition(ConstantVelocity{}, 1.0)},
          .q = {white_noise(ConstantVelocity{}, 1.0, 1.0)},
          .transition = Eigen::MatrixXd::Ones(1, 1)};
}

Gaussian start() { return {State::Zero(), State(16.0, 4.0, 16.0, 4.0).asDiagonal()}; }

/// A sequence of plots, one or none from each look, and what the target then is.
struct History {
  double weight = 1.0;
  Gaussian belief = start();
};

/// Every history one look longer, by the filter written out: p (1 - P_d), and p P_d N(z; x, S) / lambda for each plot.
std::vector<History> enumerate(const std::vector<History>& histories, const std::vector<Plot>& plots) {
  const DiscreteBank bank = one_mode();
  std::vector<History> longer;
  for (History history : histories) {
    Gaussian& belief = history.belief;
    belief.mean = bank.f[0] * belief.mean;
    belief.covariance = bank.f[0] * belief.covariance * bank.f[0].transpose() + bank.q[0];
    longer.push_back({history.weight * (1.0 - kDetection), belief});
    const Matrix2 s = position_block(belief.covariance) + kNoise;
    const Gain gain = belief.covariance * position_selector().transpose() * s.inverse();
    for (const Plot& plot : plots) {
      const Vector2 nu = plot.z - position(belief.mean);
      const double density =
          std::exp(-0.5 * nu.dot(s.inverse() * nu)) / (2.0 * std::numbers::pi * std::sqrt(s.determinant()));
      longer.push_back({history.weight * kDetection * density / kDensity,
                        {belief.mean + gain * nu, belief.covariance - gain * s * gain.transpose()}});
    }
  }
  return longer;
}

const std::vector<std::vector<Plot>> kLooks{{plot_at(3.0, 1.0), plot_at(-4.0, 5.0)},
                                            {plot_at(6.0, 0.0), plot_at(-5.0, 8.0), plot_at(9.0, -7.0)}};

// No two histories agree on the plots of two looks: none is merged, and the mixture is that of all twelve.
TEST(TrackSplitting, OverTwoLooksIsTheSumOverAllHistories) {
  const PositionSensor sensor(kNoise, kDetection, kDensity);
  std::vector<History> histories{{}};
  std::vector<TrackComponent> components{{.estimate = make_estimate(start(), Eigen::VectorXd::Ones(1))}};
  std::vector<TrackComponent> predicted;
  TrackSplitting splitting;
  double ratio = 1.0;
  for (const std::vector<Plot>& plots : kLooks) {
    histories = enumerate(histories, plots);
    ASSERT_EQ(predict(one_mode(), components, predicted), Numerics::kOk);
    TrackSplitting::Outcome outcome;
    ASSERT_EQ(splitting.look(sensor, UpdateForm::kEkf, kNoGate, State::Zero(), plots, predicted, outcome),
              Numerics::kOk);
    std::swap(components, predicted);
    ratio *= outcome.likelihood_ratio;
  }
  ASSERT_EQ(components.size(), 12U);
  double total = 0.0;
  for (const History& history : histories) total += history.weight;
  EXPECT_NEAR(ratio, total, 1e-12 * total);
  Gaussian mixture;
  for (const History& history : histories) mixture.mean += history.weight / total * history.belief.mean;
  for (const History& history : histories) {
    const State off = history.belief.mean - mixture.mean;
    mixture.covariance += history.weight / total * (history.belief.covariance + off * off.transpose());
  }
  const Gaussian actual = combine(merged(components));
  EXPECT_TRUE(near(actual.mean, mixture.mean, 1e-12 * State(4.0, 2.0, 4.0, 2.0)));
  EXPECT_TRUE(near(actual.covariance, mixture.covariance, 1e-12 * matrices::scale_of(mixture.covariance)));
}

// A third look makes 12 x 2, of which those that agree on the plots of the last two are one: 4 x 2.
TEST(TrackSplitting, WhatAgreesOnTheLastTwoLooksIsMerged) {
  const PositionSensor sensor(kNoise, kDetection, kDensity);
  std::vector<TrackComponent> components{{.estimate = make_estimate(start(), Eigen::VectorXd::Ones(1))}};
  TrackSplitting splitting;
  TrackSplitting::Outcome outcome;
  for (const std::vector<Plot>& plots : {kLooks[0], kLooks[1], {plot_at(4.0, 0.0)}}) {
    ASSERT_EQ(splitting.look(sensor, UpdateForm::kEkf, kNoGate, State::Zero(), plots, components, outcome),
              Numerics::kOk);
  }
  EXPECT_EQ(components.size(), 8U);
  EXPECT_EQ(outcome.likeliest, 0U);
}

// A crowd of plots: few components stay, likeliest first, and weigh one.
TEST(TrackSplitting, KeepsTheLikeliest) {
  const PositionSensor sensor(kNoise, kDetection, 0.1);
  std::vector<TrackComponent> components{{.estimate = make_estimate(start(), Eigen::VectorXd::Ones(1))}};
  RandomStream stream(1);
  TrackSplitting splitting;
  TrackSplitting::Outcome outcome;
  std::vector<Plot> plots;
  for (int i = 0; i < 40; ++i) plots.push_back(plot_at(10.0 * stream.normal(), 10.0 * stream.normal()));
  for (int look = 0; look < 3; ++look) {
    ASSERT_EQ(splitting.look(sensor, UpdateForm::kEkf, 16.0, State::Zero(), plots, components, outcome), Numerics::kOk);
  }
  EXPECT_EQ(components.size(), TrackSplitting::kMostComponents);
  double sum = 0.0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    sum += components[i].weight;
    EXPECT_LE(components[i].weight, i > 0 ? components[i - 1].weight : 1.0);
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

// By way of the tracker: a first look leaves what IPDA leaves, but for what is too unlikely to be kept. From there on
// the two part: the accounts are kept.
TEST(TrackSplitting, FirstLookIsThatOfIpda) {
  const PositionSensor sensor(kNoise, kDetection, kDensity);
  const Dwell dwell{RadarId{1}, TrackId{1}, kStreamStart, State::Zero()};
  const auto track_of = [&](Association association) {
    Tracker tracker(one_mode(), Eigen::VectorXd::Ones(1), {.association = association});
    Track track = tracker.start(TrackId{1}, "", start());
    tracker.predict(track);
    EXPECT_EQ(tracker.look(track, sensor, dwell, kLooks[0]).used_plot, 0U);
    return track;
  };
  const Track split = track_of(Association::kIts);
  const Track pda = track_of(Association::kIpda);
  EXPECT_EQ(split.components.size(), 3U);
  EXPECT_TRUE(near(split.combined.mean, pda.combined.mean, 1e-12));
  EXPECT_TRUE(near(split.combined.covariance, pda.combined.covariance, 1e-12));
  EXPECT_NEAR(*split.existence, *pda.existence, 1e-12);
  EXPECT_NEAR(*split.nis, *pda.nis, 1e-12);
}

// One component's numbers fail: the track begins anew, and is whole.
TEST(TrackSplitting, FailuresRestartTheTrack) {
  const PositionSensor sensor(kNoise, kDetection, kDensity);
  const Dwell dwell{RadarId{1}, TrackId{1}, kStreamStart, State::Zero()};
  Tracker tracker(one_mode(), Eigen::VectorXd::Ones(1), {.association = Association::kIts});
  Track track = tracker.start(TrackId{1}, "", start());
  (void)tracker.look(track, sensor, dwell, kLooks[0]);
  ASSERT_GT(track.components.size(), 1U);
  track.components.back().estimate.modes[0].covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  (void)tracker.look(track, sensor, dwell, kLooks[1]);
  EXPECT_EQ(tracker.failures(), 1U);
  EXPECT_TRUE(track.alive());
  EXPECT_TRUE(track.components.empty());
  (void)tracker.look(track, sensor, dwell, kLooks[1]);
  EXPECT_EQ(track.status, TrackStatus::kConfirmed);
}

}  // namespace
}  // namespace dwell
