#include "radar/jump_markov_trajectory.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "radar/frames.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"

namespace dwell {
namespace {

using statistics::binomial_band;
using statistics::chi_square_band;

TimePoint at_s(double seconds) { return kStreamStart + from_seconds(seconds); }

/// A turn of rate w over dt, w = 0 straight: the textbook F of a coordinated turn.
StateMatrix turning(double w, double dt_s) {
  const double s = std::sin(w * dt_s), c = std::cos(w * dt_s);
  const double a = w == 0.0 ? dt_s : s / w, b = w == 0.0 ? 0.0 : (1.0 - c) / w;
  StateMatrix f;
  f << 1.0, a, 0.0, -b,  //
      0.0, c, 0.0, -s,   //
      0.0, b, 1.0, a,    //
      0.0, s, 0.0, c;
  return f;
}

/// Straight, left and right at 5 degrees a second; no noise, so that speed is constant.
JumpMarkovSystem three_modes() {
  JumpMarkovSystem system;
  for (const double rate_dps : {0.0, 5.0, -5.0}) system.transition_matrix.push_back(turning(rate_dps * kDegree, 1.0));
  system.process_noise_root.assign(3, StateMatrix::Zero());
  system.transition.resize(3, 3);
  system.transition << 0.90, 0.07, 0.03, 0.20, 0.80, 0.00, 0.10, 0.25, 0.65;
  return system;
}

JumpMarkovScript script_of(const State& initial) {
  return {.initial = initial, .start = kStreamStart, .scan_period = from_seconds(1.0), .area = std::nullopt};
}

TEST(DrawIndex, HasTheGivenProbabilities) {
  const Eigen::RowVector4d probability(0.5, 0.0, 0.125, 0.375);
  std::array<int, 4> counts{};
  RandomStream stream(1);
  const int count = scaled(100'000);
  for (int i = 0; i < count; ++i) ++counts[static_cast<std::size_t>(draw_index(probability, stream))];
  for (std::size_t i = 0; i < 4; ++i) {
    const double p = probability[static_cast<Eigen::Index>(i)];
    EXPECT_TRUE(binomial_band(count, p).contains(counts[i])) << i << ": " << counts[i];
    if (p > 0.0) {
      EXPECT_FALSE(binomial_band(count, 0.85 * p).contains(counts[i])) << i;
    }
  }
}

TEST(DrawIndex, IsCertainWhereTheProbabilityIs) {
  RandomStream stream(2);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(draw_index(Eigen::RowVector3d(0.0, 1.0, 0.0), stream), 1);
    EXPECT_EQ(draw_index(Eigen::RowVectorXd::Ones(1), stream), 0);
  }
}

TEST(JumpMarkovTrajectory, ExistsFromItsStartToItsEndInclusive) {
  JumpMarkovScript script = script_of(make_state({0.0, 0.0}, {10.0, 0.0}));
  script.start = at_s(2.0);
  script.end = at_s(5.0);
  script.initial_mode = 2;
  script.altitude_m = 800.0;
  JumpMarkovTrajectory trajectory(three_modes(), script, RandomStream(1));
  EXPECT_FALSE(trajectory.advance(at_s(1.0)).has_value());
  EXPECT_EQ(trajectory.advance(at_s(2.0)), script.initial);
  EXPECT_EQ(trajectory.mode(), 2);
  EXPECT_TRUE(trajectory.advance(at_s(5.0)).has_value());
  EXPECT_FALSE(trajectory.ended(at_s(5.0)));
  EXPECT_FALSE(trajectory.advance(at_s(6.0)).has_value());
  EXPECT_TRUE(trajectory.ended(at_s(6.0)));
  EXPECT_EQ(trajectory.altitude_m(), 800.0);
}

TEST(JumpMarkovTrajectory, IsMovedByTheModeItReports) {
  const JumpMarkovSystem system = three_modes();
  JumpMarkovTrajectory trajectory(system, script_of(make_state({0.0, 0.0}, {80.0, 60.0})), RandomStream(3));
  State before = *trajectory.advance(at_s(0.0));
  std::array<bool, 3> visited{};
  for (int scan = 1; scan <= 500; ++scan) {
    const State now = *trajectory.advance(at_s(scan));
    const auto mode = static_cast<std::size_t>(trajectory.mode().value());
    EXPECT_EQ(now, system.transition_matrix[mode] * before);
    visited[mode] = true;
    before = now;
  }
  EXPECT_TRUE(visited[0] && visited[1] && visited[2]);
}

TEST(JumpMarkovTrajectory, SkippedScansAreFlownAllTheSame) {
  JumpMarkovTrajectory every(three_modes(), script_of(make_state({0.0, 0.0}, {80.0, 60.0})), RandomStream(3));
  JumpMarkovTrajectory some = every;
  for (int scan = 0; scan <= 50; ++scan) {
    const auto x = every.advance(at_s(scan));
    if (scan % 7 == 0) {
      EXPECT_EQ(some.advance(at_s(scan)), x);
    }
  }
}

// East at 100 m/s; from 450 m on it turns, until it heads west. The scan that finds the guard holding is the first of
// the new mode: at 5 s the target is at 500 m, and 6 s is the first second of the turn.
TEST(JumpMarkovTrajectory, ChangesModeByItsGuards) {
  JumpMarkovSystem system{
      {turning(0.0, 1.0), turning(10.0 * kDegree, 1.0)}, {2, StateMatrix::Zero()}, Eigen::MatrixXd::Identity(2, 2), {}};
  const Eigen::RowVector4d beyond(-1.0, 0.0, 0.0, 0.0);
  system.guards.push_back({0, 1, beyond, Eigen::VectorXd::Constant(1, 450.0), Eigen::MatrixXd::Zero(1, 1)});
  Eigen::Matrix<double, 2, 4> heading;
  heading << 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  system.guards.push_back({1, 0, heading, Eigen::Vector2d(0.0, -1e-9), Eigen::MatrixXd::Zero(2, 2)});
  JumpMarkovTrajectory trajectory(system, script_of(make_state({0.0, 0.0}, {100.0, 0.0})), RandomStream(1));
  for (int second = 0; second <= 23; ++second) {
    (void)trajectory.advance(at_s(second));
    EXPECT_EQ(trajectory.mode(), second >= 6 ? 1 : 0) << second;
  }
  State x = *trajectory.advance(at_s(24.0));  // 18 steps of 10 degrees after 5 s: west, and at 450 m already
  EXPECT_EQ(trajectory.mode(), 0);
  EXPECT_NEAR(velocity(x).x(), -100.0, 1e-9);
}

// The threshold of a guard is drawn at every scan: a standing target is beyond it with Phi(1).
TEST(JumpMarkovTrajectory, DrawsTheThresholdsOfItsGuards) {
  JumpMarkovSystem system{
      {2, StateMatrix::Identity()}, {2, StateMatrix::Zero()}, (Eigen::Matrix2d() << 1.0, 0.0, 1.0, 0.0).finished(), {}};
  const Eigen::RowVector4d x_alone(1.0, 0.0, 0.0, 0.0);
  system.guards.push_back({0, 1, x_alone, Eigen::VectorXd::Constant(1, -25.0), Eigen::MatrixXd::Constant(1, 1, 5.0)});
  JumpMarkovTrajectory trajectory(system, script_of(make_state({20.0, 0.0}, {0.0, 0.0})), RandomStream(2));
  const int trials = scaled(20'000);
  int tried = 0;
  int changed = 0;
  (void)trajectory.advance(at_s(0.0));
  for (int scan = 1; tried < trials; ++scan) {
    const bool in_first = trajectory.mode() == 0;
    (void)trajectory.advance(at_s(scan));
    tried += in_first ? 1 : 0;
    changed += in_first && trajectory.mode() == 1 ? 1 : 0;
  }
  EXPECT_TRUE(binomial_band(trials, statistics::normal_cdf(1.0)).contains(changed)) << changed;
}

// The first m jumps out of each mode are independent draws from its row, whatever the chain does between
// them: exact binomial counts. Twin: the transposed matrix, columns taken for rows.
TEST(JumpMarkovTrajectory, JumpsWithTheRowsOfItsTransitionMatrix) {
  const JumpMarkovSystem system = three_modes();
  JumpMarkovTrajectory trajectory(system, script_of(State::Zero()), RandomStream(4));
  const int jumps = scaled(20'000);
  Eigen::Matrix3i counts = Eigen::Matrix3i::Zero();
  int scan = 0;
  (void)trajectory.advance(at_s(scan));
  while (counts.rowwise().sum().minCoeff() < jumps) {
    const int from = trajectory.mode().value();
    (void)trajectory.advance(at_s(++scan));
    if (counts.row(from).sum() < jumps) ++counts(from, trajectory.mode().value());
  }
  int transposed_fits = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_TRUE(binomial_band(jumps, system.transition(i, j)).contains(counts(i, j)))
          << i << j << ": " << counts(i, j);
      transposed_fits += i != j && binomial_band(jumps, system.transition(j, i)).contains(counts(i, j));
    }
  }
  EXPECT_EQ(transposed_fits, 0);
}

// Each mode's steps, whitened by its own L: sums of squares chi-square(4 n). Twin: whitened by the other
// mode's.
TEST(JumpMarkovTrajectory, NoiseIsThatOfTheMode) {
  JumpMarkovSystem system = three_modes();
  system.process_noise_root[0].diagonal() << 1.0, 2.0, 3.0, 4.0;
  system.process_noise_root[1] = StateMatrix::Identity() * 5.0;
  system.process_noise_root[1](3, 0) = 7.0;
  system.process_noise_root[2] = StateMatrix::Identity() * 0.1;
  JumpMarkovTrajectory trajectory(system, script_of(State::Zero()), RandomStream(5));
  std::array<double, 3> squares{}, wrong{}, count{};
  State before = *trajectory.advance(at_s(0.0));
  for (int scan = 1; scan <= scaled(50'000); ++scan) {
    const State now = *trajectory.advance(at_s(scan));
    const auto mode = static_cast<std::size_t>(trajectory.mode().value());
    const State noise = now - system.transition_matrix[mode] * before;
    const auto whitened = [&](std::size_t m) -> State {
      return system.process_noise_root[m].triangularView<Eigen::Lower>().solve(noise);
    };
    squares[mode] += whitened(mode).squaredNorm();
    wrong[mode] += whitened((mode + 1) % 3).squaredNorm();
    count[mode] += 1.0;
    before = now;
  }
  for (std::size_t mode = 0; mode < 3; ++mode) {
    EXPECT_TRUE(chi_square_band(4.0 * count[mode]).contains(squares[mode])) << mode << ": " << squares[mode];
    EXPECT_FALSE(chi_square_band(4.0 * count[mode]).contains(wrong[mode])) << mode;
  }
}

/// How far from the centre a target of constant speed v can come: one step beyond the edge, then at most once
/// round the outer side of its turning circle (radius rho = v / w), whose centre lies no farther out than a
/// right angle:
///   sqrt((R + v dt)^2 + rho^2) + rho.
/// Once it heads within 60 degrees of the centre a mode may bend it by 5 degrees a step, which leaves it
/// closing.
double farthest_m(const Area& area, double speed_mps, double dt_s) {
  const double rho = speed_mps / area.turn_rate_radps;
  return std::hypot(area.radius_m + speed_mps * dt_s, rho) + rho;
}

TEST(JumpMarkovTrajectory, StaysWithinItsAreaAndTheTurnBeyondIt) {
  const Area area{.centre_m = {50e3, -30e3}, .radius_m = 15e3, .turn_rate_radps = 6.0 * kDegree};
  JumpMarkovScript script = script_of(make_state({50e3, -20e3}, {0.0, 200.0}));
  script.area = area;
  JumpMarkovTrajectory bounded(three_modes(), script, RandomStream(6));
  script.area.reset();
  JumpMarkovTrajectory unbounded(three_modes(), script, RandomStream(6));
  double farthest = 0.0, twin = 0.0;
  int outside = 0, longest_outside = 0;
  for (int scan = 0; scan <= scaled(100'000); ++scan) {
    const State x = *bounded.advance(at_s(scan));
    const double distance = (position(x) - area.centre_m).norm();
    EXPECT_NEAR(velocity(x).norm(), 200.0, 1e-6);
    farthest = std::max(farthest, distance);
    twin = std::max(twin, (position(*unbounded.advance(at_s(scan))) - area.centre_m).norm());
    outside = distance > area.radius_m ? outside + 1 : 0;
    longest_outside = std::max(longest_outside, outside);
  }
  EXPECT_LE(farthest, farthest_m(area, 200.0, 1.0));
  EXPECT_GT(farthest, area.radius_m);  // it was there
  EXPECT_GT(twin, farthest_m(area, 200.0, 1.0));
  // Back inside: the heading gains w - v / R = w (1 - rho / R) on the bearing of the centre, 120 degrees at
  // most; from then on the distance falls by v cos(66 deg) a second at least (60, a mode's 5, and 0.8 by
  // which the bearing of the centre moves in a step).
  const double rho = 200.0 / area.turn_rate_radps;
  const double turning_s = 120.0 * kDegree / (area.turn_rate_radps * (1.0 - rho / area.radius_m));
  const double closing_s = (farthest_m(area, 200.0, 1.0) - area.radius_m) / (200.0 * std::cos(66.0 * kDegree));
  EXPECT_LE(longest_outside, turning_s + closing_s + 2.0);
}

TEST(JumpMarkovTrajectory, ComesBackFromFarOutside) {
  for (const double azimuth_deg : {0.0, 80.0, 180.0, -170.0, -60.0}) {
    JumpMarkovScript script =
        script_of(make_state({40e3, 0.0}, 150.0 * to_cartesian({0, 0}, {1.0, azimuth_deg * kDegree})));
    script.area = Area{.radius_m = 20e3, .turn_rate_radps = 3.0 * kDegree};
    JumpMarkovTrajectory trajectory(three_modes(), script, RandomStream(7));
    // 20 km at 150 m/s cos(66 deg), and the turn: 328 s + 46 s.
    double nearest = 1e9;
    for (int scan = 0; scan <= 400; ++scan)
      nearest = std::min(nearest, position(*trajectory.advance(at_s(scan))).norm());
    EXPECT_LE(nearest, 20e3) << azimuth_deg;
  }
}

// Speed falls by exp(-w dt) a scan down to that of the start; a scan of turning without it is the arc of a
// circle.
TEST(JumpMarkovTrajectory, SlowsDownToItsFirstSpeedWhileItTurnsBack) {
  const double w = 3.0 * kDegree;
  JumpMarkovSystem gust;  // straight, and one scan later half as fast again
  gust.transition_matrix = {turning(0.0, 1.0) * Eigen::Vector4d(1.0, 1.5, 1.0, 1.5).asDiagonal()};
  gust.process_noise_root = {StateMatrix::Zero()};
  gust.transition = Eigen::MatrixXd::Ones(1, 1);
  JumpMarkovScript script = script_of(make_state({0.0, 20e3 - 10.0}, {0.0, 200.0}));
  script.area = Area{.radius_m = 20e3, .turn_rate_radps = w};
  JumpMarkovTrajectory trajectory(gust, script, RandomStream(9));
  EXPECT_EQ(velocity(*trajectory.advance(at_s(0))).norm(), 200.0);
  double speed = 300.0;
  for (int scan = 1; scan <= 30; ++scan) {
    const Vector2 v = velocity(*trajectory.advance(at_s(scan)));
    EXPECT_NEAR(v.norm(), speed, 1e-9) << scan;
    EXPECT_NEAR(std::abs(std::atan2(v.x(), v.y())), (scan - 1) * w, 1e-12);
    speed = std::max(200.0, speed * std::exp(-w));
  }
}

// exp((i w - d) t) integrated: compared with ten thousand trapezoids, error v w^2 1e-8 / 12.
TEST(JumpMarkovTrajectory, SpiralIsTheIntegralOfItsVelocity) {
  const double w = 3.0 * kDegree;
  JumpMarkovSystem fast = three_modes();
  for (auto& f : fast.transition_matrix) f *= Eigen::Vector4d(1.0, 2.0, 1.0, 2.0).asDiagonal();
  JumpMarkovScript script = script_of(make_state({19.9e3, 0.0}, {200.0, 30.0}));
  script.area = Area{.radius_m = 20e3, .turn_rate_radps = w};
  JumpMarkovTrajectory trajectory(fast, script, RandomStream(9));
  const State before = *trajectory.advance(at_s(1));
  const State after = *trajectory.advance(at_s(2));
  const double sense = before[kVx] * after[kVy] > before[kVy] * after[kVx] ? 1.0 : -1.0;
  Vector2 place = position(before), v = velocity(before);
  constexpr int kSteps = 10'000;
  for (int i = 0; i < kSteps; ++i) {
    const double dt_s = 1.0 / kSteps;
    const Vector2 next = std::exp(-w * dt_s) * (Eigen::Rotation2Dd(sense * w * dt_s) * v);
    place += 0.5 * dt_s * (v + next);
    v = next;
  }
  EXPECT_LE((place - position(after)).norm(), 1e-6);
  EXPECT_LE((v - velocity(after)).norm(), 1e-9);
}

// White-noise acceleration adds 2 q a second to the mean square speed: free, (200 m/s)^2 + q N on average
// over N seconds. Bounded, it grows for the crossing alone, 2 R / v = 200 s: under (200 m/s)^2 + 200 x 2 q =
// (237 m/s)^2.
TEST(JumpMarkovTrajectory, SpeedDoesNotGrowWithoutLimitInsideAnArea) {
  const double q = 40.0;
  StateMatrix noise = StateMatrix::Zero();
  for (const int i : {kX, kY}) {
    noise(i, i) = q / 3.0;
    noise(i + 1, i + 1) = q;
    noise(i, i + 1) = noise(i + 1, i) = q / 2.0;
  }
  JumpMarkovSystem system;
  system.transition_matrix = {turning(0.0, 1.0)};
  system.process_noise_root = {noise.llt().matrixL()};
  system.transition = Eigen::MatrixXd::Ones(1, 1);
  JumpMarkovScript script = script_of(make_state({0.0, 0.0}, {0.0, 200.0}));
  JumpMarkovTrajectory free(system, script, RandomStream(10));
  script.area = Area{.radius_m = 20e3, .turn_rate_radps = 3.0 * kDegree};
  JumpMarkovTrajectory bounded(system, script, RandomStream(10));
  double squares = 0.0, free_squares = 0.0;
  const int count = scaled(100'000);
  for (int scan = 1; scan <= count; ++scan) {
    squares += velocity(*bounded.advance(at_s(scan))).squaredNorm();
    free_squares += velocity(*free.advance(at_s(scan))).squaredNorm();
  }
  EXPECT_LE(std::sqrt(squares / count), 237.0);
  EXPECT_GT(std::sqrt(free_squares / count), 237.0);
}

TEST(JumpMarkovTrajectory, AtRestOutsideItsAreaStaysAtRest) {
  JumpMarkovScript script = script_of(make_state({30e3, 0.0}, {0.0, 0.0}));
  script.area = Area{.radius_m = 20e3, .turn_rate_radps = 3.0 * kDegree};
  JumpMarkovTrajectory trajectory(three_modes(), script, RandomStream(11));
  EXPECT_EQ(*trajectory.advance(at_s(10)), script.initial);
}

TEST(JumpMarkovTrajectory, ModesMoveOnWhileItTurnsBack) {
  JumpMarkovScript script = script_of(make_state({0.0, 0.0}, {0.0, 100.0}));
  JumpMarkovTrajectory free(three_modes(), script, RandomStream(8));
  script.area = Area{.radius_m = 1e3, .turn_rate_radps = 10.0 * kDegree};
  JumpMarkovTrajectory bounded(three_modes(), script, RandomStream(8));
  for (int scan = 0; scan <= 1000; ++scan) {
    (void)free.advance(at_s(scan));
    (void)bounded.advance(at_s(scan));
    EXPECT_EQ(free.mode(), bounded.mode());
  }
}

}  // namespace
}  // namespace dwell
