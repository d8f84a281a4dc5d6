#include "tracker/kalman.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

#include "tests/tracker/matrices.hpp"
#include "tracker/motion.hpp"

namespace dwell {
namespace {

using matrices::kEpsilon;
using matrices::near;

// References are computed in 64-bit mantissas, so that what they differ by is the rounding of the tested
// code.
using Long = long double;
template <int Rows, int Columns>
using LongMatrix = Eigen::Matrix<Long, Rows, Columns>;

constexpr int kCases = 500;

/// A Gaussian, and a measurement of it that is anywhere between 1e-4 and 1e4 of its variance.
struct Case {
  Gaussian prior;
  PredictedMeasurement predicted;
  Vector2 nu;
};

PredictedMeasurement random_measurement(RandomStream& stream, const StateMatrix& covariance) {
  PredictedMeasurement predicted;
  for (int j = 0; j < kStateSize; ++j) {
    for (int i = 0; i < 2; ++i) predicted.h(i, j) = stream.normal();
  }
  const double sigma = 300.0 * std::pow(10.0, stream.uniform(-2.0, 2.0));
  const Vector2 a(stream.normal(), stream.normal());
  predicted.r = sigma * sigma * (Matrix2::Identity() + a * a.transpose());
  EXPECT_EQ(factorise(covariance, predicted), Numerics::kOk);
  return predicted;
}

Case random_case(RandomStream& stream) {
  Case c;
  c.prior = matrices::random_gaussian(stream);
  c.predicted = random_measurement(stream, c.prior.covariance);
  c.nu = c.predicted.s_root.matrixL() * Vector2(stream.normal(), stream.normal());
  return c;
}

/// By the pivoted Cholesky factor; the closed form by cofactors, which Eigen takes for small matrices, loses
/// digits.
template <int Size>
LongMatrix<Size, Size> inverse(const LongMatrix<Size, Size>& m) {
  return m.ldlt().solve(LongMatrix<Size, Size>::Identity());
}

Long condition(const Matrix2& s) {
  const Vector2 values = s.selfadjointView<Eigen::Lower>().eigenvalues();
  return values.maxCoeff() / values.minCoeff();
}

TEST(Factorise, GivesTheInnovationCovariance) {
  RandomStream stream(1);
  for (int i = 0; i < kCases; ++i) {
    const auto [prior, predicted, nu] = random_case(stream);
    const Matrix2 expected = predicted.h * prior.covariance * predicted.h.transpose() + predicted.r;
    EXPECT_TRUE(near(predicted.s, expected, 0.0));
    const Matrix2 product = predicted.s_root.matrixL() * Matrix2(predicted.s_root.matrixL()).transpose();
    EXPECT_TRUE(near(product, expected, 4.0 * kEpsilon * expected.trace()));
  }
}

TEST(Factorise, ReportsWhatIsNotPositiveDefinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto code = [](const Matrix2& s) {
    PredictedMeasurement predicted;
    predicted.r = s;
    return factorise(StateMatrix::Zero(), predicted);
  };
  EXPECT_EQ(code(Matrix2::Identity()), Numerics::kOk);
  EXPECT_EQ(code(Matrix2::Zero()), Numerics::kNotPositiveDefinite);
  EXPECT_EQ(code(-Matrix2::Identity()), Numerics::kNotPositiveDefinite);
  EXPECT_EQ(code(Vector2(1.0, 0.0).asDiagonal()), Numerics::kNotPositiveDefinite);
  EXPECT_EQ(code((Matrix2() << 1.0, 2.0, 2.0, 1.0).finished()), Numerics::kNotPositiveDefinite);
  for (const double bad : {nan, infinity, -infinity}) {
    EXPECT_EQ(code(Vector2(bad, 1.0).asDiagonal()), Numerics::kNotPositiveDefinite) << bad;
    EXPECT_EQ(code(Vector2(1.0, bad).asDiagonal()), Numerics::kNotPositiveDefinite) << bad;
    EXPECT_EQ(code((Matrix2() << 1.0, bad, bad, 1.0).finished()), Numerics::kNotPositiveDefinite) << bad;
  }
}

// A position seen as finely as it was known: half the gain, half the variance, whatever the velocity is.
TEST(KalmanUpdate, EqualVariancesMeetHalfWay) {
  PredictedMeasurement predicted;
  predicted.h = position_selector();
  predicted.r = Vector2(4.0, 100.0).asDiagonal();
  const Gaussian prior{{10.0, 1.0, 20.0, 2.0}, State(4.0, 9.0, 100.0, 16.0).asDiagonal()};
  ASSERT_EQ(factorise(prior.covariance, predicted), Numerics::kOk);
  const Gaussian posterior = kalman_update(prior, predicted, {2.0, -6.0});
  EXPECT_EQ(posterior.mean, State(11.0, 1.0, 17.0, 2.0));
  EXPECT_EQ(posterior.covariance, StateMatrix(State(2.0, 9.0, 50.0, 16.0).asDiagonal()));
}

// Solving with a Cholesky factor loses cond(S); 16 eps for the products.
TEST(KalmanGain, EqualsTheExplicitInverse) {
  RandomStream stream(2);
  for (int i = 0; i < kCases; ++i) {
    const auto [prior, predicted, nu] = random_case(stream);
    const LongMatrix<4, 2> ph = prior.covariance.cast<Long>() * predicted.h.cast<Long>().transpose();
    const LongMatrix<2, 2> s = predicted.h.cast<Long>() * ph + predicted.r.cast<Long>();
    const Gain expected = (ph * s.inverse()).cast<double>();
    const double loss = 16.0 * kEpsilon * static_cast<double>(condition(predicted.s));
    const Gain tolerance = (loss * expected.rowwise().norm()) * Eigen::RowVector2d::Ones();
    EXPECT_TRUE(near(kalman_gain(prior.covariance, predicted), expected, tolerance));
  }
}

// (P^-1 + H' R^-1 H)^-1. Joseph's form has no first-order error in K: what remains is the rounding of I - K
// H, an eps of A = I + |K| |H|, carried through the products: 16 eps of (A |P| A' + |K| |R| |K|')_ij.
TEST(UpdatedCovariance, EqualsTheInformationForm) {
  RandomStream stream(3);
  for (int i = 0; i < kCases; ++i) {
    const auto [prior, predicted, nu] = random_case(stream);
    const LongMatrix<2, 4> h = predicted.h.cast<Long>();
    const LongMatrix<4, 4> information = inverse(LongMatrix<4, 4>(prior.covariance.cast<Long>())) +
                                         h.transpose() * inverse(LongMatrix<2, 2>(predicted.r.cast<Long>())) * h;
    const StateMatrix expected = inverse(information).cast<double>();
    const Gain k = kalman_gain(prior.covariance, predicted);
    const StateMatrix a = StateMatrix::Identity() + k.cwiseAbs() * predicted.h.cwiseAbs();
    const StateMatrix size = a * prior.covariance.cwiseAbs() * a.transpose() +
                             k.cwiseAbs() * predicted.r.cwiseAbs() * k.cwiseAbs().transpose();
    EXPECT_TRUE(near(updated_covariance(prior.covariance, predicted, k), expected, 16.0 * kEpsilon * size));
  }
}

TEST(UpdatedCovariance, IsExactlySymmetric) {
  RandomStream stream(4);
  for (int i = 0; i < kCases; ++i) {
    const auto [prior, predicted, nu] = random_case(stream);
    const StateMatrix covariance = kalman_update(prior, predicted, nu).covariance;
    EXPECT_EQ(covariance, covariance.transpose());
  }
}

// Joseph's form holds for any gain: with K (1 + d) the covariance grows by d^2 K S K', while the short form
// (I - K H) P would change by -d K S K', and in the wrong direction for d > 0.
TEST(UpdatedCovariance, WrongGainCostsToSecondOrder) {
  RandomStream stream(5);
  const double off = 0.01;
  for (int i = 0; i < kCases; ++i) {
    const auto [prior, predicted, nu] = random_case(stream);
    const Gain k = kalman_gain(prior.covariance, predicted);
    const StateMatrix best = updated_covariance(prior.covariance, predicted, k);
    const StateMatrix worse = updated_covariance(prior.covariance, predicted, (1.0 + off) * k);
    const StateMatrix expected = off * off * (k * predicted.s * k.transpose());
    // Rounding of two covariances of the prior's size or less.
    EXPECT_TRUE(near(worse - best, expected, 64.0 * kEpsilon * matrices::scale_of(prior.covariance)));
  }
}

// log of exp(-nu' S^-1 nu / 2) / (2 pi sqrt |S|), with the inverse and the determinant written out.
TEST(LogLikelihood, EqualsTheClosedForm) {
  RandomStream stream(6);
  for (int i = 0; i < kCases; ++i) {
    const auto [prior, predicted, nu] = random_case(stream);
    const LongMatrix<2, 2> s = predicted.s.cast<Long>();
    const Long determinant = s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0);
    const Long n0 = nu[0];
    const Long n1 = nu[1];
    const Long d2 = (s(1, 1) * n0 * n0 - 2.0L * s(0, 1) * n0 * n1 + s(0, 0) * n1 * n1) / determinant;
    const auto expected =
        static_cast<double>(-0.5L * d2 - std::log(2.0L * std::numbers::pi_v<Long>) - 0.5L * std::log(determinant));
    // The factor of S is good to an eps of S, its inverse to cond(S) eps, the determinant likewise.
    const double loss = 8.0 * kEpsilon * static_cast<double>(condition(predicted.s));
    EXPECT_NEAR(predicted.log_likelihood(nu), expected, loss * (1.0 + static_cast<double>(d2)) + 64.0 * kEpsilon);
    EXPECT_NEAR(predicted.squared_distance(nu), static_cast<double>(d2), loss * static_cast<double>(d2));
    EXPECT_NEAR(predicted.log_determinant(), static_cast<double>(std::log(determinant)), loss + 64.0 * kEpsilon);
  }
}

// N(0; 0, I) = 1 / (2 pi); three sigma along one axis takes 9 / 2 off the log.
TEST(LogLikelihood, StandardNormalByHand) {
  PredictedMeasurement predicted;
  predicted.r = Matrix2::Identity();
  ASSERT_EQ(factorise(StateMatrix::Zero(), predicted), Numerics::kOk);
  EXPECT_DOUBLE_EQ(predicted.log_likelihood({0.0, 0.0}), -std::log(2.0 * std::numbers::pi));
  EXPECT_DOUBLE_EQ(predicted.log_likelihood({0.0, 3.0}), -std::log(2.0 * std::numbers::pi) - 4.5);
}

/// The update with an absolute measurement z = H x + v of the same H and R; `lost` grows by eps cond(S), what
/// solving with the factor of S may lose of a correction of one sigma, times the sigmas of the innovation.
Gaussian update_with(const Gaussian& prior, const PredictedMeasurement& like, const Vector2& z, double& lost) {
  PredictedMeasurement measurement;
  measurement.h = like.h;
  measurement.r = like.r;
  EXPECT_EQ(factorise(prior.covariance, measurement), Numerics::kOk);
  const Vector2 innovation = z - measurement.h * prior.mean;
  const double sigmas = std::max(1.0, std::sqrt(measurement.squared_distance(innovation)));
  lost += kEpsilon * static_cast<double>(condition(measurement.s)) * sigmas;
  return kalman_update(prior, measurement, innovation);
}

// Both orders are the same conditional. The four updates may lose eps cond(S) each of what they compute with,
// a few times over for the products.
TEST(KalmanUpdate, OrderOfIndependentMeasurementsDoesNotMatter) {
  RandomStream stream(7);
  for (int i = 0; i < kCases; ++i) {
    Gaussian prior = matrices::random_gaussian(stream);
    prior.mean *= 0.01;  // about one sigma, so that its own rounding counts for no more than the covariance's
    const PredictedMeasurement first = random_measurement(stream, prior.covariance);
    const PredictedMeasurement second = random_measurement(stream, prior.covariance);
    const Vector2 z1 = first.h * prior.mean + Vector2(first.s_root.matrixL() * Vector2(1.0, -0.5));
    const Vector2 z2 = second.h * prior.mean + Vector2(second.s_root.matrixL() * Vector2(0.3, 1.2));
    double lost = 0.0;
    const Gaussian one = update_with(update_with(prior, first, z1, lost), second, z2, lost);
    const Gaussian other = update_with(update_with(prior, second, z2, lost), first, z1, lost);
    const State size = prior.covariance.diagonal().cwiseSqrt() + prior.mean.cwiseAbs();
    // Solving by Cholesky's factor loses n (3 n + 1) eps cond, n = 2: Higham (2002), theorem 10.4.
    EXPECT_TRUE(near(one.mean, other.mean, 14.0 * lost * size));
    EXPECT_TRUE(near(one.covariance, other.covariance, 14.0 * lost * matrices::scale_of(prior.covariance)));
  }
}

// Fifty positions of a target on a straight line without process noise, and a prior: a linear least-squares
// problem, solved whole by Householder QR of the whitened equations. The filter rounds to an eps of the
// prior's variance at worst, 1e4 of the last one's; fifty steps of some ten operations make 1e-9 of it.
TEST(KalmanUpdate, FilterEqualsBatchLeastSquares) {
  RandomStream stream(8);
  constexpr int kSteps = 50;
  const double dt_s = 1.0;
  const StateMatrix f = transition(ConstantVelocity{}, dt_s);
  Gaussian belief{{1000.0, 50.0, -2000.0, 80.0}, State(9e4, 900.0, 9e4, 900.0).asDiagonal()};
  const Gaussian prior = belief;
  const State prior_sigma = prior.covariance.diagonal().cwiseSqrt();
  const State truth = prior.mean + prior_sigma.cwiseProduct(matrices::normal_state(stream));

  PredictedMeasurement measurement;
  measurement.h = position_selector();
  measurement.r << 100.0, 60.0, 60.0, 400.0;
  const Matrix2 r_root = measurement.r.llt().matrixL();

  Eigen::MatrixXd rows(kStateSize + 2 * kSteps, kStateSize);  // whitened equations for the state at the start
  Eigen::VectorXd right(rows.rows());
  const StateMatrix whiten_prior = prior_sigma.cwiseInverse().asDiagonal();
  rows.topRows<kStateSize>() = whiten_prior;
  right.head<kStateSize>() = whiten_prior * prior.mean;
  StateMatrix so_far = StateMatrix::Identity();
  double lost = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    so_far = f * so_far;
    const Vector2 z = measurement.h * so_far * truth + r_root * Vector2(stream.normal(), stream.normal());
    rows.middleRows<2>(kStateSize + 2 * k) = r_root.inverse() * measurement.h * so_far;
    right.segment<2>(kStateSize + 2 * k) = r_root.inverse() * z;
    belief = update_with({f * belief.mean, f * belief.covariance * f.transpose()}, measurement, z, lost);
  }
  const State start = rows.householderQr().solve(right);
  const StateMatrix start_covariance = StateMatrix(rows.transpose() * rows).inverse();
  const StateMatrix expected = so_far * start_covariance * so_far.transpose();
  const State sigma = expected.diagonal().cwiseSqrt();
  EXPECT_TRUE(near(belief.mean, so_far * start, 1e-9 * sigma));
  EXPECT_TRUE(near(belief.covariance, expected, 1e-9 * matrices::scale_of(expected)));
}

}  // namespace
}  // namespace dwell
