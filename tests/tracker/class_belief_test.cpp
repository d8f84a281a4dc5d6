// What a track is believed to be: Bayes by enumeration, calibration against truth.

#include "tracker/class_belief.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "radar/jump_markov_trajectory.hpp"
#include "radar/look.hpp"
#include "radar/range_bearing_radar.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"
#include "tests/tracker/matrices.hpp"
#include "tests/tracker/position_sensor.hpp"
#include "tracker/tracker.hpp"

namespace dwell {
namespace {

constexpr double kPi = std::numbers::pi;
const Dwell kDwell{RadarId{1}, TrackId{1}, kStreamStart + from_seconds(7.0), State::Zero()};

Eigen::MatrixXd random_rows(RandomStream& random, int n, double least = 0.02) {
  Eigen::MatrixXd rows(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) rows(i, j) = least - std::log(1.0 - random.uniform());
    rows.row(i) /= rows.row(i).sum();
  }
  return rows;
}

TargetClasses random_classes(RandomStream& random, int n, bool move) {
  TargetClasses classes;
  classes.names.resize(static_cast<std::size_t>(n));
  classes.prior = random_rows(random, n).row(0);
  classes.weight = Eigen::VectorXd::LinSpaced(n, 1.0, 10.0);
  classes.transition = move ? random_rows(random, n) : Eigen::MatrixXd::Identity(n, n);
  return classes;
}

/// One mode of constant velocity without noise.
Tracker make_tracker(const TargetClasses& classes, Association association) {
  TrackerSettings settings;
  settings.classes = classes;
  settings.association = association;
  settings.gate = 1e300;  // every plot counts
  return {{{transition(ConstantVelocity{}, 1.0)}, {StateMatrix::Zero()}, Eigen::MatrixXd::Ones(1, 1)},
          Eigen::VectorXd::Ones(1),
          settings};
}

Gaussian belief_at_origin() { return {State::Zero(), State(16.0, 1.0, 16.0, 1.0).asDiagonal()}; }

Plot plot_at(const Vector2& z, int declared) { return {kDwell.time, kDwell.radar, z, std::nullopt, declared}; }

/// P(class at the last look | what all looks declared), by the sum over every path of classes.
Eigen::VectorXd by_enumeration(const TargetClasses& classes, const Eigen::MatrixXd& emission,
                               const std::vector<int>& declared) {
  const int n = classes.size();
  Eigen::VectorXd posterior = Eigen::VectorXd::Zero(n);
  const auto looks = static_cast<int>(declared.size());
  const auto paths = static_cast<long>(std::llround(std::pow(n, looks + 1)));
  for (long path = 0; path < paths; ++path) {
    long digits = path;
    int k = static_cast<int>(digits % n);
    double p = classes.prior[k];
    for (const int d : declared) {
      digits /= n;
      const int next = static_cast<int>(digits % n);
      p *= classes.transition(k, next) * (d >= 0 ? emission(next, d) : 1.0);
      k = next;
    }
    posterior[k] += p;
  }
  return posterior / posterior.sum();
}

/// Looks with one plot, or none, without clutter: the forward recursion is the sum over paths, to rounding.
TEST(ClassBelief, OfCertainPlotsIsBayesByEnumeration) {
  RandomStream random(1);
  for (int trial = 0; trial < scaled(60); ++trial) {
    const int n = 2 + trial % 3;
    const TargetClasses classes = random_classes(random, n, trial % 2 == 0);
    const Eigen::MatrixXd emission = random_rows(random, n);
    PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 0.0);
    sensor.set_declaration({emission});
    Tracker tracker = make_tracker(classes, Association::kNearest);
    Track track = tracker.start(TrackId{1}, "", belief_at_origin());
    tracker.set_target_weight(track, 3.0);
    EXPECT_EQ(track.class_belief, classes.prior);
    std::vector<int> declared;
    for (int look = 0; look < 5; ++look) {
      declared.push_back(static_cast<int>(random.uniform() * (n + 1)) - 1);  // -1: no plot
      std::vector<Plot> plots;
      if (declared.back() >= 0) plots.push_back(plot_at({1.0, 0.0}, declared.back()));
      (void)tracker.look(track, sensor, kDwell, plots);
      const Eigen::VectorXd expected = by_enumeration(classes, emission, declared);
      EXPECT_LT((track.class_belief - expected).cwiseAbs().maxCoeff(), 1e-14);
      EXPECT_NEAR(track.weight, 3.0 * classes.weight.dot(expected), 1e-12);
    }
  }
}

