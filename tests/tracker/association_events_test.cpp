#include "tracker/association_events.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "radar/range_bearing_radar.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"
#include "tests/tracker/matrices.hpp"
#include "tests/tracker/position_sensor.hpp"
#include "tracker/tracker.hpp"

namespace dwell {
namespace {

using matrices::near;

constexpr double kPi = std::numbers::pi;
constexpr double kGate = 16.0;
const Dwell kDwell{RadarId{1}, TrackId{1}, kStreamStart + from_seconds(7.0), State::Zero()};

Plot plot_at(const Vector2& z) { return {kDwell.time, kDwell.radar, z, std::nullopt}; }

/// S = 25 I against R = 9 I.
Gaussian belief_at_origin() { return {State::Zero(), State(16.0, 1.0, 16.0, 1.0).asDiagonal()}; }

std::vector<double> alone(const AssociationEvents& events) { return std::vector<double>(events.size(), 1.0); }

// nu = (5, 0) and (0, -10): e^(-1/2) and e^(-2) times 1 / (2 pi 25); lambda 1e-3, P_d .9, P_G 1 - e^-8.
TEST(AssociationEvents, PdaByHand) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 1e-3);
  ImmEstimate estimate = make_estimate(belief_at_origin(), Eigen::VectorXd::Ones(1));
  const std::vector<Plot> plots{plot_at({5.0, 0.0}), plot_at({300.0, 0.0}), plot_at({0.0, -10.0})};
  AssociationEvents events;
  ASSERT_EQ(events.list(sensor, UpdateForm::kEkf, kGate, estimate, State::Zero(), plots), Numerics::kOk);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events.plot(1), 2U);
  const double none = 1.0 - 0.9 * (1.0 - std::exp(-8.0));
  const double first = 0.9 * std::exp(-0.5) / (2.0 * kPi * 25.0) / 1e-3;
  const double second = 0.9 * std::exp(-2.0) / (2.0 * kPi * 25.0) / 1e-3;
  const double total = none + first + second;
  EXPECT_NEAR(events.likelihood_ratio(alone(events)), total, 1e-14 * total);
  events.update(alone(events), estimate);
  const double b1 = first / total;
  const double b2 = second / total;
  const Gaussian& mode = estimate.modes[0];
  EXPECT_NEAR(mode.mean[kX], 0.64 * 5.0 * b1, 1e-14);
  EXPECT_NEAR(mode.mean[kY], -0.64 * 10.0 * b2, 1e-14);
  const double mixed = (1.0 - b1 - b2) * 16.0 + (b1 + b2) * 16.0 * 9.0 / 25.0;
  EXPECT_NEAR(mode.covariance(kX, kX), mixed + 0.64 * 0.64 * (b1 - b1 * b1) * 25.0, 1e-13);
  EXPECT_NEAR(mode.covariance(kY, kY), mixed + 0.64 * 0.64 * (b2 - b2 * b2) * 100.0, 1e-13);
  EXPECT_NEAR(mode.covariance(kX, kY), 0.64 * 0.64 * b1 * b2 * 50.0, 1e-13);
}

/// Three modes within some sigma of each other, and plots round them.
struct Scene {
  ImmEstimate estimate;
  std::vector<Plot> plots;
};

Scene random_scene(RandomStream& stream, int plots) {
  Scene scene;
  for (int j = 0; j < 3; ++j) {
    Gaussian mode{State(50.0, 5.0, 50.0, 5.0).cwiseProduct(matrices::normal_state(stream)),
                  matrices::random_covariance(stream, {20.0, 3.0, 20.0, 3.0})};
    scene.estimate.modes.push_back(mode);
  }
  scene.estimate.probability = matrices::random_probability(stream, 3);
  for (int i = 0; i < plots; ++i) scene.plots.push_back(plot_at({80.0 * stream.normal(), 80.0 * stream.normal()}));
  return scene;
}

