#include "tracker/initiation.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/scale.hpp"
#include "tests/statistics.hpp"
#include "tests/tracker/matrices.hpp"
#include "tests/tracker/position_sensor.hpp"

namespace dwell {
namespace {

using matrices::near;

const Dwell kDwell{RadarId{1}, TrackId{}, kStreamStart, State::Zero()};

Plot plot_at(const Vector2& z) { return {kDwell.time, kDwell.radar, z, std::nullopt}; }

/// Nearly constant velocity, q = 1, over one second.
Tracker moving_tracker(const TrackerSettings& settings) {
  const ConstantVelocity motion;
  return {{{transition(motion, 1.0)}, {white_noise(motion, 1.0, 1.0)}, Eigen::MatrixXd::Ones(1, 1)},
          Eigen::VectorXd::Ones(1),
          settings};
}

/// Plots of a target at 100 m/s east, at looks 2 s apart, without noise.
std::vector<Plot> target_at(int look) { return {plot_at({200.0 * look, 50.0})}; }

TEST(Initiation, TwoPointsGiveDifferencedBelief) {
  const PositionSensor sensor((Matrix2() << 9.0, 2.0, 2.0, 4.0).finished(), 0.9, 0.0);
  Tracker tracker = moving_tracker({});
  TrackInitiation initiation({.m_of_n = MOfN{2, 2}}, 2, 1.0);
  std::vector<Track> found;
  initiation.look(tracker, sensor, kDwell, target_at(0), {}, found);
  EXPECT_EQ(initiation.tentative(), 0U);
  initiation.look(tracker, sensor, kDwell, target_at(1), {}, found);
  ASSERT_EQ(initiation.tentative(), 1U);
  initiation.look(tracker, sensor, kDwell, {}, {}, found);  // 2 of 2 are there already
  ASSERT_EQ(found.size(), 1U);
  Track expected = tracker.start(TrackId{}, "", {});
  expected.estimate.modes[0].mean = State(200.0, 100.0, 50.0, 0.0);
  StateMatrix& p = expected.estimate.modes[0].covariance;
  const Matrix2 r = sensor.noise({});
  p({kX, kY}, {kX, kY}) = r;
  p({kX, kY}, {kVx, kVy}) = p({kVx, kVy}, {kX, kY}) = r / 2.0;
  p({kVx, kVy}, {kVx, kVy}) = r / 2.0;  // (R + R) / 2^2
  tracker.predict(expected);
  tracker.predict(expected);
  EXPECT_TRUE(near(found[0].combined.mean, expected.combined.mean, 1e-12));
  EXPECT_TRUE(near(found[0].combined.covariance, expected.combined.covariance, 1e-12));
}

/// Looks until a target that is always seen is confirmed; 0 where it is not within ten.
int looks_to_confirm(const TrackerSettings& settings, const InitiationSettings& rule, double density = 0.0) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, density, 1e5);
  Tracker tracker = moving_tracker(settings);
  TrackInitiation initiation(rule, 2, 1.0);
  std::vector<Track> found;
  for (int look = 0; look < 10; ++look) {
    initiation.look(tracker, sensor, kDwell, target_at(look), {}, found);
    if (!found.empty()) return look + 1;
  }
  return 0;
}

TEST(Initiation, MOfNConfirmsAtTheMthPlot) {
  EXPECT_EQ(looks_to_confirm({}, {.m_of_n = MOfN{4, 5}}), 4);
  EXPECT_EQ(looks_to_confirm({}, {.m_of_n = MOfN{3, 3}}), 3);
}

TEST(Initiation, SpeedLimitIsKept) {
  EXPECT_EQ(looks_to_confirm({}, {.largest_speed_mps = 95.0, .m_of_n = MOfN{3, 3}}), 3);  // with 3 sigma of 18 m more
  EXPECT_EQ(looks_to_confirm({}, {.largest_speed_mps = 85.0, .m_of_n = MOfN{3, 3}}), 0);
}

// One pair in two looks is at most one to one; two plots of likelihood ratios 10 and more follow, and one is not
// enough. With 1e-3 of a false plot in the speed gate and 5 in the coverage the odds are .027 / .005, cut to one; a
// thousand times as many false pairs take more plots.
TEST(Initiation, ExistenceConfirms) {
  const TrackerSettings ipda{.association = Association::kIpda};
  EXPECT_EQ(looks_to_confirm(ipda, {}), 3);
  EXPECT_EQ(looks_to_confirm(ipda, {}, 3e-10), 3);
  EXPECT_GT(looks_to_confirm(ipda, {}, 1e-5), 3);
}

