#include "tracker/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "radar/linear_sensor.hpp"
#include "radar/range_bearing_radar.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"
#include "tests/tracker/matrices.hpp"
#include "tests/tracker/position_sensor.hpp"

namespace dwell {
namespace {

using matrices::kEpsilon;
using matrices::near;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Sees position with 1-sigma 3 m on each axis.
LinearSensor position_sensor(double detection_probability = 0.9) {
  return {position_selector(), 9.0 * Matrix2::Identity(), detection_probability};
}

/// One mode of constant velocity without noise, over one second.
Tracker one_mode_tracker(const TrackerSettings& settings = {}) {
  return {{{transition(ConstantVelocity{}, 1.0)}, {StateMatrix::Zero()}, Eigen::MatrixXd::Ones(1, 1)},
          Eigen::VectorXd::Ones(1),
          settings};
}

Tracker named_tracker(std::string_view name, const TrackerSettings& settings = {}) {
  const ModeBank bank = named_bank(name).value();
  return {discretise(bank, 1.0).value(), bank.initial_probability, settings};
}

/// At the origin with 1-sigma 4 m: S = (16 + 9) I against the sensor above, so that 5 m are one sigma.
Gaussian belief_at_origin() { return {State::Zero(), State(16.0, 1.0, 16.0, 1.0).asDiagonal()}; }

const Dwell kDwell{RadarId{2}, TrackId{1}, kStreamStart + from_seconds(7.0), State::Zero()};

Plot plot_at(double z0, double z1) { return {kDwell.time, kDwell.radar, {z0, z1}, std::nullopt}; }
Plot plot_at_sigmas(double sigmas) { return plot_at(5.0 * sigmas, 0.0); }

LookOutcome look(Tracker& tracker, Track& track, const std::vector<Plot>& plots,
                 const Sensor& sensor = position_sensor()) {
  return tracker.look(track, sensor, kDwell, plots);
}

void expect_same_belief(const Track& actual, const Track& expected) {
  EXPECT_EQ(actual.estimate.probability, expected.estimate.probability);
  for (std::size_t j = 0; j < expected.estimate.modes.size(); ++j) {
    EXPECT_EQ(actual.estimate.modes[j].mean, expected.estimate.modes[j].mean);
    EXPECT_EQ(actual.estimate.modes[j].covariance, expected.estimate.modes[j].covariance);
  }
  EXPECT_EQ(actual.combined.mean, expected.combined.mean);
  EXPECT_EQ(actual.combined.covariance, expected.combined.covariance);
}

TEST(Start, GivesAConfirmedTrackOfTheBelief) {
  const Tracker tracker = named_tracker("cruise_and_turn");
  const Track track = tracker.start(TrackId{3}, "three", belief_at_origin());
  EXPECT_EQ(track.id, TrackId{3});
  EXPECT_EQ(track.name, "three");
  EXPECT_EQ(track.status, TrackStatus::kConfirmed);
  EXPECT_TRUE(track.alive());
  EXPECT_FALSE(track.last_look || track.nis || track.loss);
  EXPECT_EQ(track.age_scans, 0);
  EXPECT_EQ(track.estimate.probability, named_bank("cruise_and_turn")->initial_probability);
  ASSERT_EQ(track.estimate.size(), tracker.modes());
  for (const Gaussian& mode : track.estimate.modes) {
    EXPECT_EQ(mode.mean, belief_at_origin().mean);
    EXPECT_EQ(mode.covariance, belief_at_origin().covariance);
  }
  EXPECT_EQ(track.combined.covariance, belief_at_origin().covariance);
}

TEST(BeliefFrom, IsEmptyWhereAPlotIsNoPosition) {
  EXPECT_FALSE(Tracker::belief_from(plot_at(1.0, 2.0), position_sensor(), 100.0));
}

TEST(BeliefFrom, HasTheVelocityGivenAndIsExactlySymmetric) {
  const RangeBearingRadar radar{RadarFigures{}};
  for (double azimuth = -3.0; azimuth < 3.0; azimuth += 0.1) {
    const Gaussian belief = Tracker::belief_from(plot_at(8e4, azimuth), radar, 250.0).value();
    EXPECT_EQ(velocity(belief.mean), Vector2(0.0, 0.0));
    EXPECT_EQ(belief.covariance(kVx, kVx), 62500.0);
    EXPECT_EQ(belief.covariance(kVy, kVy), 62500.0);
    EXPECT_EQ(belief.covariance(kVx, kVy), 0.0);
    EXPECT_EQ(belief.covariance, belief.covariance.transpose()) << azimuth;
    EXPECT_GT(matrices::smallest_pivot(belief.covariance), 0.0);
  }
}

// Errors of the believed places, whitened by the believed covariance, are N(0, I): their sample moments are
// sums of squares of independent standard normals, N chi-square on each axis, and of u + v and u - v for the
// cross term. The conversion's bias, sigma_azimuth^2 R / 2 = 0.05 m against 7 m, is far below what the count
// resolves.
TEST(BeliefFrom, CovarianceIsThatOfThePlots) {
  RadarFigures figures;
  figures.snr_reference = 0.5;
  figures.beamwidth_rad = 1.6e-3;  // 7.5 m along, 1e-3 rad = 100 m across, at 100 km
  const RangeBearingRadar radar(figures);
  const int count = scaled(20000);
  for (const double azimuth : {0.3, 2.0, -1.2, 3.14}) {
    RandomStream stream(1);
    const Vector2 truth = to_cartesian({0.0, 0.0}, {1e5, azimuth});
    Matrix2 moments = Matrix2::Zero();
    Matrix2 turned_moments = Matrix2::Zero();  // the twin: as if x and y had changed places
    for (int i = 0; i < count; ++i) {
      const Vector2 z(1e5 + 7.5 * stream.normal(), wrap_angle(azimuth + 1e-3 * stream.normal()));
      const Gaussian belief = Tracker::belief_from({kDwell.time, kDwell.radar, z, std::nullopt}, radar, 1.0).value();
      const Matrix2 p = position_block(belief.covariance);
      const Vector2 error = position(belief.mean) - truth;
      const Vector2 white = p.llt().matrixL().solve(error);
      moments += white * white.transpose();
      const Vector2 turned = p.reverse().llt().matrixL().solve(error);
      turned_moments += turned * turned.transpose();
    }
    const statistics::Band band = statistics::chi_square_band(count);
    EXPECT_TRUE(band.contains(moments(0, 0))) << moments / count;
    EXPECT_TRUE(band.contains(moments(1, 1))) << moments / count;
    EXPECT_TRUE(band.contains(0.5 * (moments(0, 0) + moments(1, 1)) + moments(0, 1))) << moments / count;
    EXPECT_TRUE(band.contains(0.5 * (moments(0, 0) + moments(1, 1)) - moments(0, 1))) << moments / count;
    EXPECT_FALSE(band.contains(turned_moments(0, 0)) && band.contains(turned_moments(1, 1)));
  }
}

TEST(BeliefFrom, OverTheRadarIsFinite) {
  const RangeBearingRadar radar{RadarFigures{}};
  for (const double range_m : {0.0, 1e-12, 0.5}) {
    const Gaussian belief = Tracker::belief_from(plot_at(range_m, 1.0), radar, 100.0).value();
    EXPECT_TRUE(belief.mean.allFinite() && belief.covariance.allFinite()) << range_m;
    EXPECT_GT(matrices::smallest_pivot(belief.covariance), 0.0) << range_m;
  }
}

TEST(Predict, MovesTheTrackOnAndCountsItsAge) {
  Tracker tracker = one_mode_tracker();
  Track track = tracker.start(TrackId{1}, "one", {{0.0, 10.0, 0.0, -5.0}, StateMatrix::Identity()});
  tracker.predict(track);
  tracker.predict(track);
  EXPECT_EQ(track.combined.mean, State(20.0, 10.0, -10.0, -5.0));
  EXPECT_EQ(track.combined.covariance(kX, kX), 5.0);  // 1 + 2^2
  EXPECT_EQ(track.age_scans, 2);
  EXPECT_EQ(track.status, TrackStatus::kConfirmed);
}

// Half way between equal variances would be 9 of 25 here: K = 16 / 25.
TEST(Look, UpdatesWithThePlotInTheGate) {
  Tracker tracker = one_mode_tracker();
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  const LookOutcome outcome = look(tracker, track, {plot_at(5.0, -2.5)});
  EXPECT_EQ(outcome.used_plot, 0u);
  EXPECT_TRUE(near(position(track.combined.mean), Vector2(3.2, -1.6), 4.0 * kEpsilon));
  EXPECT_DOUBLE_EQ(track.combined.covariance(kX, kX), 16.0 * 9.0 / 25.0);
  EXPECT_DOUBLE_EQ(track.nis.value(), 1.25);  // 25 / 25 + 6.25 / 25
  EXPECT_EQ(track.last_look, kDwell.time);
  EXPECT_EQ(track.last_radar, kDwell.radar);
}

TEST(Look, GateIsSixteen) {
  Tracker tracker = one_mode_tracker();
  for (const auto& [squared, inside] : {std::pair(15.9, true), std::pair(16.1, false)}) {
    Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
    EXPECT_EQ(look(tracker, track, {plot_at_sigmas(std::sqrt(squared))}).used_plot.has_value(), inside) << squared;
  }
}

// After n rejections in a row the limit is 16 (1 + n)^2; looks without plots do not count.
TEST(Look, GateWidensWithEachRejection) {
  Tracker tracker = one_mode_tracker({.lost_probability = 0.0});
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  for (int rejections = 0; rejections < 5; ++rejections) {
    const double limit = 16.0 * std::pow(1.0 + rejections, 2);
    Track inside = track;
    EXPECT_TRUE(look(tracker, inside, {plot_at_sigmas(std::sqrt(limit - 0.1))}).used_plot) << rejections;
    EXPECT_EQ(inside.rejections, 0);
    EXPECT_FALSE(look(tracker, track, {}).used_plot);
    EXPECT_EQ(track.rejections, rejections);
    EXPECT_FALSE(look(tracker, track, {plot_at_sigmas(std::sqrt(limit + 0.1))}).used_plot) << rejections;
    EXPECT_EQ(track.rejections, rejections + 1);
  }
}

TEST(Look, InfiniteGateTakesEveryPlot) {
  Tracker tracker = one_mode_tracker({.gate = kInfinity});
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  EXPECT_TRUE(look(tracker, track, {plot_at(1e9, -1e9)}).used_plot);
  EXPECT_TRUE(track.alive());
}

/// Modes that stand still, with these weights.
Tracker standing_tracker(const Eigen::VectorXd& probability, const TrackerSettings& settings = {}) {
  const auto modes = static_cast<std::size_t>(probability.size());
  return {
      {std::vector<StateMatrix>(modes, StateMatrix::Identity()), std::vector<StateMatrix>(modes, StateMatrix::Zero()),
       Eigen::MatrixXd::Identity(probability.size(), probability.size())},
      probability,
      settings};
}

// The narrow mode rejects what the wide one expects, whichever comes first.
TEST(Look, GateOfAnyModeIsEnough) {
  for (const int wide : {0, 1}) {
    Tracker tracker = standing_tracker(Eigen::Vector2d(0.5, 0.5));
    Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
    track.estimate.modes[wide].covariance *= 100.0;
    EXPECT_TRUE(look(tracker, track, {plot_at_sigmas(10.0)}).used_plot);
    EXPECT_GT(track.estimate.probability[wide], 0.99);  // likelihoods in the ratio e^49 / 64
  }
}

// (3e154)^2 is beyond all doubles, and a spread of means between a mode that follows the plot and one that
// does not. The distance, a ninth of it, is not: an infinite gate lets it in. The combined estimate stays
// what it last was, and the track begins anew from it; a second such plot on end loses it.
TEST(Look, PlotBeyondAllNumbersRestartsTheTrackAndTheNextLosesIt) {
  Tracker tracker = standing_tracker(Eigen::Vector2d(0.5, 0.5), {.gate = kInfinity});
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  const auto too_far = [&] {
    track.estimate.modes[0].covariance *= 1e-9;
    track.estimate.modes[1].covariance *= 1e9;
    look(tracker, track, {plot_at(3e154, 0.0)});
  };
  too_far();
  EXPECT_EQ(track.status, TrackStatus::kCoasting);
  EXPECT_EQ(track.combined.mean, belief_at_origin().mean);
  EXPECT_EQ(track.estimate.modes[0].covariance, belief_at_origin().covariance);
  EXPECT_FALSE(track.nis);
  EXPECT_EQ(tracker.failures(), 1);
  look(tracker, track, {plot_at(0.0, 0.0)});
  EXPECT_EQ(track.status, TrackStatus::kConfirmed);
  too_far();
  EXPECT_TRUE(track.alive()) << "a plot came between";
  too_far();
  EXPECT_EQ(track.loss, LossCause::kNumerics);
  EXPECT_EQ(tracker.failures(), 3);
}

TEST(Look, ChoosesThePlotOfTheGreatestDensity) {
  Tracker tracker = one_mode_tracker();
  const std::vector<Plot> plots{plot_at(8.0, 0.0), plot_at(0.0, -3.0), plot_at(100.0, 0.0), plot_at(3.1, 0.0)};
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  EXPECT_EQ(look(tracker, track, plots).used_plot, 1u);
}

// Two modes of variances 25 and 2500 (S), weights 1/2, 60 m apart. At 7 m from the narrow one the density is
// e^(-49/50) / 25 = 0.015; at the centre of the wide one 1 / 2500 = 0.0004, though its own distance there is
// zero.
TEST(Look, DensityCountsTheDeterminant) {
  Tracker tracker = standing_tracker(Eigen::Vector2d(0.5, 0.5));
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  track.estimate.modes[1].mean = make_state({60.0, 0.0}, {0.0, 0.0});
  track.estimate.modes[1].covariance(kX, kX) = track.estimate.modes[1].covariance(kY, kY) = 2491.0;
  EXPECT_EQ(look(tracker, track, {plot_at(60.0, 0.0), plot_at(0.0, 7.0)}).used_plot, 1u);
}

// All S are the same. At the origin two modes add up to more than the one at 60 m has alone, in either order.
TEST(Look, DensityIsTheSumOverModes) {
  for (const auto& probability : {Eigen::Vector3d(.28, .32, .4), Eigen::Vector3d(.32, .28, .4)}) {
    Tracker tracker = standing_tracker(probability);
    Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
    track.estimate.modes[2].mean = make_state({60.0, 0.0}, {0.0, 0.0});
    EXPECT_EQ(look(tracker, track, {plot_at(60.0, 0.0), plot_at(0.0, 0.0)}).used_plot, 1u);
  }
}

// Nine to one for the mode at 60 m: its plot is the likelier, though the other is as near to its own.
TEST(Look, DensityCountsTheProbabilities) {
  Tracker tracker = standing_tracker(Eigen::Vector2d(0.1, 0.9));
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  track.estimate.modes[1].mean = make_state({60.0, 0.0}, {0.0, 0.0});
  EXPECT_EQ(look(tracker, track, {plot_at(0.0, 0.0), plot_at(60.0, 0.0)}).used_plot, 1u);
}

TEST(Look, TheFirstOfTwoIdenticalPlotsIsUsedOnce) {
  Tracker tracker = named_tracker("cruise_and_turn");
  Track once = tracker.start(TrackId{1}, "one", belief_at_origin());
  Track twice = once;
  EXPECT_EQ(look(tracker, once, {plot_at(4.0, 1.0)}).used_plot, 0u);
  EXPECT_EQ(look(tracker, twice, {plot_at(4.0, 1.0), plot_at(4.0, 1.0)}).used_plot, 0u);
  expect_same_belief(twice, once);
}

TEST(Look, PlotsThatAreNotFiniteArePassedOver) {
  Tracker tracker = named_tracker("cruise_and_turn");
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  Track alone = track;
  const std::vector<Plot> plots{plot_at(kNan, 0.0), plot_at(0.0, kNan), plot_at(kInfinity, 0.0), plot_at(4.0, 1.0)};
  EXPECT_EQ(look(tracker, track, plots).used_plot, 3u);
  EXPECT_EQ(tracker.refused_plots(), 3u);
  look(tracker, alone, {plots[3]});
  expect_same_belief(track, alone);
  EXPECT_EQ(tracker.refused_plots(), 3u);
}

// Every number a plot may bring, in each field, alone and beside a good one, twice on end: refused where it is not
// finite, and otherwise a plot far away. The track stays finite, and its numbers do not fail.
TEST(Look, NoNumberOfAPlotReachesTheTrack) {
  RadarFigures figures;
  figures.clutter_density = 1e-6;
  const RangeBearingRadar radar{figures};
  const Gaussian belief{{3e4, 100.0, 4e4, 0.0}, State(1e4, 1e2, 1e4, 1e2).asDiagonal()};
  const Vector2 good = radar.measure(belief.mean);
  for (const Association association : {Association::kNearest, Association::kPda, Association::kIpda,
                                        Association::kJpda, Association::kJpdaStar, Association::kIts}) {
    for (const UpdateForm form : {UpdateForm::kEkf, UpdateForm::kConverted, UpdateForm::kCubature}) {
      for (const double value : {kNan, kInfinity, -kInfinity, 1e308, -1e308, 1e154, 5e-324, 0.0, -1.0}) {
        for (const int field : {0, 1}) {
          SCOPED_TRACE(testing::Message() << static_cast<int>(association) << " " << static_cast<int>(form) << " "
                                          << value << " " << field);
          Tracker tracker = named_tracker("cruise_and_turn", {.update = form, .association = association});
          Track track = tracker.start(TrackId{1}, "one", belief);
          Plot bad{kDwell.time, kDwell.radar, good, std::nullopt};
          bad.z[field] = value;
          const Plot right{kDwell.time, kDwell.radar, good, std::nullopt};
          for (const std::vector<Plot>& plots : {std::vector{bad}, std::vector{bad, right}, std::vector{bad}}) {
            tracker.predict(track);
            look(tracker, track, plots, radar);
          }
          EXPECT_EQ(tracker.refused_plots(), std::isfinite(value) ? 0u : 3u);
          EXPECT_EQ(tracker.failures(), 0u);
          EXPECT_TRUE(track.alive());
          EXPECT_TRUE(is_finite(track.combined) && track.estimate.probability.allFinite());
        }
      }
    }
  }
}

// No plot was outside the gate: it has no reason to widen.
TEST(Look, PlotsThatAreNotFiniteAreNoRejection) {
  Tracker tracker = named_tracker("cruise_and_turn");
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  EXPECT_FALSE(look(tracker, track, {plot_at(kNan, kNan)}).used_plot);
  EXPECT_EQ(track.status, TrackStatus::kCoasting);
  EXPECT_EQ(track.rejections, 0);
}

TEST(Look, WithoutPlotsOrWithFalseOnesOnlyTheBeliefStays) {
  Tracker tracker = named_tracker("cruise_and_turn");
  const Track before = tracker.start(TrackId{1}, "one", belief_at_origin());
  const std::vector<Plot> none;
  const std::vector<Plot> all_false{plot_at(1e4, 0.0), plot_at(-5e3, 3e3), plot_at(0.0, 2e3)};
  for (const std::vector<Plot>& plots : {none, all_false}) {
    Track track = before;
    EXPECT_FALSE(look(tracker, track, plots).used_plot);
    expect_same_belief(track, before);
    EXPECT_EQ(track.status, TrackStatus::kCoasting);
    EXPECT_EQ(track.last_look, kDwell.time);
    EXPECT_FALSE(track.nis);
  }
}

/// Looks without a plot until the track is lost.
int looks_until_lost(double detection_probability) {
  Tracker tracker = one_mode_tracker();
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  int looks = 0;
  for (; track.alive() && looks < 1000; ++looks) {
    EXPECT_EQ(track.status, looks == 0 ? TrackStatus::kConfirmed : TrackStatus::kCoasting);
    look(tracker, track, {}, position_sensor(detection_probability));
  }
  EXPECT_TRUE(track.alive() || track.loss == LossCause::kNoPlots);
  return looks;
}

// The least n with (1 - P_d)^n <= 1e-8: .1^8 and .01^4 are just that (P_d = 1 is believed as .99), .5^27
// = 7.5e-9.
TEST(Look, TrackIsLostWhenItsMissesAreNotToBeBelieved) {
  EXPECT_EQ(looks_until_lost(0.9), 8);
  EXPECT_EQ(looks_until_lost(0.5), 27);
  EXPECT_EQ(looks_until_lost(0.99), 4);
  EXPECT_EQ(looks_until_lost(1.0), 4);
  EXPECT_EQ(looks_until_lost(0.0), 1000);  // a look that cannot see says nothing
}

TEST(Look, OnePlotConfirmsAgainAndForgetsTheMisses) {
  Tracker tracker = one_mode_tracker();
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  for (int run = 0; run < 3; ++run) {
    for (int i = 0; i < 7; ++i) look(tracker, track, {});
    ASSERT_EQ(track.status, TrackStatus::kCoasting);
    look(tracker, track, {plot_at(0.0, 0.0)});
    ASSERT_EQ(track.status, TrackStatus::kConfirmed);
    ASSERT_EQ(track.log_miss_probability, 0.0);
  }
}

// Two tracks in one tracker; the numbers of the first are broken at every border: it begins anew from its combined
// estimate, or is lost where that is no Gaussian any more. The second is, bit for bit, what it is alone.
TEST(Tracker, FailureTouchesOneTrackOnly) {
  const RangeBearingRadar radar{RadarFigures{}};
  const Gaussian belief{{3e4, 100.0, 4e4, 0.0}, State(1e4, 1e2, 1e4, 1e2).asDiagonal()};
  const auto break_track = [&](int how, Track& track) {
    if (how == 0) track.estimate.modes[1].mean[kX] = kNan;
    if (how == 1) track.estimate.modes[0].covariance(kVx, kVx) = kInfinity;
    if (how == 2) track.estimate.probability[0] = kNan;
    if (how == 3) track.estimate.modes[2].covariance = -1e9 * StateMatrix::Identity();
    if (how == 4) track.estimate.modes[1].mean[kX] = track.combined.mean[kX] = kNan;
  };
  for (int how = 0; how < 5; ++how) {
    Tracker shared = named_tracker("cruise_and_turn");
    Tracker own = named_tracker("cruise_and_turn");
    Track broken = shared.start(TrackId{1}, "one", belief);
    Track healthy = shared.start(TrackId{2}, "two", belief);
    Track alone = own.start(TrackId{2}, "two", belief);
    for (int k = 0; k < 5; ++k) {
      if (k == 0) break_track(how, broken);
      const Vector2 z = radar.measure(healthy.combined.mean) + Vector2(0.1, 1e-5);
      const std::vector<Plot> plots{{kDwell.time, kDwell.radar, z, std::nullopt}};
      if (broken.alive()) shared.predict(broken);
      shared.predict(healthy);
      own.predict(alone);
      if (broken.alive()) look(shared, broken, plots, radar);
      look(shared, healthy, plots, radar);
      look(own, alone, plots, radar);
    }
    EXPECT_EQ(broken.alive(), how < 3) << how;
    EXPECT_EQ(shared.failures(), 1) << how;
    if (broken.alive()) {
      EXPECT_EQ(broken.status, TrackStatus::kConfirmed) << how;
      EXPECT_TRUE(is_finite(broken.combined) && broken.estimate.probability.allFinite()) << how;
    } else {
      EXPECT_EQ(broken.loss, LossCause::kNumerics);
    }
    EXPECT_EQ(healthy.status, TrackStatus::kConfirmed);
    expect_same_belief(healthy, alone);
  }
}

// Straight through the radar's own place, which no plot can come from: nothing it holds is ever NaN, and it
// is not lost for its numbers.
TEST(Tracker, TargetOverTheRadarGivesNoNan) {
  const RangeBearingRadar radar{RadarFigures{}};
  for (const UpdateForm form : {UpdateForm::kEkf, UpdateForm::kConverted}) {
    for (const double miss_m : {0.0, 1e-9, 0.4}) {
      Tracker tracker = named_tracker("cruise_and_turn", {.update = form});
      State truth = make_state({-500.0, miss_m}, {100.0, 0.0});
      Track track = tracker.start(TrackId{1}, "one", {truth, State(1.0, 1.0, 1.0, 1.0).asDiagonal()});
      for (int k = 0; k < 10; ++k) {
        truth = transition(ConstantVelocity{}, 1.0) * truth;
        tracker.predict(track);
        std::vector<Plot> plots;
        if (radar.covers(truth)) plots.push_back({kDwell.time, kDwell.radar, radar.measure(truth), std::nullopt});
        look(tracker, track, plots, radar);
        ASSERT_NE(track.loss, LossCause::kNumerics) << "scan " << k << ", passing " << miss_m << " m off";
        ASSERT_TRUE(track.combined.mean.allFinite() && track.combined.covariance.allFinite());
        ASSERT_TRUE(track.estimate.probability.allFinite());
      }
    }
  }
}

// --- re-acquisition

/// Seen, then 5 km away and on at `step` a second from there; P_d .9, of which four misses are 1e-4. The looks after
/// the jump until the belief is near, 8 where it never is.
int looks_to_reacquire(const Vector2& step, double clutter_density, bool other_is_there) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, clutter_density);
  Tracker tracker = one_mode_tracker();
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  Track other = tracker.start(TrackId{2}, "other", {make_state({5e3, 0.0}, step), belief_at_origin().covariance});
  for (int k = 1; k <= 7; ++k) {
    tracker.predict(track);
    tracker.predict(other);
    const Vector2 place = Vector2(5e3, 0.0) + k * step;
    const Dwell dwell{RadarId{1}, track.id, kStreamStart + from_seconds(k), track.combined.mean};
    const Plot plot{dwell.time, dwell.radar, place, std::nullopt};
    (void)tracker.look(track, sensor, dwell, {&plot, 1}, other_is_there ? std::span(&other, 1) : std::span<Track>());
    if ((position(track.combined.mean) - place).norm() < 10.0) {
      EXPECT_EQ(track.status, TrackStatus::kCoasting) << "until a plot confirms it";
      return k;
    }
  }
  return 8;
}