// The mixture over all events, one Kalman update each, has the moments of `update`, mode by mode; the weights likewise.
TEST(AssociationEvents, UpdateHasTheMomentsOfTheMixtureOfAllEvents) {
  RandomStream stream(1);
  const PositionSensor sensor((Matrix2() << 100.0, 30.0, 30.0, 64.0).finished(), 0.7, 1e-5);
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = random_scene(stream, 6);
    AssociationEvents events;
    ASSERT_EQ(events.list(sensor, UpdateForm::kEkf, kGate, scene.estimate, State::Zero(), scene.plots), Numerics::kOk);
    std::vector<double> factor(events.size());
    for (double& e : factor) e = stream.uniform();
    ImmEstimate updated = scene.estimate;
    events.update(factor, updated);
    Eigen::Vector3d weight = Eigen::Vector3d::Zero();
    for (int j = 0; j < 3; ++j) {
      const Gaussian& prior = scene.estimate.modes[static_cast<std::size_t>(j)];
      const PredictedMeasurement& seen = events.predicted()[static_cast<std::size_t>(j)];
      std::vector<Gaussian> parts{prior};
      std::vector<double> weights{scene.estimate.probability[j] * (1.0 - 0.7 * (1.0 - std::exp(-8.0)))};
      for (std::size_t i = 0; i < events.size(); ++i) {
        const Vector2 nu = scene.plots[events.plot(i)].z - position(prior.mean);
        const double density =
            std::exp(-0.5 * nu.dot(seen.s.inverse() * nu)) / (2.0 * kPi * std::sqrt(seen.s.determinant()));
        parts.push_back(kalman_update(prior, seen, nu));
        weights.push_back(factor[i] * scene.estimate.probability[j] * 0.7 * density / 1e-5);
      }
      Gaussian mixture;
      for (const double w : weights) weight[j] += w;
      for (std::size_t k = 0; k < parts.size(); ++k) mixture.mean += weights[k] / weight[j] * parts[k].mean;
      for (std::size_t k = 0; k < parts.size(); ++k) {
        const State off = parts[k].mean - mixture.mean;
        mixture.covariance += weights[k] / weight[j] * (parts[k].covariance + off * off.transpose());
      }
      const Gaussian& actual = updated.modes[static_cast<std::size_t>(j)];
      EXPECT_TRUE(near(actual.mean, mixture.mean, 1e-11));
      EXPECT_TRUE(
          near(actual.covariance, mixture.covariance, StateMatrix(1e-12 * matrices::scale_of(prior.covariance))));
    }
    EXPECT_TRUE(near(updated.probability, Eigen::VectorXd(weight / weight.sum()), 1e-13));
  }
}

// The converted form measures in metres: its density is that of metres and radians over the range. Both forms then
// weigh a plot alike to what the curvature moves, (30 m / 60 km)^2.
TEST(AssociationEvents, DensityIsThatOfTheForm) {
  RadarFigures figures;
  figures.snr_reference = 1e30;
  figures.range_noise_floor_m = 30.0;
  figures.azimuth_noise_floor_rad = 0.5e-3;
  figures.clutter_density = 1e-3;
  const RangeBearingRadar radar(figures);
  const State x = make_state({36e3, 48e3}, {100.0, 0.0});
  const ImmEstimate estimate = make_estimate({x, State(400.0, 1.0, 400.0, 1.0).asDiagonal()}, Eigen::VectorXd::Ones(1));
  const std::vector<Plot> plots{plot_at(radar.measure(make_state({36020.0, 47990.0}, Vector2::Zero())))};
  double sums[2];
  for (const UpdateForm form : {UpdateForm::kEkf, UpdateForm::kConverted}) {
    AssociationEvents events;
    ASSERT_EQ(events.list(radar, form, kGate, estimate, x, plots), Numerics::kOk);
    ASSERT_EQ(events.size(), 1U);
    sums[form == UpdateForm::kEkf ? 0 : 1] = events.sum(0);
  }
  EXPECT_NEAR(sums[0], sums[1], 1e-3 * sums[0]);
}

