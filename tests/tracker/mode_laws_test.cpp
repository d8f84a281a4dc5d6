// Laws of every mode under every update.

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <ceres/jet.h>
#include <gtest/gtest.h>
#include <Eigen/LU>
#include <Eigen/QR>

#include "tests/tracker/catalogue.hpp"
#include "tests/tracker/matrices.hpp"
#include "tests/tracker/position_sensor.hpp"
#include "tracker/measurement.hpp"

namespace dwell {
namespace {

using matrices::near;
using Jet = ceres::Jet<double, kMostStates>;
using JetState = Eigen::Matrix<Jet, kMostStates, 1>;

// --- the jacobian, against the motion's differential equation

/// The acceleration that a motion's definition gives a state, and what its trailing states do.
struct Definition {
  const JetState& x;

  void turn(const Jet& rate, JetState& slope) const {
    slope[kVx] = -rate * x[kVy];
    slope[kVy] = rate * x[kVx];
  }
  void accelerate(double decay, JetState& slope) const {
    slope[kVx] = x[kStateSize];
    slope[kVy] = x[kStateSize + 1];
    for (const int e : {kStateSize, kStateSize + 1}) slope[e] = -decay * x[e];
  }
  void operator()(const ConstantVelocity& /*motion*/, JetState& /*slope*/) const {}
  void operator()(const CoordinatedTurn& motion, JetState& slope) const { turn(Jet(motion.turn_rate_radps), slope); }
  void operator()(const ConstantAcceleration& /*motion*/, JetState& slope) const { accelerate(0.0, slope); }
  void operator()(const Singer& motion, JetState& slope) const { accelerate(1.0 / motion.time_constant_s, slope); }
  void operator()(const UnknownTurnRate& /*motion*/, JetState& slope) const { turn(x[kStateSize], slope); }
};

JetState slope_of(const Mode& mode, const JetState& x) {
  JetState slope = JetState::Constant(Jet(0.0));
  slope[kX] = x[kVx];
  slope[kY] = x[kVy];
  const auto define = [&](const auto& motion) { Definition{x}(motion, slope); };
  mode.trailing ? std::visit(define, *mode.trailing) : std::visit(define, mode.motion);
  return slope;
}

/// By Runge and Kutta's fourth-order steps: 4000 of them, an error of (3 rad / 4000)^4 / 120 = 3e-15 at the fastest
/// rates of the catalogue.
JetState flow(const Mode& mode, JetState x, double dt_s) {
  constexpr int kSteps = 4000;
  const Jet h(dt_s / kSteps);
  for (int i = 0; i < kSteps; ++i) {
    const JetState k1 = slope_of(mode, x);
    const JetState k2 = slope_of(mode, x + 0.5 * h * k1);
    const JetState k3 = slope_of(mode, x + 0.5 * h * k2);
    const JetState k4 = slope_of(mode, x + h * k3);
    x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return x;
}

class EveryMode : public testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Every, EveryMode, testing::ValuesIn(catalogue::every_mode()),
                         [](const auto& row) { return row.param.name; });

// Mean and jacobian of the closed forms are those of the flow: 1e-10 of each row's largest element.
TEST_P(EveryMode, MeanAndJacobianAreThoseOfItsDifferentialEquation) {
  const Mode& mode = GetParam();
  for (const double rate : {0.0, 1e-10, 1e-6, 9e-4, 1.1e-3, 0.05, -0.3, 2.0}) {
    FullState x;
    x << 1e3, 150.0, -2e3, 80.0, rate, mode.trailing && !is_linear(*mode.trailing) ? 0.0 : -rate;
    JetState start;
    for (int i = 0; i < kMostStates; ++i) start[i] = Jet(x[i], i);
    const JetState end = flow(mode, start, 1.3);
    Moved moved;
    if (mode.trailing) {
      moved = move(*mode.trailing, 1.3, x);
    } else {
      moved.f.topLeftCorner<kStateSize, kStateSize>() = transition(mode.motion, 1.3);
      moved.mean = moved.f * x;
    }
    for (int i = 0; i < kMostStates; ++i) {
      EXPECT_NEAR(moved.mean[i], end[i].a, 1e-10 * (1.0 + std::abs(end[i].a))) << rate << " " << i;
      EXPECT_TRUE(near(moved.f.row(i).transpose(), end[i].v, 1e-10 * (1.0 + end[i].v.cwiseAbs().maxCoeff())))
          << rate << " row " << i;
    }
  }
}

// --- the filter, against least squares

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// F, Q and the prior of a linear mode over its own states: 4, or 6 with an acceleration.
struct LinearMode {
  LongMatrix f;
  LongMatrix q;
  LongVector mean;
  LongMatrix covariance;
};

LinearMode linear(const Mode& mode, double dt_s, const Gaussian& prior) {
  if (!mode.trailing) {
    return {transition(mode.motion, dt_s).cast<long double>(),
            process_noise(mode.motion, mode.noise, dt_s).cast<long double>(), prior.mean.cast<long double>(),
            prior.covariance.cast<long double>()};
  }
  Trailing start;
  start.b = start_sigma(*mode.trailing).asDiagonal();
  const FullGaussian full = join(prior, start);
  const Moved moved = move(*mode.trailing, dt_s, full.mean);
  return {moved.f.cast<long double>(), moved.q.cast<long double>(), full.mean.cast<long double>(),
          full.covariance.cast<long double>()};
}

/// The last of all states that fit prior, motion and plots best, and its covariance: the whitened equations of every
/// state at once, by Householder QR in long double.
std::pair<LongVector, LongMatrix> least_squares(const LinearMode& mode, const Matrix2& r,
                                                const std::vector<Vector2>& plots) {
  const auto root_inverse = [](const LongMatrix& covariance) {
    const LongMatrix root = covariance.llt().matrixL();
    return LongMatrix(root.inverse());
  };
  const Eigen::Index n = mode.mean.size();
  const auto steps = static_cast<Eigen::Index>(plots.size());
  LongMatrix rows = LongMatrix::Zero(n + steps * (n + 2), n * (steps + 1));
  LongVector right = LongVector::Zero(rows.rows());
  const LongMatrix prior = root_inverse(mode.covariance);
  rows.topLeftCorner(n, n) = prior;
  right.head(n) = prior * mode.mean;
  const LongMatrix noise = root_inverse(mode.q);
  const LongMatrix plot = root_inverse(r.cast<long double>());
  for (Eigen::Index k = 0; k < steps; ++k) {
    const Eigen::Index row = n + k * (n + 2);
    rows.block(row, k * n, n, n) = -noise * mode.f;
    rows.block(row, (k + 1) * n, n, n) = noise;
    LongMatrix h = LongMatrix::Zero(2, n);
    h(0, kX) = h(1, kY) = 1.0L;
    rows.block(row + n, (k + 1) * n, 2, n) = plot * h;
    right.segment(row + n, 2) = plot * plots[static_cast<std::size_t>(k)].cast<long double>();
  }
  const Eigen::HouseholderQR<LongMatrix> qr(rows);
  const LongVector best = qr.solve(right);
  const LongMatrix upper = qr.matrixQR().topRows(rows.cols()).triangularView<Eigen::Upper>();
  const LongMatrix last = upper.bottomRightCorner(n, n).inverse();
  return {best.tail(n), last * last.transpose()};
}

std::vector<Mode> every_linear_mode() {
  std::vector<Mode> modes;
  for (const Mode& mode : catalogue::every_mode()) {
    if (!mode.trailing || is_linear(*mode.trailing)) modes.push_back(mode);
  }
  return modes;
}

class LinearModeAndUpdate : public testing::TestWithParam<std::tuple<Mode, UpdateForm>> {};
INSTANTIATE_TEST_SUITE_P(Every, LinearModeAndUpdate,
                         testing::Combine(testing::ValuesIn(every_linear_mode()),
                                          testing::ValuesIn(catalogue::every_update())),
                         [](const auto& row) {
                           return std::get<0>(row.param).name + "_" + catalogue::name_of(std::get<1>(row.param));
                         });

// Fifteen plots of the position. The filter rounds to some hundred eps of the prior's variance, 1e4 of the last one's
// at most: 1e-9 of the last.
TEST_P(LinearModeAndUpdate, FilterEqualsBatchLeastSquares) {
  const auto& [mode, form] = GetParam();
  const Gaussian prior{{1000.0, 50.0, -2000.0, 80.0}, State(9e4, 900.0, 9e4, 900.0).asDiagonal()};
  const PositionSensor sensor((Matrix2() << 100.0, 60.0, 60.0, 400.0).finished(), 1.0, 0.0);
  const DiscreteBank bank = *discretise({{mode}, Eigen::MatrixXd::Ones(1, 1), 1.0, Eigen::VectorXd::Ones(1)}, 1.0);
  ImmEstimate estimate = make_estimate(prior, Eigen::VectorXd::Ones(1));
  ImmEstimate predicted;
  std::vector<PredictedMeasurement> measurements;
  std::vector<Vector2> plots;
  RandomStream stream(8);
  for (int k = 1; k <= 15; ++k) {
    plots.push_back(Vector2(1000.0 + 50.0 * k, -2000.0 + 80.0 * k) +
                    Vector2(10.0 * stream.normal(), 20.0 * stream.normal()));
    ASSERT_EQ(predict(bank, estimate, predicted), Numerics::kOk);
    std::swap(estimate, predicted);
    ASSERT_EQ(predict_measurements(sensor, form, estimate, measurements), Numerics::kOk);
    const Vector2 nu = innovation(sensor, form, measurement_of(sensor, form, plots.back()), measurements[0].z);
    ASSERT_EQ(update(measurements, std::vector<Vector2>{nu}, estimate), Numerics::kOk);
  }
  const auto [mean, covariance] = least_squares(linear(mode, 1.0, prior), sensor.noise({}), plots);
  FullGaussian ours = join(estimate.modes[0], mode.trailing ? estimate.trailing[0] : Trailing{});
  const Eigen::Index n = mean.size();
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt().cast<double>();
  EXPECT_TRUE(near(ours.mean.head(n), mean.cast<double>(), Eigen::VectorXd(1e-9 * sigma)));
  EXPECT_TRUE(near(ours.covariance.topLeftCorner(n, n), covariance.cast<double>(),
                   Eigen::MatrixXd(1e-9 * sigma * sigma.transpose())));
}

}  // namespace
}  // namespace dwell