/// One look with false plots: every event (which plot is the target's, or none) and every class, by the densities of
/// the model: Kalman's S = 25 I, Poisson clutter of density lambda, whose plots declare any class alike.
TEST(ClassBelief, AmongFalsePlotsIsTheSumOverEventsAndClasses) {
  constexpr double kLambda = 1e-3;
  constexpr double kDetection = 0.8;
  RandomStream random(2);
  for (int trial = 0; trial < scaled(100); ++trial) {
    const int n = 2 + trial % 3;
    const TargetClasses classes = random_classes(random, n, trial % 2 == 0);
    PositionSensor sensor(9.0 * Matrix2::Identity(), kDetection, kLambda);
    const Eigen::MatrixXd emission = random_rows(random, n);
    sensor.set_declaration({emission});
    std::vector<Plot> plots;
    for (int i = 0; i < trial % 5; ++i) {
      plots.push_back(plot_at({8.0 * random.normal(), 8.0 * random.normal()}, static_cast<int>(random.uniform() * n)));
    }
    const Eigen::VectorXd before = classes.transition.transpose() * classes.prior;
    Eigen::VectorXd joint = (1.0 - kDetection) * before;
    std::vector<double> event(plots.size(), 0.0);
    for (std::size_t i = 0; i < plots.size(); ++i) {
      const double density = std::exp(-0.5 * plots[i].z.squaredNorm() / 25.0) / (2.0 * kPi * 25.0);
      for (int k = 0; k < n; ++k) {
        const double p = kDetection * density * emission(k, *plots[i].declared) * before[k] / (kLambda / n);
        joint[k] += p;
        event[i] += p;
      }
    }
    const double total = joint.sum();
    Tracker tracker = make_tracker(classes, Association::kPda);
    Track track = tracker.start(TrackId{1}, "", belief_at_origin());
    (void)tracker.look(track, sensor, kDwell, plots);
    EXPECT_LT((track.class_belief - joint / total).cwiseAbs().maxCoeff(), 1e-13);
    // The state has the same events: the mean is theirs, each with the gain 16 / 25.
    Vector2 mean = Vector2::Zero();
    for (std::size_t i = 0; i < plots.size(); ++i) mean += event[i] / total * 0.64 * plots[i].z;
    EXPECT_LT((position(track.combined.mean) - mean).norm(), 1e-12);
  }
}

/// A plot farther away is the target's where what it declares outweighs the distance: by the ratio of the likelihoods.
TEST(ClassBelief, TheNearestPlotIsNearestInClassToo) {
  RandomStream random(3);
  TargetClasses classes = random_classes(random, 2, false);
  classes.prior = Eigen::Vector2d(0.999, 0.001);
  PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 1e-3);
  sensor.set_declaration({(Eigen::MatrixXd(2, 2) << 0.95, 0.05, 0.1, 0.9).finished()});
  // P(declares first) / P(declares second) = .94915 / .05085: worth 5.85 of squared distance, 12.1 m at S = 25.
  for (const double metres : {12.0, 12.2}) {
    Tracker tracker = make_tracker(classes, Association::kNearest);
    Track track = tracker.start(TrackId{1}, "", belief_at_origin());
    const std::vector<Plot> plots{plot_at({0.0, 0.0}, 1), plot_at({metres, 0.0}, 0)};
    EXPECT_EQ(tracker.look(track, sensor, kDwell, plots).used_plot, metres < 12.1 ? 1U : 0U) << metres;
  }
}