TEST(Initiation, MissesEndATentativeTrack) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 1e-9, 1e5);
  for (const bool by_existence : {true, false}) {
    Tracker tracker = moving_tracker({.association = by_existence ? Association::kIpda : Association::kNearest});
    InitiationSettings rule;
    if (!by_existence) rule.m_of_n = MOfN{4, 5};
    TrackInitiation initiation(rule, 2, 1.0);
    std::vector<Track> found;
    for (int look = 0; look < 2; ++look) initiation.look(tracker, sensor, kDwell, target_at(look), {}, found);
    initiation.look(tracker, sensor, kDwell, {}, {}, found);
    EXPECT_EQ(initiation.tentative(), 1U);
    initiation.look(tracker, sensor, kDwell, {}, {}, found);  // .1^2 < .05; 2 misses of at most 1
    EXPECT_EQ(initiation.tentative(), 0U);
    EXPECT_TRUE(found.empty());
  }
}

TEST(Initiation, PlotsOfConfirmedTracksAreWithheld) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 0.0);
  Tracker tracker = moving_tracker({});
  TrackInitiation initiation({.m_of_n = MOfN{2, 2}}, 2, 1.0);
  std::vector<Track> found;
  std::vector<Track> confirmed{tracker.start(TrackId{1}, "", {State(0.0, 100.0, 50.0, 0.0), StateMatrix::Identity()})};
  for (int look = 0; look < 4; ++look) {
    initiation.look(tracker, sensor, kDwell, target_at(look), confirmed, found);
    EXPECT_EQ(initiation.tentative() + found.size(), 0U);
    tracker.predict(confirmed[0]);
    tracker.predict(confirmed[0]);
  }
}

TEST(Initiation, OneTargetGivesOneTrack) {
  const PositionSensor sensor(9.0 * Matrix2::Identity(), 0.9, 1e-9, 1e5);
  Tracker tracker = moving_tracker({.association = Association::kIpda});
  TrackInitiation initiation({}, 2, 1.0);
  std::vector<Track> found;
  std::vector<Plot> first = target_at(0);  // and another that pairs with the second look's plot as well
  first.push_back(plot_at({3.0, 48.0}));
  initiation.look(tracker, sensor, kDwell, first, {}, found);
  initiation.look(tracker, sensor, kDwell, target_at(1), {}, found);
  EXPECT_EQ(initiation.tentative(), 2U);
  initiation.look(tracker, sensor, kDwell, target_at(2), {}, found);
  EXPECT_EQ(initiation.tentative() + found.size(), 1U);
}

/// Confirmed tracks of looks at clutter alone, and what the martingale of the likelihood ratio allows on average: each
/// tentative track gets there with probability at most its first odds over 99, whatever follows.
struct FalseTracks {
  int begun = 0;
  int confirmed = 0;
  double allowed = 0.0;
};

FalseTracks look_at_clutter(double density_believed) {
  constexpr double kHalf = 2000.0;
  constexpr double kDensity = 2.5e-6;  // 40 plots a look, 7.9 of them in the speed gate of 1 km
  const PositionSensor sensor(400.0 * Matrix2::Identity(), 0.9, density_believed, kHalf);
  Tracker tracker = moving_tracker({.association = Association::kIpda, .existence = {.new_targets_per_hour = 36000.0}});
  RandomStream stream(7);
  FalseTracks tracks;
  for (int run = 0; run < scaled(20); ++run) {
    TrackInitiation initiation({}, 2, 1.0);
    std::vector<Track> found;
    for (int look = 0; look < 20; ++look) {
      std::vector<Plot> plots;
      const int count = stream.poisson(kDensity * 4.0 * kHalf * kHalf);
      for (int i = 0; i < count; ++i) {
        const double x = stream.uniform(-kHalf, kHalf);
        plots.push_back(plot_at({x, stream.uniform(-kHalf, kHalf)}));
      }
      initiation.look(tracker, sensor, kDwell, plots, {}, found);
      tracks.confirmed += static_cast<int>(found.size());
      tracks.begun += static_cast<int>(initiation.tentative());  // no less than those begun at this look
    }
  }
  // 20 targets x .81 expected between looks against 40 x 7.9 false pairs.
  tracks.allowed = tracks.begun * (20.0 * 0.81 / (40.0 * 7.854)) / 99.0;
  return tracks;
}

// Tracks that share plots are settled in favour of one, so the count varies no more than a Poisson one.
TEST(Initiation, FalseTracksAreNoMoreThanTheMartingaleAllows) {
  const FalseTracks tracks = look_at_clutter(2.5e-6);
  RecordProperty("begun", tracks.begun);
  RecordProperty("confirmed", tracks.confirmed);
  EXPECT_GT(tracks.begun, scaled(20) * 1000);
  EXPECT_LE(tracks.confirmed, statistics::poisson_band(tracks.allowed).high);
}

TEST(Initiation, DensityTenTimesTooSmallGivesMoreFalseTracks) {
  const FalseTracks tracks = look_at_clutter(2.5e-7);
  EXPECT_GT(tracks.confirmed, statistics::poisson_band(tracks.allowed).high);
}

}  // namespace
}  // namespace dwell
