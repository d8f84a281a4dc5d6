#include "tracker/unlike_modes.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/scale.hpp"
#include "tests/statistics.hpp"
#include "tests/tracker/catalogue.hpp"
#include "tests/tracker/matrices.hpp"
#include "tests/tracker/position_sensor.hpp"
#include "tracker/measurement.hpp"

namespace dwell {
namespace {

using matrices::kEpsilon;
using matrices::near;

using catalogue::every_trailing;
using catalogue::NamedTrailing;

std::vector<NamedTrailing> every_linear() {
  std::vector<NamedTrailing> rows;
  for (const NamedTrailing& row : every_trailing()) {
    if (is_linear(row.model)) rows.push_back(row);
  }
  return rows;
}

FullState some_state(double rate) {
  FullState x;
  x << 1e3, 150.0, -2e3, 80.0, rate, 0.0;
  return x;
}

class TrailingLaw : public testing::TestWithParam<NamedTrailing> {};
INSTANTIATE_TEST_SUITE_P(Every, TrailingLaw, testing::ValuesIn(every_trailing()),
                         [](const auto& row) { return row.param.name; });

// F(a + b) = F(b) F(a) and Q(a + b) = F(b) Q(a) F(b)' + Q(b), of a nonlinear motion F(b) and Q(b) where a leads: the
// series, the closed form and the quadrature agree to some tens of eps of the largest terms.
TEST_P(TrailingLaw, IntervalsCompose) {
  for (const double a : {0.0, 0.125, 1.0, 3.5}) {
    for (const double b : {0.25, 1.0, 10.0}) {
      const FullState x = some_state(is_linear(GetParam().model) ? 3.0 : 0.3);
      const Moved first = move(GetParam().model, a, x);
      const Moved second = move(GetParam().model, b, first.mean);
      const Moved both = move(GetParam().model, a + b, x);
      EXPECT_TRUE(near(second.f * first.f, both.f, 64.0 * kEpsilon * (second.f.cwiseAbs() * first.f.cwiseAbs())));
      const FullMatrix q = second.f * first.q * second.f.transpose() + second.q;
      const FullState sigma = both.q.diagonal().cwiseSqrt();
      EXPECT_TRUE(near(q, both.q, 1e-12 * FullMatrix(sigma * sigma.transpose()))) << a << " " << b;
      EXPECT_TRUE(near(second.mean, both.mean, 1e-12 * both.mean.cwiseAbs().maxCoeff()));
    }
  }
}

// q [T^5/20 T^4/8 T^3/6; . T^3/3 T^2/2; . . T]: Bar-Shalom, Li, Kirubarajan (2001), 6.2.3.
TEST(ConstantAcceleration, NoiseAsInTheBook) {
  const double t = 3.0;
  const Moved moved = move(ConstantAcceleration{2.0}, t, some_state(1.0));
  const auto axis = [&](int i, int j) {
    return moved.q(std::vector<int>{kX, kVx, 4}[static_cast<std::size_t>(i)],
                   std::vector<int>{kX, kVx, 4}[static_cast<std::size_t>(j)]);
  };
  EXPECT_NEAR(axis(0, 0), 2.0 * std::pow(t, 5) / 20.0, 1e-12);
  EXPECT_NEAR(axis(0, 1), 2.0 * std::pow(t, 4) / 8.0, 1e-12);
  EXPECT_NEAR(axis(0, 2), 2.0 * std::pow(t, 3) / 6.0, 1e-12);
  EXPECT_NEAR(axis(1, 1), 2.0 * std::pow(t, 3) / 3.0, 1e-12);
  EXPECT_NEAR(axis(1, 2), 2.0 * std::pow(t, 2) / 2.0, 1e-12);
  EXPECT_NEAR(axis(2, 2), 2.0 * t, 1e-12);
  EXPECT_EQ(moved.f(kX, 4), 0.5 * t * t);
}

// The acceleration is stationary: sigma^2 e^-2T/tau of what was and sigma^2 (1 - e^-2T/tau) that is new.
TEST(Singer, AccelerationIsStationary) {
  for (const double t : {0.01, 1.0, 40.0}) {
    const Moved moved = move(Singer{5.0, 20.0}, t, some_state(1.0));
    EXPECT_NEAR(moved.q(4, 4), 25.0 * -std::expm1(-2.0 * t / 20.0), 1e-13);
    EXPECT_NEAR(moved.f(4, 4), std::exp(-t / 20.0), kEpsilon);
  }
}

// A quarter circle: what CoordinatedTurn makes of a known rate.
TEST(UnknownTurnRate, MeanIsTheTurnAtItsRate) {
  const FullState x = some_state(0.2);
  const State expected = transition(CoordinatedTurn{0.2}, 3.0) * State(x.head<kStateSize>());
  EXPECT_EQ(move(UnknownTurnRate{1.0, 1e-4}, 3.0, x).mean.head<kStateSize>(), expected);
}

DiscreteBank bank_of(const std::vector<Mode>& modes, const Eigen::MatrixXd& chain, double dt_s) {
  return *discretise({modes, chain, dt_s, Eigen::VectorXd::Ones(std::ssize(modes)), {}}, dt_s);
}

Mode mode_of(const TrailingMotion& motion) { return {"m", ConstantVelocity{}, NoProcessNoise{}, motion}; }

// One mode through the IMM against a Kalman filter of six states written out: 200 looks. Kept as e given x, the
// acceleration needs no update, and this is where that is proved.
TEST(UnlikeModes, OneModeIsTheKalmanFilterOfSixStates) {
  RandomStream stream(1);
  for (const NamedTrailing& row : every_linear()) {
    const DiscreteBank bank = bank_of({mode_of(row.model)}, Eigen::MatrixXd::Ones(1, 1), 1.0);
    ImmEstimate estimate =
        make_estimate({State(0, 100, 0, -50), State(1e4, 1e2, 1e4, 1e2).asDiagonal()}, Eigen::VectorXd::Ones(1));
    ImmEstimate predicted;
    FullState x = FullState::Zero();
    x.head<kStateSize>() = estimate.modes[0].mean;
    FullMatrix p = FullMatrix::Zero();
    p.topLeftCorner<kStateSize, kStateSize>() = estimate.modes[0].covariance;
    p.bottomRightCorner<2, 2>() = start_sigma(row.model).cwiseAbs2().asDiagonal();
    Eigen::Matrix<double, 2, kMostStates> h = Eigen::Matrix<double, 2, kMostStates>::Zero();
    h(0, kX) = h(1, kY) = 1.0;
    const PositionSensor sensor(400.0 * Matrix2::Identity(), 1.0, 0.0);
    std::vector<PredictedMeasurement> measurements;
    for (int k = 0; k < 200; ++k) {
      const Vector2 z(100.0 * k + 20.0 * stream.normal(), 3.0 * k * k + 20.0 * stream.normal());
      ASSERT_EQ(predict(bank, estimate, predicted), Numerics::kOk);
      std::swap(estimate, predicted);
      ASSERT_EQ(predict_measurements(sensor, UpdateForm::kEkf, estimate, measurements), Numerics::kOk);
      ASSERT_EQ(update(measurements, std::vector<Vector2>{z - measurements[0].z}, estimate), Numerics::kOk);
      const Moved moved = move(row.model, 1.0, x);
      p = moved.f * p * moved.f.transpose() + moved.q;
      const Eigen::Matrix<double, kMostStates, 2> gain =
          p * h.transpose() * (h * p * h.transpose() + 400.0 * Matrix2::Identity()).inverse();
      x = moved.mean + gain * (z - h * moved.mean);
      p = (p - gain * h * p).eval();
      const FullGaussian ours = join(estimate.modes[0], estimate.trailing[0]);
      const FullState sigma = p.diagonal().cwiseSqrt();
      ASSERT_TRUE(near(ours.mean, x, 1e-9 * (sigma + x.cwiseAbs()))) << row.name << " " << k;
      ASSERT_TRUE(near(ours.covariance, p, 1e-9 * FullMatrix(sigma * sigma.transpose()))) << row.name << " " << k;
    }
  }
}

// A mode of nearly constant velocity has no acceleration to mix in: that of the other stays what it is, mean and
// covariance, before it moves. Of one kind they mix.
TEST(UnlikeModes, WhatAModeLacksItDoesNotPull) {
  const Eigen::Matrix2d even = Eigen::Matrix2d::Constant(0.5);
  const auto mixed = [&](const Mode& other) {
    const DiscreteBank bank = bank_of({other, mode_of(ConstantAcceleration{0.0})}, even, 1.0);
    ImmEstimate estimate = make_estimate({State::Zero(), StateMatrix::Identity()}, Eigen::Vector2d(0.5, 0.5));
    estimate.trailing.resize(2);
    estimate.trailing[1].a = Vector2(20.0, -10.0);
    estimate.trailing[1].b = 2.0 * Matrix2::Identity();
    ImmEstimate predicted;
    EXPECT_EQ(predict(bank, estimate, predicted), Numerics::kOk);
    return join(predicted.modes[1], predicted.trailing[1]);
  };
  const FullGaussian alone = mixed({"cv", ConstantVelocity{}, NoProcessNoise{}, std::nullopt});
  EXPECT_TRUE(near(alone.mean.tail<2>(), Vector2(20.0, -10.0), 1e-12));
  EXPECT_TRUE(near(alone.covariance.bottomRightCorner<2, 2>(), 4.0 * Matrix2::Identity(), 1e-12));
  const FullGaussian both = mixed(mode_of(ConstantAcceleration{0.0}));
  EXPECT_TRUE(near(both.mean.tail<2>(), Vector2(10.0, -5.0), 1e-12));
  EXPECT_NEAR(both.covariance(4, 4), 0.5 * (0.0 + 4.0) + 100.0, 1e-12);
}

// Without trailing states an estimate is at the start: the acceleration's variance spreads into the velocity's.
TEST(UnlikeModes, StartsWithTheStartCovariance) {
  const DiscreteBank bank = bank_of({mode_of(Singer{3.0, 1e9})}, Eigen::MatrixXd::Ones(1, 1), 2.0);
  ImmEstimate predicted;
  ASSERT_EQ(predict(bank, make_estimate({State::Zero(), StateMatrix::Identity()}, Eigen::VectorXd::Ones(1)), predicted),
            Numerics::kOk);
  EXPECT_NEAR(predicted.modes[0].covariance(kVx, kVx), 1.0 + 4.0 * 9.0, 1e-6);
}

/// P_ee - P_ex P_xx^-1 P_xe in the scalar of the matrix.
template <class Scalar>
Eigen::Matrix<Scalar, 2, 2> conditional(const Eigen::Matrix<Scalar, kMostStates, kMostStates>& all) {
  const Eigen::Matrix<Scalar, kStateSize, kStateSize> kinematic = all.template topLeftCorner<kStateSize, kStateSize>();
  const Eigen::Matrix<Scalar, kStateSize, 2> cross = all.template topRightCorner<kStateSize, 2>();
  return all.template bottomRightCorner<2, 2>() - cross.transpose() * kinematic.llt().solve(cross);
}

// An acceleration that the velocity all but gives (to 1e-16 of its variance), of a kinematic state of pivot 1e-10: what
// is left open of it after a second, against long double. Of its root, 3e-8, rounding moves eps cond(P)^1/2 of the
// whole, 5: 3e-3 of it. The twin is the same difference in double precision.
TEST(UnlikeModes, WhatTheKinematicStateLeavesOpenStaysDefinite) {
  const DiscreteBank bank = bank_of({mode_of(ConstantAcceleration{0.0})}, Eigen::MatrixXd::Ones(1, 1), 1.0);
  const double rho = std::sqrt(1.0 - 1e-10);
  StateMatrix p = State(1e4, 100.0, 1e4, 100.0).asDiagonal();
  p(kX, kVx) = p(kVx, kX) = p(kY, kVy) = p(kVy, kY) = rho * 1e3;
  ImmEstimate estimate = make_estimate({State::Zero(), p}, Eigen::VectorXd::Ones(1));
  estimate.trailing.resize(1);
  Trailing& trailing = estimate.trailing[0];
  trailing.g(0, kVx) = trailing.g(1, kVy) = 0.5;
  trailing.b = 5e-8 * Matrix2::Identity();
  using Long = Eigen::Matrix<long double, kMostStates, kMostStates>;
  Long root = Long::Zero();
  root.topLeftCorner<kStateSize, kStateSize>() = p.cast<long double>().llt().matrixL();
  root.bottomLeftCorner<2, kStateSize>() =
      trailing.g.cast<long double>() * root.topLeftCorner<kStateSize, kStateSize>();
  root.bottomRightCorner<2, 2>() = trailing.b.cast<long double>();
  const FullMatrix f = bank.from_rest[0].f;
  root = (f.cast<long double>() * root).eval();
  const Matrix2 expected = conditional<long double>(root * root.transpose()).cast<double>();
  const FullMatrix before = join(estimate.modes[0], trailing).covariance;
  ImmEstimate predicted;
  ASSERT_EQ(predict(bank, estimate, predicted), Numerics::kOk);
  const Matrix2 ours = predicted.trailing[0].b * predicted.trailing[0].b.transpose();
  EXPECT_TRUE(near(ours, expected, 1e-2 * expected(0, 0)));
  const Matrix2 twin = conditional<double>(f * before * f.transpose());
  EXPECT_GT((twin - expected).cwiseAbs().maxCoeff(), 0.1 * expected(0, 0));
}

/// Up to six modes of motions drawn from all there are, their figures over the orders of magnitude that targets have. A
/// turn rate, at the start and by its walk over a track's 200 looks, is uncertain by half a radian over the interval at
/// most: more is not linear.
std::vector<Mode> random_modes(RandomStream& stream, double dt_s) {
  const auto between = [&](double low, double high) { return std::exp(stream.uniform(std::log(low), std::log(high))); };
  std::vector<Mode> modes;
  const auto count = 1 + stream.bits() % 6;
  while (modes.size() < count) {
    switch (stream.bits() % 5) {
      case 0:
        modes.push_back({"cv", ConstantVelocity{}, WhiteNoiseAcceleration{between(1e-3, 1e4)}, std::nullopt});
        break;
      case 1:
        modes.push_back(
            {"ct", CoordinatedTurn{stream.uniform(-1.0, 1.0)}, WhiteNoiseAcceleration{between(1e-3, 1e3)}, {}});
        break;
      case 2:
        modes.push_back(mode_of(ConstantAcceleration{between(1e-6, 1e3), between(0.1, 100.0)}));
        break;
      case 3:
        modes.push_back(mode_of(Singer{between(0.1, 100.0), between(0.1, 1e6)}));
        break;
      default:
        modes.push_back(mode_of(
            UnknownTurnRate{between(1e-3, 1e2), between(1e-8, 1e-3) / std::pow(dt_s, 3), between(1e-3, 0.2) / dt_s}));
    }
  }
  return modes;
}

// Random banks over many looks of changing quality and intervals: every covariance symmetric and positive definite, the
// trailing states' with them, probabilities summing to one.
TEST(UnlikeModes, StayPositiveDefinite) {
  RandomStream stream(5);
  DiscreteBank bank;
  int count = 0;
  ImmEstimate estimate, predicted;
  std::vector<PredictedMeasurement> measurements;
  const int cycles = soaked(1'000'000, scaled(30'000));
  for (int k = 0; k < cycles; ++k) {
    if (k % 200 == 0) {
      const double dt_s = std::pow(10.0, stream.uniform(-3.0, 1.0));
      const std::vector<Mode> modes = random_modes(stream, dt_s);
      count = static_cast<int>(modes.size());
      bank = bank_of(modes, matrices::random_chain(stream, count), dt_s);
      estimate = make_estimate(matrices::random_gaussian(stream), Eigen::VectorXd::Constant(count, 1.0 / count));
    }
    ASSERT_EQ(predict(bank, estimate, predicted), Numerics::kOk) << k;
    std::swap(estimate, predicted);
    const double predicted_m2 = 0.5 * position_block(combine(estimate).covariance).trace();
    const double r = predicted_m2 * std::pow(10.0, stream.uniform(-6.0, 6.0));
    const PositionSensor sensor(r * Matrix2::Identity(), 1.0, 0.0);
    const UpdateForm form = catalogue::every_update()[stream.bits() % catalogue::every_update().size()];
    ASSERT_EQ(predict_measurements(sensor, form, estimate, measurements), Numerics::kOk)
        << k << ", " << count << " modes at " << combined_mean(estimate).transpose();
    const std::size_t from = stream.bits() % measurements.size();
    const Vector2 z =
        measurements[from].z + measurements[from].s_root.matrixL() * Vector2(stream.normal(), stream.normal());
    std::vector<Vector2> innovations;
    for (const PredictedMeasurement& mode : measurements) innovations.push_back(z - mode.z);
    ASSERT_EQ(update(measurements, innovations, estimate), Numerics::kOk) << k;
    ASSERT_NEAR(estimate.probability.sum(), 1.0, 1e-12);
    for (std::size_t j = 0; j < measurements.size(); ++j) {
      ASSERT_EQ(estimate.modes[j].covariance, estimate.modes[j].covariance.transpose());
      ASSERT_GT(matrices::smallest_pivot(estimate.modes[j].covariance), 0.0) << k << " " << j;
      if (!bank.trailing.empty() && bank.trailing[j]) {
        ASSERT_GT(estimate.trailing[j].b(0, 0) * estimate.trailing[j].b(0, 0), 0.0) << k << " " << j;
        ASSERT_TRUE(estimate.trailing[j].g.allFinite() && estimate.trailing[j].b.allFinite()) << k << " " << j;
      }
    }
  }
}

}  // namespace
}  // namespace dwell