TEST(AssociationEvents, PassOverWhatIsNotFinite) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 1e-3);
  const ImmEstimate estimate = make_estimate(belief_at_origin(), Eigen::VectorXd::Ones(1));
  const std::vector<Plot> plots{plot_at({std::nan(""), 0.0}), plot_at({0.0, HUGE_VAL}), plot_at({1.0, 1.0})};
  AssociationEvents events;
  ASSERT_EQ(events.list(sensor, UpdateForm::kEkf, kGate, estimate, State::Zero(), plots), Numerics::kOk);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events.plot(0), 2U);
}

// And one event at a time: the mixture of what `condition` leaves, weighed by none() and sum(i), is that of `update`.
TEST(AssociationEvents, ConditionedOnEachEventMakesUpTheUpdate) {
  RandomStream stream(2);
  const PositionSensor sensor((Matrix2() << 100.0, 30.0, 30.0, 64.0).finished(), 0.7, 1e-5);
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = random_scene(stream, 4);
    AssociationEvents events;
    ASSERT_EQ(events.list(sensor, UpdateForm::kEkf, kGate, scene.estimate, State::Zero(), scene.plots), Numerics::kOk);
    ImmEstimate updated = scene.estimate;
    events.update(alone(events), updated);
    const double total = events.likelihood_ratio(alone(events));
    Eigen::Vector3d probability = Eigen::Vector3d::Zero();
    State mean = State::Zero();
    for (std::size_t i = 0; i <= events.size(); ++i) {
      ImmEstimate one = scene.estimate;
      events.condition(i < events.size() ? std::optional(i) : std::nullopt, one);
      EXPECT_NEAR(one.probability.sum(), 1.0, 1e-14);
      const double weight = (i < events.size() ? events.sum(i) : events.none()) / total;
      probability += weight * one.probability;
      mean += weight * combined_mean(one);
    }
    EXPECT_TRUE(near(updated.probability, Eigen::VectorXd(probability), 1e-13));
    EXPECT_TRUE(near(combined_mean(updated), mean, 1e-11));
  }
}

TEST(AssociationEvents, CountAPlotThatCameTwiceOnce) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 1e-3);
  const ImmEstimate estimate = make_estimate(belief_at_origin(), Eigen::VectorXd::Ones(1));
  const std::vector<Plot> plots{plot_at({5.0, 0.0}), plot_at({1.0, 1.0}), plot_at({5.0, 0.0})};
  AssociationEvents events;
  ASSERT_EQ(events.list(sensor, UpdateForm::kEkf, kGate, estimate, State::Zero(), plots), Numerics::kOk);
  EXPECT_EQ(events.size(), 2U);
}

Tracker standing_tracker(const TrackerSettings& settings) {
  return {{{StateMatrix::Identity()}, {StateMatrix::Zero()}, Eigen::MatrixXd::Ones(1, 1)},
          Eigen::VectorXd::Ones(1),
          settings};
}

// --- by way of the tracker

TEST(Pda, WithoutClutterIsTheNearestPlotBitForBit) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 0.0);
  for (const Association association : {Association::kPda, Association::kIpda, Association::kJpda, Association::kIts}) {
    Tracker nearest = standing_tracker({});
    Tracker all = standing_tracker({.association = association});
    Track one = nearest.start(TrackId{1}, "one", belief_at_origin());
    Track other = all.start(TrackId{1}, "one", belief_at_origin());
    RandomStream stream(3);
    for (int k = 0; k < 50; ++k) {
      std::vector<Plot> plots;
      while (stream.uniform() < 0.6) plots.push_back(plot_at({10.0 * stream.normal(), 10.0 * stream.normal()}));
      const auto used = nearest.look(one, sensor, kDwell, plots).used_plot;
      EXPECT_EQ(all.look(other, sensor, kDwell, plots).used_plot, used);
      EXPECT_EQ(one.combined.mean, other.combined.mean);
      EXPECT_EQ(one.combined.covariance, other.combined.covariance);
      EXPECT_EQ(one.rejections, other.rejections);
    }
  }
}

// A target that exists with probability one half, somewhere in the belief, is or is not seen among false plots. The
// probability of existence that the look leaves is calibrated: its mean over runs is the share that exist, and so is
// that over any event of the look; here, the runs that it calls unlikely. Differences lie in [-1, 1]. The gate's
// neglected part moves it by 3.4e-4 of itself at most.
struct Calibration {
  double all = 0.0;       // sum of probability - (exists)
  double unlikely = 0.0;  // the same over runs that end under a half
  int unlikely_runs = 0;
};

