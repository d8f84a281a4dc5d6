#include "tracker/imm.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/scale.hpp"
#include "tests/tracker/matrices.hpp"

namespace dwell {
namespace {

using matrices::kEpsilon;
using matrices::near;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ImmEstimate random_estimate(RandomStream& stream, int modes) {
  ImmEstimate estimate;
  for (int j = 0; j < modes; ++j) estimate.modes.push_back(matrices::random_gaussian(stream));
  estimate.probability = matrices::random_probability(stream, modes);
  return estimate;
}

/// F of a random turn and Q of full rank in every mode.
DiscreteBank random_bank(RandomStream& stream, int modes) {
  DiscreteBank bank;
  for (int j = 0; j < modes; ++j) {
    bank.f.push_back(transition(CoordinatedTurn{stream.uniform(-0.3, 0.3)}, 1.0));
    bank.q.push_back(matrices::random_covariance(stream, {3.0, 1.0, 3.0, 1.0}));
  }
  bank.transition = matrices::random_chain(stream, modes);
  return bank;
}

/// Modes that neither move nor spread: what is left of a prediction is the mixing.
DiscreteBank standing_bank(const Eigen::MatrixXd& chain) {
  const auto modes = static_cast<std::size_t>(chain.rows());
  return {std::vector<StateMatrix>(modes, StateMatrix::Identity()),
          std::vector<StateMatrix>(modes, StateMatrix::Zero()), chain};
}

/// The position, with the same noise in every mode.
std::vector<PredictedMeasurement> measure_position(const ImmEstimate& estimate, const Matrix2& r) {
  std::vector<PredictedMeasurement> predicted(estimate.modes.size());
  for (std::size_t j = 0; j < predicted.size(); ++j) {
    predicted[j].z = position(estimate.modes[j].mean);
    predicted[j].h = position_selector();
    predicted[j].r = r;
    EXPECT_EQ(factorise(estimate.modes[j].covariance, predicted[j]), Numerics::kOk);
  }
  return predicted;
}

Numerics update_with_position(ImmEstimate& estimate, const Matrix2& r, const Vector2& z) {
  const auto predicted = measure_position(estimate, r);
  std::vector<Vector2> innovations;
  for (const PredictedMeasurement& mode : predicted) innovations.push_back(z - mode.z);
  return update(predicted, innovations, estimate);
}

/// The textbook's Kalman filter of one axis, position and velocity, in scalars: nothing shared with the code
/// tested.
struct ScalarKalmanFilter {
  double x, v, pxx, pxv, pvv;

