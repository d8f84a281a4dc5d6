#include "radar/scripted_trajectory.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "radar/frames.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"

namespace dwell {
namespace {

using statistics::chi_square_band;
using statistics::normal_sum_band;

TimePoint at_s(double seconds) { return kStreamStart + from_seconds(seconds); }

Leg acceleration(double start_s, double end_s, const Vector2& acceleration_mps2) {
  return {.start = at_s(start_s), .end = at_s(end_s), .acceleration_mps2 = acceleration_mps2};
}

Leg turn(double start_s, double end_s, double rate_radps) {
  return {.start = at_s(start_s), .end = at_s(end_s), .turn_rate_radps = rate_radps};
}

Script script(const Vector2& position_m, const Vector2& velocity_mps, std::vector<Leg> legs = {}) {
  return {.initial = make_state(position_m, velocity_mps), .start = kStreamStart, .legs = std::move(legs)};
}

State state_at(const Script& script, double time_s) {
  return *ScriptedTrajectory(script, RandomStream(1)).advance(at_s(time_s));
}

// Positions of 1e5 m are rounded at each step, 1.5e-11 m: 1e-9 over some dozens of steps.
void expect_near(const State& actual, const State& expected, double bound = 1e-9) {
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), bound) << actual.transpose() << " not " << expected.transpose();
}

TEST(ScriptedTrajectory, FliesStraightWithoutLegs) {
  const Script flight = script({100e3, 200e3}, {-30.0, 250.0});
  for (const double t : {0.0, 0.1, 1.0, 59.9, 3600.0}) {
    expect_near(state_at(flight, t), make_state({100e3 - 30.0 * t, 200e3 + 250.0 * t}, {-30.0, 250.0}));
  }
}

TEST(ScriptedTrajectory, ExistsFromItsStartToItsEndInclusive) {
  Script flight = script({0.0, 0.0}, {10.0, 0.0});
  flight.start = at_s(5.0);
  flight.end = at_s(8.0);
  flight.altitude_m = 3000.0;
  ScriptedTrajectory trajectory(flight, RandomStream(1));
  EXPECT_FALSE(trajectory.advance(at_s(4.0)).has_value());
  EXPECT_EQ(trajectory.advance(at_s(5.0)), flight.initial);
  EXPECT_TRUE(trajectory.advance(at_s(8.0)).has_value());
  EXPECT_FALSE(trajectory.ended(at_s(8.0)));
  EXPECT_FALSE(trajectory.advance(at_s(9.0)).has_value());
  EXPECT_TRUE(trajectory.ended(at_s(9.0)));
  EXPECT_EQ(trajectory.altitude_m(), 3000.0);
  EXPECT_FALSE(trajectory.mode().has_value());
}

TEST(ScriptedTrajectory, AskedTwiceGivesTheSameState) {
  Script flight = script({0.0, 0.0}, {10.0, 0.0});
  flight.process_noise_root = StateMatrix::Identity();
  ScriptedTrajectory trajectory(flight, RandomStream(1));
  EXPECT_EQ(trajectory.advance(at_s(0.0)), flight.initial);
  const auto once = trajectory.advance(at_s(1.0));
  EXPECT_EQ(trajectory.advance(at_s(1.0)), once);
}

/// x0 + v0 t + a t^2 / 2 within the leg, straight before and after.
State accelerated(const Script& flight, double time_s) {
  const Leg& leg = flight.legs.front();
  const double before = std::min(time_s, to_seconds(leg.start));
  const double inside = std::clamp(time_s - to_seconds(leg.start), 0.0, to_seconds(leg.end - leg.start));
  const double after = std::max(0.0, time_s - to_seconds(leg.end));
  const Vector2 v0 = velocity(flight.initial);
  const Vector2 v1 = v0 + leg.acceleration_mps2 * inside;
  return make_state(
      position(flight.initial) + v0 * (before + inside) + 0.5 * leg.acceleration_mps2 * inside * inside + v1 * after,
      v1);
}

// Boundaries on scans, between scans, and a leg that begins and ends within one scan.
TEST(ScriptedTrajectory, AcceleratesAsTheClosedFormWhereverTheLegBegins) {
  for (const auto& [start_s, end_s] :
       {std::pair{3.0, 6.0}, {2.3, 4.7}, {4.0, 4.5}, {4.2, 4.7}, {0.0, 1.0}, {9.5, 20.0}}) {
    const Script flight = script({1e4, -2e4}, {200.0, -100.0}, {acceleration(start_s, end_s, {-20.0, 35.0})});
    ScriptedTrajectory trajectory(flight, RandomStream(1));
    for (int scan = 0; scan <= 12; ++scan) expect_near(*trajectory.advance(at_s(scan)), accelerated(flight, scan));
  }
}