Calibration calibrate(double density_believed, int runs) {
  constexpr double kDensity = 2e-3;
  constexpr double kHalf = 100.0;  // false plots within: 80 on average; the gate has an area of 1257, 2.5 of them
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.8, density_believed);
  Tracker tracker = standing_tracker({.association = Association::kIpda, .existence = {.remove = 1e-300}});
  RandomStream stream(5);
  Calibration sums;
  for (int run = 0; run < runs; ++run) {
    const bool exists = stream.uniform() < 0.5;
    const Vector2 truth(4.0 * stream.normal(), 4.0 * stream.normal());
    std::vector<Plot> plots;
    if (exists && stream.uniform() < 0.8) {
      plots.push_back(plot_at(truth + Vector2(3.0 * stream.normal(), 3.0 * stream.normal())));
    }
    const int count = stream.poisson(kDensity * 4.0 * kHalf * kHalf);
    for (int i = 0; i < count; ++i) {
      const double x = stream.uniform(-kHalf, kHalf);
      plots.push_back(plot_at({x, stream.uniform(-kHalf, kHalf)}));
    }
    Track track = tracker.start(TrackId{1}, "", belief_at_origin());
    track.existence = 0.5;
    tracker.look(track, sensor, kDwell, plots);
    const double difference = *track.existence - (exists ? 1.0 : 0.0);
    sums.all += difference;
    if (*track.existence < 0.5) {
      sums.unlikely += difference;
      ++sums.unlikely_runs;
    }
  }
  return sums;
}

TEST(Ipda, ExistenceIsCalibrated) {
  const int runs = scaled(40000);
  const Calibration sums = calibrate(2e-3, runs);
  EXPECT_LT(std::abs(sums.all / runs), statistics::hoeffding_bound(runs) + 4e-4);
  const int unlikely = sums.unlikely_runs;
  EXPECT_GT(unlikely, runs / 5);
  EXPECT_LT(std::abs(sums.unlikely / unlikely), statistics::hoeffding_bound(unlikely) + 4e-4);
}

TEST(Ipda, CalibrationSeesADensityThreeTimesTooSmall) {
  const int runs = scaled(40000);
  EXPECT_GT(std::abs(calibrate(2e-3 / 3.0, runs).all / runs), statistics::hoeffding_bound(runs) + 4e-4);
}

TEST(Ipda, RunOfMissesEndsTheTrackByExistence) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 1e-6);
  Tracker tracker = standing_tracker({.association = Association::kIpda, .existence = {.survival = 0.999}});
  Track track = tracker.start(TrackId{1}, "", belief_at_origin());
  int looks = 0;
  double odds = 0.0;
  for (; track.alive(); ++looks) {
    tracker.predict(track);
    const double there = looks == 0 ? 0.999 : 0.999 * odds / (1.0 + odds);
    odds = there / (1.0 - there) * (1.0 - 0.9 * (1.0 - std::exp(-8.0)));
    tracker.look(track, sensor, kDwell, {});
    EXPECT_NEAR(*track.existence, odds / (1.0 + odds), 1e-12);
  }
  EXPECT_EQ(track.loss, LossCause::kNoPlots);
  EXPECT_EQ(looks, 6);  // 999 x .1^k passes .005 / .995 at k = 5.3, a little sooner with survival
}

// --- joint