  void predict(double t, double q) {
    x += t * v;
    pxx += t * (2.0 * pxv + t * pvv) + q * t * t * t / 3.0;
    pxv += t * pvv + q * t * t / 2.0;
    pvv += q * t;
  }
  void update(double z, double r) {
    const double nu = z - x;
    const double s = pxx + r;
    const double kx = pxx / s;
    const double kv = pxv / s;
    x += kx * nu;
    v += kv * nu;
    pvv -= kv * pxv;
    pxv *= r / s;
    pxx *= r / s;
  }
};

// Over a long run of looks of changing quality. The filter forgets its rounding as it forgets its data, so
// that the difference stays at some hundred eps and does not grow with the number of steps.
TEST(Imm, SingleModeEqualsKalmanFilter) {
  RandomStream stream(1);
  const double q = 2.0;
  DiscreteBank bank{
      {transition(ConstantVelocity{}, 1.0)}, {white_noise(ConstantVelocity{}, q, 1.0)}, Eigen::MatrixXd::Ones(1, 1)};
  ImmEstimate estimate =
      make_estimate({{5e3, 50.0, -8e3, 70.0}, State(1e4, 1e2, 1e4, 1e2).asDiagonal()}, Eigen::VectorXd::Ones(1));
  ScalarKalmanFilter axes[2] = {{5e3, 50.0, 1e4, 0.0, 1e2}, {-8e3, 70.0, 1e4, 0.0, 1e2}};
  ImmEstimate predicted;
  for (int k = 0; k < scaled(20000); ++k) {
    ASSERT_EQ(predict(bank, estimate, predicted), Numerics::kOk);
    std::swap(estimate, predicted);
    const double r = std::pow(10.0, stream.uniform(0.0, 4.0));
    const Vector2 truth = 1e3 * Vector2(std::sin(0.01 * k), std::cos(0.01 * k));
    const Vector2 z = truth + std::sqrt(r) * Vector2(stream.normal(), stream.normal());
    ASSERT_EQ(update_with_position(estimate, r * Matrix2::Identity(), z), Numerics::kOk);
    for (int axis = 0; axis < 2; ++axis) {
      axes[axis].predict(1.0, q);
      axes[axis].update(z[axis], r);
    }
    const auto& [x, y] = axes;
    const State mean(x.x, x.v, y.x, y.v);
    StateMatrix covariance;
    covariance << x.pxx, x.pxv, 0, 0, x.pxv, x.pvv, 0, 0, 0, 0, y.pxx, y.pxv, 0, 0, y.pxv, y.pvv;
    const Gaussian& mode = estimate.modes[0];
    const State size = mean.cwiseAbs() + covariance.diagonal().cwiseSqrt();
    ASSERT_TRUE(near(mode.mean, mean, 1e-12 * size)) << "step " << k;
    ASSERT_TRUE(near(mode.covariance, covariance, 1e-12 * covariance.cwiseAbs())) << "step " << k;
    ASSERT_EQ(estimate.probability[0], 1.0);
  }
}

TEST(Imm, IdenticalModesEqualOneFilter) {
  RandomStream stream(2);
  const DiscreteBank one = random_bank(stream, 1);
  const DiscreteBank three{{3, one.f[0]}, {3, one.q[0]}, matrices::random_chain(stream, 3)};
  const Gaussian start = matrices::random_gaussian(stream);
  ImmEstimate single = make_estimate(start, Eigen::VectorXd::Ones(1));
  ImmEstimate triple = make_estimate(start, Eigen::Vector3d(0.2, 0.3, 0.5));
  ImmEstimate scratch;
  for (int k = 0; k < 200; ++k) {
    ASSERT_EQ(predict(one, single, scratch), Numerics::kOk);
    std::swap(single, scratch);
    ASSERT_EQ(predict(three, triple, scratch), Numerics::kOk);
    std::swap(triple, scratch);
    const Vector2 z = position(single.modes[0].mean) + 100.0 * Vector2(stream.normal(), stream.normal());
    ASSERT_EQ(update_with_position(single, 1e4 * Matrix2::Identity(), z), Numerics::kOk);
    ASSERT_EQ(update_with_position(triple, 1e4 * Matrix2::Identity(), z), Numerics::kOk);
    const Gaussian& expected = single.modes[0];
    const State size = expected.mean.cwiseAbs() + expected.covariance.diagonal().cwiseSqrt();
    // Three weights of three equal terms each step; forgotten as in the single filter.
    for (const Gaussian& mode : triple.modes) {
      ASSERT_TRUE(near(mode.mean, expected.mean, 1e-12 * size));
      ASSERT_TRUE(near(mode.covariance, expected.covariance, 1e-12 * matrices::scale_of(expected.covariance)));
    }
  }
  // Likelihoods that are all the same say nothing: the probabilities are the chain's stationary ones.
  EXPECT_TRUE(near(three.transition.transpose() * triple.probability, triple.probability, 1e-12));
}

/// Sizes of the second moments about zero: what rounding is relative to.
StateMatrix moment_size(const ImmEstimate& estimate) {
  State square = State::Zero();
  for (const Gaussian& mode : estimate.modes) square += mode.mean.cwiseAbs2() + mode.covariance.diagonal();
  return square.cwiseSqrt() * square.cwiseSqrt().transpose();
}

TEST(Predict, MixingKeepsTotalProbabilityMeanAndSecondMoment) {
  RandomStream stream(3);
  for (int i = 0; i < 500; ++i) {
    const int modes = 1 + i % 6;
    const ImmEstimate before = random_estimate(stream, modes);
    ImmEstimate after;
    ASSERT_EQ(predict(standing_bank(matrices::random_chain(stream, modes)), before, after), Numerics::kOk);
    // Sums of at most 6 x 6 products.
    const double rounding = 36.0 * kEpsilon;
    const StateMatrix size = moment_size(before);
    EXPECT_NEAR(after.probability.sum(), 1.0, rounding);
    EXPECT_TRUE(near(combine(after).mean, combine(before).mean, rounding * size.diagonal().cwiseSqrt()));
    EXPECT_TRUE(near(combine(after).covariance, combine(before).covariance, rounding * size));
  }
}

TEST(Predict, IdentityChainDoesNotMix) {
  RandomStream stream(4);
  const ImmEstimate before = random_estimate(stream, 3);
  ImmEstimate after;
  ASSERT_EQ(predict(standing_bank(Eigen::MatrixXd::Identity(3, 3)), before, after), Numerics::kOk);
  EXPECT_EQ(after.probability, before.probability);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_EQ(after.modes[j].mean, before.modes[j].mean);
    EXPECT_EQ(after.modes[j].covariance, before.modes[j].covariance);
  }
}

TEST(Predict, CovariancesAreExactlySymmetric) {
  RandomStream stream(5);
  for (int i = 0; i < 100; ++i) {
    ImmEstimate after;
    ASSERT_EQ(predict(random_bank(stream, 3), random_estimate(stream, 3), after), Numerics::kOk);
    for (const Gaussian& mode : after.modes) EXPECT_EQ(mode.covariance, mode.covariance.transpose());
    const StateMatrix total = combine(after).covariance;
    EXPECT_EQ(total, total.transpose());
  }
}

/// One history of modes: its probability and the Gaussian it leads to.
struct History {
  int mode;
  double probability;
  Gaussian belief;
};

/// Every history one step longer, by each mode.
std::vector<History> extend(const std::vector<History>& histories, const DiscreteBank& bank) {
  std::vector<History> longer;
  for (const History& history : histories) {
    for (int j = 0; j < bank.size(); ++j) {
      const StateMatrix& f = bank.f[j];
      longer.push_back({j,
                        history.probability * bank.transition(history.mode, j),
                        {f * history.belief.mean, f * history.belief.covariance * f.transpose() + bank.q[j]}});
    }
  }
  return longer;
}

Gaussian total(const std::vector<History>& histories) {
  Gaussian sum;
  for (const History& h : histories) sum.mean += h.probability * h.belief.mean;
  for (const History& h : histories) {
    const State spread = h.belief.mean - sum.mean;
    sum.covariance += h.probability * (h.belief.covariance + spread * spread.transpose());
  }
  return sum;
}

// The exact belief is the Gaussian mixture of all histories. Without measurements the IMM keeps the first two
// moments of each mode's share of it exactly, however much it merges.
TEST(Imm, PredictionHasTheMomentsOfAllHistories) {
  RandomStream stream(6);
  for (int i = 0; i < 100; ++i) {
    const DiscreteBank bank = random_bank(stream, 2);
    ImmEstimate estimate = random_estimate(stream, 2);
    std::vector<History> histories{{0, estimate.probability[0], estimate.modes[0]},
                                   {1, estimate.probability[1], estimate.modes[1]}};
    ImmEstimate predicted;
    for (int step = 0; step < 2; ++step) {
      histories = extend(histories, bank);
      ASSERT_EQ(predict(bank, estimate, predicted), Numerics::kOk);
      std::swap(estimate, predicted);
    }
    ASSERT_EQ(histories.size(), 8u);  // four histories of each of the two modes at the start
    const Gaussian expected = total(histories);
    const StateMatrix size = moment_size(estimate);
    EXPECT_TRUE(near(combine(estimate).mean, expected.mean, 64.0 * kEpsilon * size.diagonal().cwiseSqrt()));
    EXPECT_TRUE(near(combine(estimate).covariance, expected.covariance, 64.0 * kEpsilon * size));
  }
}

// From one Gaussian shared by the modes, one step and one measurement: two histories, which the IMM does not
// merge, so that it is Bayes' rule itself. Densities by inverse and determinant.
TEST(Imm, FirstUpdateIsBayesRule) {
  RandomStream stream(7);
  for (int i = 0; i < 100; ++i) {
    const DiscreteBank bank = random_bank(stream, 2);
    const Gaussian start = matrices::random_gaussian(stream);
    const Eigen::VectorXd probability = matrices::random_probability(stream, 2);
    const Matrix2 r = (Matrix2() << 2e4, 5e3, 5e3, 1e4).finished();
    const Vector2 z = position(start.mean + velocity(start.mean)[0] * State::UnitX()) + Vector2(50.0, -80.0);

    auto histories = extend({{0, probability[0], start}, {1, probability[1], start}}, bank);
    for (History& h : histories) {
      const Eigen::Matrix<double, 2, 4> selector = position_selector();
      const Matrix2 s = selector * h.belief.covariance * selector.transpose() + r;
      const Vector2 nu = z - position(h.belief.mean);
      const Gain k = h.belief.covariance * selector.transpose() * s.inverse();
      h.probability *= std::exp(-0.5 * nu.dot(s.inverse() * nu)) / std::sqrt(s.determinant());
      h.belief = {h.belief.mean + k * nu, h.belief.covariance - k * s * k.transpose()};
    }
    double evidence = 0.0;
    for (const History& h : histories) evidence += h.probability;
    for (History& h : histories) h.probability /= evidence;
    double second_mode = 0.0;
    for (const History& h : histories) second_mode += h.mode == 1 ? h.probability : 0.0;

    ImmEstimate estimate;
    ASSERT_EQ(predict(bank, make_estimate(start, probability), estimate), Numerics::kOk);
    ASSERT_EQ(update_with_position(estimate, r, z), Numerics::kOk);
    // Exponents of up to a few hundred lose as many eps, S of moderate condition some tens: 1e-11 of each
    // size.
    EXPECT_NEAR(estimate.probability[1], second_mode, 1e-11);
    const Gaussian expected = total(histories);
    const StateMatrix size = moment_size(estimate);
    EXPECT_TRUE(near(combine(estimate).mean, expected.mean, 1e-11 * size.diagonal().cwiseSqrt()));
    EXPECT_TRUE(near(combine(estimate).covariance, expected.covariance, 1e-11 * size));
  }
}

TEST(Imm, ProbabilitiesSumToOneOverALongRun) {
  RandomStream stream(8);
  const DiscreteBank bank = random_bank(stream, 4);
  ImmEstimate estimate = random_estimate(stream, 4);
  ImmEstimate scratch;
  for (int k = 0; k < scaled(10000); ++k) {
    ASSERT_EQ(predict(bank, estimate, scratch), Numerics::kOk);
    std::swap(estimate, scratch);
    ASSERT_NEAR(estimate.probability.sum(), 1.0, 8.0 * kEpsilon);
    const Vector2 z = position(combine(estimate).mean) + 30.0 * Vector2(stream.normal(), stream.normal());
    ASSERT_EQ(update_with_position(estimate, 400.0 * Matrix2::Identity(), z), Numerics::kOk);
    ASSERT_NEAR(estimate.probability.sum(), 1.0, 8.0 * kEpsilon);
    ASSERT_GE(estimate.probability.minCoeff(), 0.0);
  }
}

// Nothing leads to the second mode: it goes on by itself, finite, and weighs nothing.
TEST(Imm, UnreachableModeWeighsNothing) {
  RandomStream stream(9);
  DiscreteBank bank = random_bank(stream, 2);
  bank.transition << 1.0, 0.0, 1.0, 0.0;
  const ImmEstimate before = random_estimate(stream, 2);
  ImmEstimate estimate;
  ASSERT_EQ(predict(bank, before, estimate), Numerics::kOk);
  EXPECT_EQ(estimate.probability, Eigen::Vector2d(1.0, 0.0));
  const State own = bank.f[1] * before.modes[1].mean;
  EXPECT_TRUE(near(estimate.modes[1].mean, own, 4.0 * kEpsilon * own.norm()));
  ASSERT_EQ(update_with_position(estimate, 100.0 * Matrix2::Identity(), position(estimate.modes[1].mean)),
            Numerics::kOk);
  EXPECT_EQ(estimate.probability, Eigen::Vector2d(1.0, 0.0));
  EXPECT_EQ(combine(estimate).mean, estimate.modes[0].mean);
  EXPECT_TRUE(combine(estimate).covariance.allFinite());
}

// With guards the chain is that of the estimate's modes, each at its own Gaussian.
TEST(Imm, GuardsMakeTheChainOfThePrediction) {
  RandomStream stream(10);
  DiscreteBank bank = random_bank(stream, 2);
  const ImmEstimate before = random_estimate(stream, 2);
  const Eigen::RowVector4d on_vx(0.0, 1.0, 0.0, 0.0);
  const double at = before.modes[0].mean[kVx] + 10.0;
  bank.guards.push_back({0, 1, on_vx, Eigen::VectorXd::Constant(1, -at), Eigen::MatrixXd::Zero(1, 1)});
  DiscreteBank unguarded{bank.f, bank.q, transition_at(bank, before.modes), {}};
  EXPECT_NE(unguarded.transition, bank.transition);
  ImmEstimate guarded, expected;
  ASSERT_EQ(predict(bank, before, guarded), Numerics::kOk);
  ASSERT_EQ(predict(unguarded, before, expected), Numerics::kOk);
  EXPECT_EQ(guarded.probability, expected.probability);
  for (std::size_t j = 0; j < 2; ++j) EXPECT_EQ(guarded.modes[j].mean, expected.modes[j].mean);
  ImmEstimate broken = before;
  broken.modes[0].covariance(kVx, kVx) = kNan;
  EXPECT_EQ(predict(bank, broken, guarded), Numerics::kNotFinite);
}

// Two modes d apart, S = 2 I: a plot on the first has a likelihood exp(d^2 / 4) times the second's. At d =
// 2000 that is e to the 1e6, far beyond every double.
TEST(Update, LikelihoodsMayDifferByAnyRatio) {
  const double d = 2000.0;
  ImmEstimate estimate = make_estimate({State::Zero(), StateMatrix::Identity()}, Eigen::Vector2d(0.5, 0.5));
  estimate.modes[1].mean = make_state({d, 0.0}, {0.0, 0.0});
  ASSERT_EQ(update_with_position(estimate, Matrix2::Identity(), {0.0, 0.0}), Numerics::kOk);
  EXPECT_EQ(estimate.probability, Eigen::Vector2d(1.0, 0.0));
  EXPECT_TRUE(combine(estimate).covariance.allFinite());
}

// Both are impossible, one by exp(-1e6) more: only the ratio counts.
TEST(Update, LikelihoodsMayAllUnderflow) {
  ImmEstimate estimate = make_estimate({State::Zero(), StateMatrix::Identity()}, Eigen::Vector2d(0.5, 0.5));
  estimate.modes[1].mean = make_state({1e-4, 0.0}, {0.0, 0.0});
  // Squared distances (1e4)^2 / 2 and (1e4 - 1e-4)^2 / 2 differ by 1 - 5e-9: the log ratio is 0.5.
  ASSERT_EQ(update_with_position(estimate, Matrix2::Identity(), {1e4, 0.0}), Numerics::kOk);
  // An eps of the exponents, 2.5e7, is 6e-9.
  EXPECT_NEAR(estimate.probability[1], 1.0 / (1.0 + std::exp(-0.5)), 1e-8);
  EXPECT_TRUE(combine(estimate).mean.allFinite());
}

void expect_same(const ImmEstimate& actual, const ImmEstimate& expected) {
  EXPECT_EQ(actual.probability, expected.probability);
  for (std::size_t j = 0; j < expected.modes.size(); ++j) {
    EXPECT_EQ(actual.modes[j].mean, expected.modes[j].mean);
    EXPECT_EQ(actual.modes[j].covariance, expected.modes[j].covariance);
  }
}

TEST(Update, InnovationThatIsNotFiniteLeavesTheEstimateAlone) {
  RandomStream stream(10);
  const ImmEstimate before = random_estimate(stream, 3);
  const auto predicted = measure_position(before, 100.0 * Matrix2::Identity());
  for (const double bad : {kNan, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    for (std::size_t where = 0; where < 3; ++where) {
      for (int component = 0; component < 2; ++component) {
        ImmEstimate estimate = before;
        std::vector<Vector2> innovations(3, Vector2(10.0, 10.0));
        innovations[where][component] = bad;
        EXPECT_EQ(update(predicted, innovations, estimate), Numerics::kNotFinite) << bad << " in mode " << where;
        expect_same(estimate, before);
      }
    }
  }
}

// (1e200)^2 overflows: no mode has a finite likelihood.
TEST(Update, DistancesBeyondAllNumbersLeaveTheEstimateAlone) {
  RandomStream stream(11);
  const ImmEstimate before = random_estimate(stream, 2);
  const auto predicted = measure_position(before, Matrix2::Identity());
  ImmEstimate estimate = before;
  EXPECT_EQ(update(predicted, std::vector<Vector2>(2, Vector2(1e200, 0.0)), estimate), Numerics::kNotFinite);
  expect_same(estimate, before);
}

TEST(Predict, NotANumberIsReported) {
  RandomStream stream(12);
  const DiscreteBank bank = random_bank(stream, 2);
  ImmEstimate after;
  ImmEstimate bad_mean = random_estimate(stream, 2);
  bad_mean.modes[1].mean[kVx] = kNan;
  EXPECT_EQ(predict(bank, bad_mean, after), Numerics::kNotFinite);
  ImmEstimate bad_covariance = random_estimate(stream, 2);
  bad_covariance.modes[0].covariance(kX, kY) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(predict(bank, bad_covariance, after), Numerics::kNotFinite);
  ImmEstimate bad_probability = random_estimate(stream, 2);
  bad_probability.probability[0] = kNan;
  EXPECT_EQ(predict(bank, bad_probability, after), Numerics::kNotFinite);
}

// Means 0 and 4 with weights 3/4 and 1/4, variances 1 and 5: mean 1, variance 3/4 (1 + 1) + 1/4 (5 + 9) = 5.
TEST(Combine, AddsTheSpreadOfMeans) {
  ImmEstimate estimate = make_estimate({State::Zero(), StateMatrix::Identity()}, Eigen::Vector2d(0.75, 0.25));
  estimate.modes[1] = {State::Constant(4.0), 5.0 * StateMatrix::Identity()};
  const Gaussian combined = combine(estimate);
  EXPECT_EQ(combined.mean, State::Ones());
  EXPECT_EQ(combined.covariance, StateMatrix(2.0 * StateMatrix::Identity() + 3.0 * StateMatrix::Ones()));
  EXPECT_EQ(combined_mean(estimate), State::Ones());
}

}  // namespace
}  // namespace dwell