/// What cannot be, by the emission, is no proof: the belief stays a distribution, and comes back.
TEST(ClassBelief, AnImpossibleDeclarationIsSurvived) {
  RandomStream random(4);
  TargetClasses classes = random_classes(random, 2, false);
  PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 0.0);
  sensor.set_declaration({Eigen::MatrixXd::Identity(2, 2)});
  Tracker tracker = make_tracker(classes, Association::kNearest);
  Track track = tracker.start(TrackId{1}, "", belief_at_origin());
  const std::vector<Plot> first{plot_at({0.0, 0.0}, 0)};
  const std::vector<Plot> second{plot_at({0.0, 0.0}, 1)};
  (void)tracker.look(track, sensor, kDwell, first);
  EXPECT_GT(track.class_belief[0], 0.999);
  for (int look = 0; look < 2; ++look) (void)tracker.look(track, sensor, kDwell, second);
  EXPECT_GT(track.class_belief[1], 0.999);
  EXPECT_NEAR(track.class_belief.sum(), 1.0, 1e-15);
}

/// A track that begins anew, as its numbers have failed, is of any class again.
TEST(ClassBelief, BeginsAnewWithItsTrack) {
  RandomStream random(5);
  const TargetClasses classes = random_classes(random, 3, false);
  PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 0.0);
  sensor.set_declaration({random_rows(random, 3)});
  Tracker tracker = make_tracker(classes, Association::kNearest);
  Track track = tracker.start(TrackId{1}, "", belief_at_origin());
  const std::vector<Plot> plots{plot_at({0.0, 0.0}, 0)};
  (void)tracker.look(track, sensor, kDwell, plots);
  EXPECT_NE(track.class_belief, classes.prior);
  track.estimate.modes[0].covariance(kX, kX) = -1e9;  // S is not positive definite
  (void)tracker.look(track, sensor, kDwell, plots);
  EXPECT_EQ(tracker.failures(), 1U);
  EXPECT_EQ(track.class_belief, classes.prior);
  EXPECT_DOUBLE_EQ(track.weight, classes.weight.dot(classes.prior));
}

/// How far beliefs are from what is true, in sigmas. Where pi is P(class | plots) the term 1{class k} - pi_k has mean 0
/// and variance pi_k (1 - pi_k) given the plots, and pi_class, the belief in what is true, has mean sum pi_k^2 and
/// variance sum pi_k^3 - (sum pi_k^2)^2: sums over runs are normal, but for Berry-Esseen's .56 / sqrt(variance), some
/// percent of a sigma.
struct Calibration {
  explicit Calibration(int n) : error(Eigen::VectorXd::Zero(n)), variance(Eigen::VectorXd::Zero(n)) {}

  void add(const Eigen::VectorXd& belief, int truth) {
    const double square = belief.squaredNorm();
    error -= belief;
    error[truth] += 1.0;
    variance += belief.cwiseProduct(Eigen::VectorXd::Ones(belief.size()) - belief);
    error_in_truth += belief[truth] - square;
    variance_in_truth += belief.array().cube().sum() - square * square;
    in_truth += belief[truth];
  }
  /// Of each class, and of the belief in what is true.
  std::vector<double> sigmas() const {
    std::vector<double> all{error_in_truth / std::sqrt(variance_in_truth)};
    for (const double sigma : error.cwiseQuotient(variance.cwiseSqrt())) all.push_back(sigma);
    return all;
  }

  Eigen::VectorXd error;
  Eigen::VectorXd variance;
  double error_in_truth = 0.0;
  double variance_in_truth = 0.0;
  double in_truth = 0.0;
};

/// 50 km away, 3 m in range and across, P_d .8; `clutter` false plots in its footprint of 80 m by 80 m.
RangeBearingRadar radar(const Eigen::MatrixXd& emission, double clutter) {
  RadarFigures figures;
  figures.position_m = {0.0, -50e3};
  figures.range_noise_floor_m = 3.0;
  figures.azimuth_noise_floor_rad = 3.0 / 50e3;
  figures.detection = FixedDetection{0.8};
  figures.dwell_range_m = 40.0;
  figures.dwell_azimuth_rad = 40.0 / 50e3;
  figures.clutter_density = clutter / (4.0 * figures.dwell_range_m * figures.dwell_azimuth_rad);
  RangeBearingRadar sensor(figures);
  sensor.set_declaration({emission});
  return sensor;
}