// Two tracks, two plots, by enumeration of the joint events: (none, none), (1, none), .. (2, 1), never the same plot.
TEST(Jpda, MarginalsAreThoseOfTheJointEvents) {
  const double lambda = 1e-3;
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, lambda);
  Tracker tracker = standing_tracker({.association = Association::kJpda});
  const auto start = [&](std::uint32_t id, double x) {
    Gaussian belief = belief_at_origin();
    belief.mean[kX] = x;
    return tracker.start(TrackId{id}, "", belief);
  };
  std::vector<Track> tracks{start(1, 0.0), start(2, 8.0)};
  tracks[1].existence = 0.7;
  const std::vector<Plot> plots{plot_at({3.0, 2.0}), plot_at({7.0, -4.0})};
  const double none = 1.0 - 0.9 * (1.0 - std::exp(-8.0));
  const auto ratio = [&](std::size_t track, std::size_t plot) {
    const Vector2 nu = plots[plot].z - position(tracks[track].combined.mean);
    return 0.9 * std::exp(-nu.squaredNorm() / 50.0) / (2.0 * kPi * 25.0) / lambda;
  };
  double own[3] = {0.0, 0.0, 0.0};  // of none, plot 1, plot 2 for the first track
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      if (a != 0 && a == b) continue;
      const double of_a = a == 0 ? none : ratio(0, static_cast<std::size_t>(a - 1));
      const double of_b = b == 0 ? 0.3 + 0.7 * none : 0.7 * ratio(1, static_cast<std::size_t>(b - 1));
      own[a] += of_a * of_b;
    }
  }
  const double total = own[0] + own[1] + own[2];
  tracker.look(tracks[0], sensor, kDwell, plots, tracks);
  const Vector2 expected = 0.64 / total * (own[1] * plots[0].z + own[2] * plots[1].z);
  EXPECT_TRUE(near(position(tracks[0].combined.mean), expected, 1e-13));
  EXPECT_EQ(tracks[1].combined.mean[kX], 8.0) << "only the track that the look was made for is touched";
}

// With one plot for each, PDA lets both tracks lean to the other's; joint events let the plots be shared out.
TEST(Jpda, NeighboursLeanLessThanUnderPda) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 1e-6);
  const auto leaned = [&](Association association) {
    Tracker tracker = standing_tracker({.association = association});
    Gaussian beside = belief_at_origin();
    beside.mean[kX] = 10.0;
    std::vector<Track> tracks{tracker.start(TrackId{1}, "", belief_at_origin()), tracker.start(TrackId{2}, "", beside)};
    tracker.look(tracks[0], sensor, kDwell, std::vector<Plot>{plot_at({0.0, 0.0}), plot_at({10.0, 0.0})}, tracks);
    return tracks[0].combined.mean[kX];
  };
  // PDA: weights 1 and e^-2 of plots 10 m apart, so 6.4 e^-2 / (1 + e^-2) = .76 m; joint: 1 and e^-4, .115 m.
  EXPECT_NEAR(leaned(Association::kPda), 6.4 * std::exp(-2.0) / (1.0 + std::exp(-2.0)), 1e-3);
  EXPECT_NEAR(leaned(Association::kJpda), 6.4 * std::exp(-4.0) / (1.0 + std::exp(-4.0)), 1e-3);
}

// Ten tracks at one place: more than are counted. The track stays finite and its covariance definite.
TEST(Jpda, CrowdIsCutToTheBound) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 1e-5);
  Tracker tracker = standing_tracker({.association = Association::kJpda});
  std::vector<Track> tracks;
  for (std::uint32_t id = 1; id <= 10; ++id) tracks.push_back(tracker.start(TrackId{id}, "", belief_at_origin()));
  RandomStream stream(9);
  std::vector<Plot> plots;
  for (int i = 0; i < 10; ++i) plots.push_back(plot_at({5.0 * stream.normal(), 5.0 * stream.normal()}));
  AssociationEvents events;
  ASSERT_EQ(events.list(sensor, UpdateForm::kEkf, kGate, tracks[0].estimate, State::Zero(), plots), Numerics::kOk);
  std::vector<double> factor(events.size());
  PlotCluster cluster;
  cluster.exclude(TrackId{1}, events, tracks, sensor, UpdateForm::kEkf, kGate, State::Zero(), plots, false, factor);
  EXPECT_EQ(cluster.rivals(), static_cast<std::size_t>(JointAssociation::kMostRivals));
  tracker.look(tracks[0], sensor, kDwell, plots, tracks);
  EXPECT_TRUE(tracks[0].alive());
  EXPECT_GT(matrices::smallest_pivot(tracks[0].combined.covariance), 0.0);
}

}  // namespace
}  // namespace dwell