TEST(Reacquire, FromTheLastTwoPlotsWhenTheMissesAreNotToBeBelieved) {
  EXPECT_EQ(looks_to_reacquire({0.0, 0.0}, 0.0, false), 4);
  EXPECT_EQ(looks_to_reacquire({0.0, 10.0}, 0.0, false), 4);
}

TEST(Reacquire, NotWhatNoModeWouldFly) { EXPECT_EQ(looks_to_reacquire({0.0, 800.0}, 0.0, false), 8); }

TEST(Reacquire, NotAnotherTracksPlotsNorFalseOnes) {
  EXPECT_EQ(looks_to_reacquire({0.0, 10.0}, 0.0, true), 8);
  EXPECT_EQ(looks_to_reacquire({0.0, 10.0}, 1e-12, false), 8);
}

TEST(Reacquire, OfTheLastTwoLooksBothWithoutFalsePlots) {
  const PositionSensor clear(9.0 * Matrix2::Identity(), 0.9, 0.0);
  const PositionSensor cluttered(9.0 * Matrix2::Identity(), 0.9, 1e-12);
  Tracker tracker = one_mode_tracker({.association = Association::kPda});
  Track track = tracker.start(TrackId{1}, "one", belief_at_origin());
  const Plot far{kDwell.time, kDwell.radar, {5e3, 0.0}, std::nullopt};
  look(tracker, track, {far}, clear);
  EXPECT_TRUE(track.outlier);
  look(tracker, track, {far}, cluttered);
  EXPECT_FALSE(track.outlier);
}