// Evans, scenario 1: 2000 m/s south, (500, 400) m/s of change over 25 < t <= 28 s.
// Positions by hand: y(25) = 200e3 - 50e3; y(28) = 150e3 - 6e3 + 600 = 144.6e3; x(28) = 100e3 + 750.
TEST(ScriptedTrajectory, FliesTheManoeuvreOfEvans) {
  const Script flight = script({100e3, 200e3}, {0.0, -2000.0}, {acceleration(25.0, 28.0, {500.0 / 3.0, 400.0 / 3.0})});
  expect_near(state_at(flight, 25.0), make_state({100e3, 150e3}, {0.0, -2000.0}));
  expect_near(state_at(flight, 28.0), make_state({100.75e3, 144.6e3}, {500.0, -1600.0}));
  expect_near(state_at(flight, 60.0), make_state({116.75e3, 93.4e3}, {500.0, -1600.0}));
}

// Counter-clockwise positive: from north a quarter turn left ends heading west, a radius v / w to the west
// and north.
TEST(ScriptedTrajectory, TurnsAQuarterOntoTheKnownPoint) {
  const double w = 3.0 * kDegree;
  const double radius_m = 200.0 / w;
  const Script left = script({0.0, 0.0}, {0.0, 200.0}, {turn(10.0, 40.0, w)});
  expect_near(state_at(left, 40.0), make_state({-radius_m, 2000.0 + radius_m}, {-200.0, 0.0}));
  const Script right = script({0.0, 0.0}, {0.0, 200.0}, {turn(10.0, 40.0, -w)});
  expect_near(state_at(right, 40.0), make_state({radius_m, 2000.0 + radius_m}, {200.0, 0.0}));
}

TEST(ScriptedTrajectory, TurnKeepsSpeedAndTurnsByRateTimesDuration) {
  for (const double rate_dps : {-12.0, -0.01, 0.5, 9.0}) {
    const Script flight = script({3e3, 4e3}, {120.0, -90.0}, {turn(1.5, 21.25, rate_dps * kDegree)});
    const Vector2 v0 = velocity(flight.initial);
    ScriptedTrajectory trajectory(flight, RandomStream(1));
    for (int scan = 0; scan <= 30; ++scan) {
      const Vector2 v = velocity(*trajectory.advance(at_s(scan)));
      const double turned = rate_dps * kDegree * std::clamp(scan - 1.5, 0.0, 19.75);
      EXPECT_NEAR(v.norm(), 150.0, 1e-11);
      EXPECT_NEAR(wrap_angle(std::atan2(v.y(), v.x()) - std::atan2(v0.y(), v0.x()) - turned), 0.0, 1e-13);
    }
  }
}

TEST(ScriptedTrajectory, FullCircleReturnsToWhereItBegan) {
  const Script flight = script({5e3, 6e3}, {100.0, 100.0}, {turn(0.0, 60.0, 6.0 * kDegree)});
  expect_near(state_at(flight, 60.0), flight.initial);
}

TEST(ScriptedTrajectory, TurnStaysOnItsCircle) {
  const double w = -4.0 * kDegree;
  const Script flight = script({0.0, 0.0}, {0.0, 100.0}, {turn(0.0, 90.0, w)});
  const Vector2 centre(-100.0 / w, 0.0);
  for (int half = 0; half <= 180; ++half) {
    const double t = half / 2.0;
    EXPECT_NEAR((position(state_at(flight, t)) - centre).norm(), 100.0 / std::abs(w), 1e-9);
  }
}

// The law of any exact integration: where one is at a time does not depend on the steps that led there.
TEST(ScriptedTrajectory, DoesNotDependOnTheScanPeriod) {
  const Script flight = script({1e3, 2e3}, {150.0, 20.0},
                               {acceleration(0.0, 2.25, {5.0, -3.0}), turn(2.25, 7.4, 0.1), turn(7.4, 9.9, -0.3),
                                acceleration(11.3, 11.4, {100.0, 0.0})});
  const State direct = state_at(flight, 13.0);
  for (const double period_s : {0.1, 0.25, 1.0, 6.5}) {
    ScriptedTrajectory trajectory(flight, RandomStream(1));
    State last = flight.initial;
    for (TimePoint t = kStreamStart; t <= at_s(13.0); t += from_seconds(period_s)) last = *trajectory.advance(t);
    expect_near(last, direct);
  }
}

/// Sums of whitened draws with known laws: each component's squares chi-square(n), its sum N(0, n), and the
/// squares of sums of two components chi-square(n).
void expect_standard_normal(const std::vector<State>& draws) {
  const double n = static_cast<double>(draws.size());
  for (int i = 0; i < kStateSize; ++i) {
    double sum = 0.0;
    for (const State& draw : draws) sum += draw[i];
    EXPECT_TRUE(normal_sum_band(n).contains(sum)) << i;
    for (int j = 0; j <= i; ++j) {
      double squares = 0.0;
      for (const State& draw : draws) squares += i == j ? draw[i] * draw[i] : 0.5 * std::pow(draw[i] + draw[j], 2);
      EXPECT_TRUE(chi_square_band(n).contains(squares)) << i << ' ' << j << ": " << squares;
    }
  }
}

double sum_of_squares(const std::vector<State>& draws) {
  double sum = 0.0;
  for (const State& draw : draws) sum += draw.squaredNorm();
  return sum;
}

