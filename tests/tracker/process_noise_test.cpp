#include "tracker/process_noise.hpp"

#include <array>
#include <cmath>
#include <tuple>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "tests/tracker/catalogue.hpp"
#include "tests/tracker/matrices.hpp"

namespace dwell {
namespace {

using catalogue::NamedMotion;
using catalogue::NamedNoise;
using matrices::kEpsilon;
using matrices::near;
using matrices::scale_of;

/// (u - sin u) / u^2, the worst of the closed forms, loses a factor 6 / u^2 where it is not a series, 600 at
/// most.
constexpr double kClosedForm = 600.0 * kEpsilon;

class NoiseLaw : public testing::TestWithParam<std::tuple<NamedMotion, NamedNoise>> {
 protected:
  const Motion& motion() const { return std::get<0>(GetParam()).model; }
  const ProcessNoise& noise() const { return std::get<1>(GetParam()).model; }
  StateMatrix q(double dt_s) const { return process_noise(motion(), noise(), dt_s); }
};

INSTANTIATE_TEST_SUITE_P(Every, NoiseLaw,
                         testing::Combine(testing::ValuesIn(catalogue::every_motion()),
                                          testing::ValuesIn(catalogue::every_noise())),
                         [](const auto& row) {
                           return std::get<0>(row.param).name + "_" + std::get<1>(row.param).name;
                         });

constexpr std::array kIntervals{0.125, 0.25, 0.5, 1.0, 2.0, 7.0, 30.0};

TEST_P(NoiseLaw, NoTimeAddsNothing) { EXPECT_EQ(q(0.0), StateMatrix::Zero()); }

// Q(a + b) = F(b) Q(a) F(b)' + Q(b), to the accuracy of the closed forms in each of the three terms.
TEST_P(NoiseLaw, IntervalsCompose) {
  for (const double a : kIntervals) {
    for (const double b : kIntervals) {
      if (!divides(noise(), a) || !divides(noise(), b)) continue;
      const StateMatrix f = transition(motion(), b);
      const StateMatrix whole = q(a + b);
      const StateMatrix size = f.cwiseAbs() * scale_of(q(a)) * f.cwiseAbs().transpose() + scale_of(q(b));
      EXPECT_TRUE(near(f * q(a) * f.transpose() + q(b), whole, 2.0 * kClosedForm * size))
          << "a = " << a << ", b = " << b;
    }
  }
}

// One step of noise of fewer ranks than states is singular: its least eigenvalue is zero but for rounding,
// which is a few eps of the largest, 4 of a matrix of correlations.
TEST_P(NoiseLaw, IsSymmetricAndNotNegative) {
  for (const double dt_s : kIntervals) {
    if (!divides(noise(), dt_s)) continue;
    const StateMatrix whole = q(dt_s);
    EXPECT_EQ(whole, whole.transpose()) << dt_s;
    if (whole.isZero(0.0)) continue;
    ASSERT_GT(whole.diagonal().minCoeff(), 0.0);
    const StateMatrix correlation = whole.cwiseQuotient(scale_of(whole));
    const Eigen::SelfAdjointEigenSolver<StateMatrix> solver(correlation, Eigen::EigenvaluesOnly);
    EXPECT_GE(solver.eigenvalues().minCoeff(), -4.0 * kClosedForm) << dt_s;
  }
}

/// integral over 0..T of g(s), by Gauss's five nodes on 64 pieces: exact for polynomials of degree 9 on each
/// piece, which leaves far less than rounding for sines of under one radian a piece.
template <class Integrand>
StateMatrix integrate(double end, const Integrand& g) {
  const double inner = std::sqrt(5.0 - 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
  const double outer = std::sqrt(5.0 + 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
  const double inner_weight = (322.0 + 13.0 * std::sqrt(70.0)) / 900.0;
  const double outer_weight = (322.0 - 13.0 * std::sqrt(70.0)) / 900.0;
  constexpr int kPieces = 64;
  const double half = 0.5 * end / kPieces;
  StateMatrix sum = StateMatrix::Zero();
  for (int i = 0; i < kPieces; ++i) {
    const double centre = (2 * i + 1) * half;
    sum += 128.0 / 225.0 * g(centre);
    sum += inner_weight * (g(centre - half * inner) + g(centre + half * inner));
    sum += outer_weight * (g(centre - half * outer) + g(centre + half * outer));
  }
  return half * sum;
}

class WhiteNoise : public testing::TestWithParam<NamedMotion> {};

INSTANTIATE_TEST_SUITE_P(Every, WhiteNoise, testing::ValuesIn(catalogue::every_motion()),
                         [](const auto& row) { return row.param.name; });

// Q(T) = integral of F(s) G q G' F(s)' over 0..T, G the velocities.
TEST_P(WhiteNoise, EqualsItsIntegral) {
  const double density = 60.0;
  const StateMatrix g = density * StateMatrix(State(0.0, 1.0, 0.0, 1.0).asDiagonal());
  for (const double dt_s : {1e-3, 0.3, 1.0, 6.0, 20.0}) {
    const StateMatrix expected = integrate(dt_s, [&](double s) {
      const StateMatrix f = transition(GetParam().model, s);
      return StateMatrix(f * g * f.transpose());
    });
    const StateMatrix whole = process_noise(GetParam().model, WhiteNoiseAcceleration{density}, dt_s);
    EXPECT_TRUE(near(whole, expected, kClosedForm * scale_of(expected))) << dt_s;
  }
}

// q (T - sin(u) / w) / w across and q (1 - cos u) / w^2 along must keep their own digits, not only those of
// the variances, down to turns of 1e-15 rad. Beyond 0.1 rad u - sin u is a difference, with the loss above.
TEST(WhiteNoise, CrossCovarianceOfTinyTurnsDoesNotCancel) {
  const double density = 2.0;
  for (const double dt_s : {0.1, 3.0}) {
    for (double turn = 0.4; turn > 1e-15; turn *= 0.7) {
      const StateMatrix q = white_noise(CoordinatedTurn{turn / dt_s}, density, dt_s);
      const auto w = static_cast<long double>(turn / dt_s);
      const auto u = w * static_cast<long double>(dt_s);
      const auto across = static_cast<double>(density * catalogue::alternating_series(u, 3) / (w * w));
      const auto along = static_cast<double>(density * catalogue::alternating_series(u, 2) / (w * w));
      const double loss = turn > 0.1 ? kClosedForm : 8.0 * kEpsilon;
      EXPECT_NEAR(q(kX, kVy), across, loss * across) << turn;
      EXPECT_NEAR(q(kY, kVx), -across, loss * across) << turn;
      EXPECT_NEAR(q(kX, kVx), along, 8.0 * kEpsilon * along) << turn;
      EXPECT_NEAR(q(kX, kX), 2.0 * across / static_cast<double>(w), 2.0 * loss * across / static_cast<double>(w));
    }
  }
}

// sigma = 2, one second: Q1 = 4 [1/4 1/2; 1/2 1] = [1 2; 2 4]. F Q1 F' = [1+2+2+4 2+4; . 4] = [9 6; 6 4].
TEST(PiecewiseAcceleration, TwoStepsByHand) {
  const ProcessNoise noise = PiecewiseAcceleration{2.0};
  const StateMatrix one = process_noise(ConstantVelocity{}, noise, 1.0);
  const StateMatrix two = process_noise(ConstantVelocity{}, noise, 2.0);
  StateMatrix expected_one, expected_two;
  expected_one << 1, 2, 0, 0, 2, 4, 0, 0, 0, 0, 1, 2, 0, 0, 2, 4;
  expected_two << 10, 8, 0, 0, 8, 8, 0, 0, 0, 0, 10, 8, 0, 0, 8, 8;
  EXPECT_EQ(one, expected_one);
  EXPECT_EQ(two, expected_two);
}

// Over three steps: velocity 3 b_v^2, position 3 b_x^2 + (0 + 1 + 4) b_v^2, between them (0 + 1 + 2) b_v^2.
TEST(DiagonalNoise, ThreeStepsByHand) {
  const StateMatrix q = process_noise(ConstantVelocity{}, DiagonalNoise{{4.0, 2.0, 1.0, 3.0}}, 3.0);
  StateMatrix expected;
  expected << 68, 12, 0, 0, 12, 12, 0, 0, 0, 0, 48, 27, 0, 0, 27, 27;
  EXPECT_EQ(q, expected);
}

TEST(ProcessNoise, StepsDivideWholeMultiplesOnly) {
  const ProcessNoise tenth = PiecewiseAcceleration{1.0, 0.1};
  EXPECT_TRUE(divides(tenth, 0.3));  // 0.3 / 0.1 = 2.9999999999999996
  EXPECT_TRUE(divides(tenth, 0.0));
  EXPECT_FALSE(divides(tenth, 0.25));
  EXPECT_FALSE(divides(DiagonalNoise{State::Ones(), 1.0}, 2.5));
  EXPECT_TRUE(divides(WhiteNoiseAcceleration{1.0}, 0.123));
  EXPECT_TRUE(divides(NoProcessNoise{}, 0.123));
}

TEST(ProcessNoiseDeathTest, PartOfAStepIsRefused) {
  EXPECT_DEATH(process_noise(ConstantVelocity{}, PiecewiseAcceleration{1.0}, 0.5), "invariant broken");
}

}  // namespace
}  // namespace dwell