// --- particles

/// A target at 200 m/s seen four looks of five by a radar 50 km away; what each tracker makes of the same plots.
std::vector<Track> follow(std::vector<Tracker> trackers, int scans) {
  RadarFigures figures;
  figures.range_noise_floor_m = 20.0;
  figures.azimuth_noise_floor_rad = 1e-3;
  figures.detection = FixedDetection{0.8};
  const RangeBearingRadar radar(figures);
  State truth = make_state({3e4, 4e4}, {200.0, 0.0});
  std::vector<Track> tracks;
  for (Tracker& tracker : trackers) {
    tracks.push_back(tracker.start(TrackId{3}, "", {truth, State(1e4, 1e2, 1e4, 1e2).asDiagonal()}));
  }
  RandomStream stream(4);
  for (int k = 1; k <= scans; ++k) {
    truth = transition(ConstantVelocity{}, 1.0) * truth;
    const Matrix2 root = radar.noise(truth).llt().matrixL();
    const Vector2 z = radar.measure(truth) + root * Vector2(stream.normal(), stream.normal());
    std::vector<Plot> plots;
    if (k % 5 != 0) plots.push_back({kDwell.time, kDwell.radar, z, std::nullopt});
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      trackers[i].predict(tracks[i]);
      look(trackers[i], tracks[i], plots, radar);
    }
  }
  return tracks;
}

