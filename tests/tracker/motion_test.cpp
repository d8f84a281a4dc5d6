#include "tracker/motion.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "tests/tracker/catalogue.hpp"
#include "tests/tracker/matrices.hpp"

namespace dwell {
namespace {

using catalogue::alternating_series;
using catalogue::NamedMotion;
using matrices::kEpsilon;
using matrices::near;

constexpr double kPi = std::numbers::pi;

class MotionLaw : public testing::TestWithParam<NamedMotion> {
 protected:
  Motion motion() const { return GetParam().model; }
};

INSTANTIATE_TEST_SUITE_P(Every, MotionLaw, testing::ValuesIn(catalogue::every_motion()),
                         [](const auto& row) { return row.param.name; });

TEST_P(MotionLaw, NoTimeIsTheIdentity) { EXPECT_EQ(transition(motion(), 0.0), StateMatrix::Identity()); }

// F(a + b) = F(b) F(a). The intervals are binary fractions, so a + b is exact. What is left is the rounding
// of the elements and of their products, a few eps of (|F(b)| |F(a)|)_ij, and that of the angle, eps |w (a +
// b)|.
TEST_P(MotionLaw, IntervalsCompose) {
  for (const double a : {0.0, 0.125, 1.0, 3.5, 64.0}) {
    for (const double b : {0.25, 1.0, 10.0, 100.0}) {
      const StateMatrix f_a = transition(motion(), a);
      const StateMatrix f_b = transition(motion(), b);
      const double angle = std::abs(catalogue::turn_rate(motion())) * (a + b);
      const StateMatrix tolerance = 8.0 * kEpsilon * (1.0 + angle) * (f_b.cwiseAbs() * f_a.cwiseAbs());
      EXPECT_TRUE(near(f_b * f_a, transition(motion(), a + b), tolerance)) << "a = " << a << ", b = " << b;
    }
  }
}

// exp(A t) by scaling and squaring is good to a few eps of exp(|A| t), element by element.
TEST_P(MotionLaw, SolvesItsDifferentialEquation) {
  const StateMatrix a = catalogue::generator(motion());
  for (const double dt_s : {1e-3, 0.3, 1.0, 4.0}) {
    const StateMatrix expected = StateMatrix(a * dt_s).exp();
    const StateMatrix size = StateMatrix(a.cwiseAbs() * dt_s).exp();
    EXPECT_TRUE(near(transition(motion(), dt_s), expected, 16.0 * kEpsilon * size)) << "dt = " << dt_s;
  }
}

TEST_P(MotionLaw, KeepsTheSpeed) {
  for (const double dt_s : {1e-3, 1.0, 17.0, 1e3}) {
    const State x = transition(motion(), dt_s) * State(1e4, 300.0, -5e3, 400.0);
    EXPECT_NEAR(velocity(x).norm(), 500.0, 500.0 * 4.0 * kEpsilon);
  }
}

// Velocity east, a quarter circle to the left in one second: north, and r = v / w forward and r to the left.
TEST(CoordinatedTurn, QuarterCircleToTheLeft) {
  const double rate = 0.5 * kPi;
  const State x = transition(CoordinatedTurn{rate}, 1.0) * make_state({0.0, 0.0}, {1.0, 0.0});
  EXPECT_TRUE(near(x, make_state({2.0 / kPi, 2.0 / kPi}, {0.0, 1.0}), 2.0 * kEpsilon));
}

// After 2 pi / w the sine and cosine are of 2 pi (1 + eps): an error of 2 pi eps of the speed, and of v / w.
TEST(CoordinatedTurn, FullCircleReturns) {
  for (const double rate : {-1.0, 10.0 * kDegree, 1e-3, 7.0}) {
    const State start = make_state({1e3, -2e3}, {120.0, -50.0});
    const State end = transition(CoordinatedTurn{rate}, 2.0 * kPi / std::abs(rate)) * start;
    const double round = 2.0 * kPi * kEpsilon * 130.0;
    EXPECT_TRUE(near(velocity(end), velocity(start), round)) << rate;
    EXPECT_TRUE(near(position(end), position(start), round / std::abs(rate) + 2e3 * kEpsilon)) << rate;
  }
}

// Each element to 4 eps of itself, down to turns of 1e-15 rad: nothing cancels on the way to constant
// velocity.
TEST(CoordinatedTurn, EveryElementIsExactForTinyTurns) {
  for (const double dt_s : {0.01, 1.0, 100.0}) {
    for (double turn = 0.5; turn > 1e-15; turn *= 0.3) {
      const double rate = turn / dt_s;
      const StateMatrix f = transition(CoordinatedTurn{rate}, dt_s);
      const long double u = static_cast<long double>(rate) * static_cast<long double>(dt_s);
      const auto w = static_cast<long double>(rate);
      const auto expect_equal = [&](double actual, long double expected) {
        EXPECT_NEAR(actual, static_cast<double>(expected), 4.0 * kEpsilon * std::abs(static_cast<double>(expected)))
            << "turn " << turn << " over " << dt_s << " s";
      };
      expect_equal(f(kX, kVx), alternating_series(u, 1) / w);
      expect_equal(f(kX, kVy), -alternating_series(u, 2) / w);
      expect_equal(f(kY, kVx), alternating_series(u, 2) / w);
      expect_equal(f(kVx, kVx), alternating_series(u, 0));
      expect_equal(f(kVy, kVx), alternating_series(u, 1));
    }
  }
}

// F differs from constant velocity's by u T / 2 across, u in the velocity, and u^2 / 2 of each element along.
TEST(CoordinatedTurn, BecomesConstantVelocityAsTheRateVanishes) {
  const double dt_s = 2.0;
  const StateMatrix straight = transition(ConstantVelocity{}, dt_s);
  for (double rate = 0.1; rate > 1e-300; rate *= 1e-3) {
    const double u = rate * dt_s;
    const StateMatrix f = transition(CoordinatedTurn{rate}, dt_s);
    EXPECT_TRUE(near(f, straight, u * dt_s + 2.0 * kEpsilon)) << rate;
  }
}

}  // namespace
}  // namespace dwell