/// A Q with every correlation, positive definite: B B' of an arbitrary B.
StateMatrix full_root() {
  StateMatrix b;
  b << 3.0, 0.5, 0.2, -0.1, 1.0, 2.0, 0.0, 0.4, -0.5, 0.3, 4.0, 1.0, 0.2, -0.6, 1.5, 2.5;
  return b;
}

StateMatrix straight(double dt_s) {
  StateMatrix f = StateMatrix::Identity();
  f(kX, kVx) = f(kY, kVy) = dt_s;
  return f;
}

/// Whitened deviations from the noiseless flight at `time_s`, of `count` runs with scans of 1 s.
std::vector<State> deviations(const Script& flight, int time_s, const StateMatrix& covariance, int count) {
  Script quiet = flight;
  quiet.process_noise_root.setZero();
  const State expected = state_at(quiet, time_s);
  const Eigen::LLT<StateMatrix> root(covariance);
  std::vector<State> draws;
  for (int run = 0; run < count; ++run) {
    ScriptedTrajectory trajectory(flight, RandomStream(9).fork(static_cast<std::uint64_t>(run)));
    State x = flight.initial;
    for (int scan = 0; scan <= time_s; ++scan) x = *trajectory.advance(at_s(scan));
    draws.push_back(root.matrixL().solve(x - expected));
  }
  return draws;
}

TEST(ScriptedTrajectory, ProcessNoiseOfOneScanHasCovarianceQ) {
  Script flight = script({1e3, 2e3}, {30.0, 40.0});
  flight.process_noise_root = full_root();
  const StateMatrix q = full_root() * full_root().transpose();
  const auto draws = deviations(flight, 1, q, scaled(20'000));
  expect_standard_normal(draws);
  const auto band = chi_square_band(4.0 * static_cast<double>(draws.size()));
  EXPECT_TRUE(band.contains(sum_of_squares(draws)));
  EXPECT_FALSE(band.contains(sum_of_squares(draws) / 10.0));  // twin: Q / 10
}

// P(k) = F P(k-1) F' + Q, P(0) = 0: nothing is added at the start itself.
TEST(ScriptedTrajectory, ProcessNoiseAddsUpOverScans) {
  Script flight = script({1e3, 2e3}, {30.0, 40.0});
  flight.process_noise_root = full_root();
  StateMatrix covariance = StateMatrix::Zero();
  for (int k = 0; k < 7; ++k) {
    covariance = straight(1.0) * covariance * straight(1.0).transpose() + full_root() * full_root().transpose();
  }
  expect_standard_normal(deviations(flight, 7, covariance, scaled(20'000)));
}

// Legs act on (start, end]: the scan at the start has the plain variance, those inside and at the end ten
// times it.
TEST(ScriptedTrajectory, NoiseScaleMultipliesTheVarianceInsideTheLeg) {
  Script flight = script({1e3, 2e3}, {30.0, 40.0}, {acceleration(2.0, 4.0, {0.0, 0.0})});
  flight.legs[0].process_noise_scale = 10.0;
  flight.process_noise_root = full_root();
  const StateMatrix q = full_root() * full_root().transpose();
  StateMatrix covariance = StateMatrix::Zero();
  for (const auto& [scan, scale] : {std::pair{1, 1.0}, {2, 1.0}, {3, 10.0}, {4, 10.0}, {5, 1.0}}) {
    covariance = straight(1.0) * covariance * straight(1.0).transpose() + scale * q;
    expect_standard_normal(deviations(flight, scan, covariance, scaled(20'000)));
  }
}

// The leg ends between scans 4 and 5: scan 4 lies inside, scan 5 does not.
TEST(ScriptedTrajectory, NoiseScaleIsThatOfTheScanTime) {
  Script flight = script({1e3, 2e3}, {30.0, 40.0}, {acceleration(3.5, 4.5, {0.0, 0.0})});
  flight.legs[0].process_noise_scale = 0.0;
  flight.process_noise_root = full_root();
  ScriptedTrajectory trajectory(flight, RandomStream(1));
  State before = *trajectory.advance(at_s(0.0));
  for (int scan = 1; scan <= 6; ++scan) {
    const State now = *trajectory.advance(at_s(scan));
    const double noise = (now - straight(1.0) * before).norm();
    if (scan == 4) {
      EXPECT_LE(noise, 1e-9);
    } else {
      EXPECT_GT(noise, 1e-3);
    }
    before = now;
  }
}

TEST(ScriptedTrajectory, SameStreamIsTheSameFlight) {
  Script flight = script({1e3, 2e3}, {30.0, 40.0});
  flight.process_noise_root = full_root();
  ScriptedTrajectory one(flight, RandomStream(5)), two(flight, RandomStream(5)), other(flight, RandomStream(6));
  for (int scan = 0; scan <= 100; ++scan) {
    const auto x = one.advance(at_s(scan));
    EXPECT_EQ(two.advance(at_s(scan)), x);
    EXPECT_EQ(other.advance(at_s(scan)) == x, scan == 0);
  }
}

}  // namespace
}  // namespace dwell