Tracker particle_tracker(const DiscreteBank& bank, const Eigen::VectorXd& probability, ParticleKind kind, int count,
                         std::uint64_t seed) {
  TrackerSettings settings;
  settings.particles = ParticleSettings{kind, count};
  return {bank, probability, settings, RandomStream(seed)};
}

// One history of one mode is the Kalman filter: the same products in the same order but for the weights.
TEST(ParticleTracker, OfOneModeIsTheKalmanTracker) {
  const ConstantVelocity motion;
  const DiscreteBank bank{{transition(motion, 1.0)}, {white_noise(motion, 1.0, 1.0)}, Eigen::MatrixXd::Ones(1, 1)};
  const Eigen::VectorXd certain = Eigen::VectorXd::Ones(1);
  const auto tracks =
      follow({Tracker(bank, certain, {}), particle_tracker(bank, certain, ParticleKind::kMarginal, 1, 1)}, 40);
  EXPECT_TRUE(near(tracks[1].combined.mean, tracks[0].combined.mean, 1e-9));
  EXPECT_TRUE(near(tracks[1].combined.covariance, tracks[0].combined.covariance,
                   1e-12 * matrices::scale_of(tracks[0].combined.covariance)));
  EXPECT_EQ(tracks[1].nis.has_value(), true);
}