/// Targets drawn from the prior, which move when they are looked at. `trusted`: the emission that the tracker has.
Calibration simulate(const TargetClasses& classes, const Eigen::MatrixXd& emission, const Eigen::MatrixXd& trusted,
                     double clutter, int looks, int runs) {
  const RangeBearingRadar truth = radar(emission, clutter);
  const RangeBearingRadar believed = radar(trusted, clutter);
  Tracker tracker = make_tracker(classes, Association::kPda);
  Calibration calibration(classes.size());
  const Gaussian belief = belief_at_origin();
  std::vector<Plot> plots;
  for (int run = 0; run < runs; ++run) {
    RandomStream stream = RandomStream(6).fork(static_cast<std::uint64_t>(run));
    Track track = tracker.start(TrackId{1}, "", belief);
    TargetTruth target{TargetId{1}, State::Zero(), draw_index(classes.prior.transpose(), stream)};
    for (int i = 0; i < kStateSize; ++i) target.state[i] = std::sqrt(belief.covariance(i, i)) * stream.normal();
    for (int look = 0; look < looks; ++look) {
      Dwell dwell = kDwell;
      dwell.time += from_seconds(look);
      dwell.pointing = track.combined.mean;
      target.target_class = draw_index(classes.transition.row(*target.target_class), stream);
      simulate_look(truth, dwell, std::span(&target, 1), stream, plots);
      (void)tracker.look(track, believed, dwell, plots);
    }
    calibration.add(track.class_belief, *target.target_class);
  }
  return calibration;
}

/// Three classes, declared right in three plots of five or so: after four looks there is doubt left.
struct Scenario {
  Scenario() {
    classes.names = {"a", "b", "c"};
    classes.prior = Eigen::Vector3d(0.5, 0.3, 0.2);
    classes.weight = Eigen::Vector3d::Ones();
    classes.transition = Eigen::Matrix3d::Identity();
    moving = classes;
    moving.transition << 0.9, 0.05, 0.05, 0.1, 0.8, 0.1, 0.0, 0.2, 0.8;
    emission.resize(3, 3);
    emission << 0.6, 0.25, 0.15, 0.2, 0.5, 0.3, 0.15, 0.25, 0.6;
    trusting.resize(3, 3);
    trusting << 0.9, 0.05, 0.05, 0.05, 0.9, 0.05, 0.05, 0.05, 0.9;
  }
  TargetClasses classes;
  TargetClasses moving;
  Eigen::MatrixXd emission;
  Eigen::MatrixXd trusting;
};

/// The average belief in what is true is the share of targets of which it is, and each class is as frequent as it is
/// believed to be. Without clutter the belief is exact after any number of looks; among false plots after one (then the
/// state is the moments of a mixture, no longer the mixture).
TEST(ClassBelief, IsCalibrated) {
  const Scenario s;
  const double band = statistics::normal_sum_band(1.0).high;
  const struct {
    const TargetClasses& classes;
    double clutter;
    int looks, runs;
  } cases[] = {{s.classes, 0.0, 4, 10'000},
               {s.moving, 0.0, 4, 10'000},
               {s.classes, 1.0, 1, 40'000},
               {s.moving, 10.0, 1, 20'000}};
  for (const auto& c : cases) {
    SCOPED_TRACE(testing::Message() << "clutter " << c.clutter << " looks " << c.looks);
    const Calibration calibration = simulate(c.classes, s.emission, s.emission, c.clutter, c.looks, scaled(c.runs));
    for (const double sigmas : calibration.sigmas()) EXPECT_LT(std::abs(sigmas), band);
    Eigen::VectorXd unseen = c.classes.prior;
    for (int look = 0; look < c.looks; ++look) move_class(c.classes, unseen);
    EXPECT_GT(calibration.in_truth / scaled(c.runs), unseen.squaredNorm()) << "something is learned";
  }
}

/// The check can fail: a tracker that takes the declarations for better than they are is found out.
TEST(ClassBelief, ThatTrustsTooMuchIsNotCalibrated) {
  const Scenario s;
  const Calibration calibration = simulate(s.classes, s.emission, s.trusting, 0.0, 4, 1000);
  EXPECT_LT(calibration.sigmas().front(), statistics::normal_sum_band(1.0).low);
}

}  // namespace
}  // namespace dwell