// 81 histories hold all of four scans in three modes: the exact Bayes filter but for h. The IMM, which merges, is near
// it. Another seed changes the bits of states, not those of histories that are all kept.
TEST(ParticleTracker, IsDeterministicAndNearTheImm) {
  const ModeBank named = *named_bank("cruise_and_turn");
  const DiscreteBank bank = *discretise(named, 1.0);
  const auto tracker = [&](ParticleKind kind, int count, std::uint64_t seed) {
    return particle_tracker(bank, named.initial_probability, kind, count, seed);
  };
  const auto tracks = follow({Tracker(bank, named.initial_probability, {}), tracker(ParticleKind::kMarginal, 81, 1),
                              tracker(ParticleKind::kMarginal, 81, 2), tracker(ParticleKind::kBootstrap, 2000, 1),
                              tracker(ParticleKind::kBootstrap, 2000, 1), tracker(ParticleKind::kBootstrap, 2000, 2)},
                             4);
  const State sigma = tracks[0].combined.covariance.diagonal().cwiseSqrt();
  EXPECT_TRUE(near(tracks[1].combined.mean, tracks[0].combined.mean, State(0.1 * sigma)));
  EXPECT_EQ(tracks[1].combined.mean, tracks[2].combined.mean);
  // Of 2000 states some hundred count: a tenth of a sigma, and five times that for four components.
  EXPECT_TRUE(near(tracks[3].combined.mean, tracks[1].combined.mean, State(0.5 * sigma)));
  EXPECT_EQ(tracks[3].combined.mean, tracks[4].combined.mean);
  EXPECT_NE(tracks[3].combined.mean, tracks[5].combined.mean);
}

TEST(TrackerDeathTest, ProbabilitiesOfAnotherBankAreRefused) {
  EXPECT_DEATH(Tracker(discretise(*named_bank("liu_hwang"), 1.0).value(), Eigen::VectorXd::Ones(1), {}),
               "invariant broken");
}

}  // namespace
}  // namespace dwell
