#include "tracker/mode_bank.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "radar/frames.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"
#include "tests/tracker/catalogue.hpp"
#include "tests/tracker/matrices.hpp"

namespace dwell {
namespace {

using matrices::kEpsilon;
using matrices::near;

// Logarithm and exponential of well-conditioned stochastic matrices are good to some tens of eps.
constexpr double kMatrixFunction = 1e-13;

Eigen::MatrixXd matrix(std::initializer_list<std::initializer_list<double>> rows) {
  Eigen::MatrixXd m(std::ssize(rows), std::ssize(*rows.begin()));
  Eigen::Index i = 0;
  for (const auto& row : rows) m.row(i++) = Eigen::Map<const Eigen::RowVectorXd>(row.begin(), std::ssize(row));
  return m;
}

const Eigen::MatrixXd kTwoModes = matrix({{.95, .05}, {.3, .7}});

TEST(TransitionOver, NoTimeIsTheIdentity) {
  EXPECT_EQ(transition_over(kTwoModes, 0.0).value(), Eigen::MatrixXd::Identity(2, 2));
}

TEST(TransitionOver, WholeIntervalsArePowers) {
  EXPECT_EQ(transition_over(kTwoModes, 1.0).value(), kTwoModes);
  EXPECT_TRUE(near(*transition_over(kTwoModes, 3.0), kTwoModes * kTwoModes * kTwoModes, 4.0 * kEpsilon));
  // 0.3 s of a chain given over 0.1 s is not quite 3 in floating point, and still a power.
  EXPECT_EQ(*transition_over(kTwoModes, 0.3 / 0.1), *transition_over(kTwoModes, 3.0));
}

// P^t = pi + (1 - a - b)^t (I - pi) for two modes that leave with probabilities a and b; pi = [b a; b a] / (a
// + b).
TEST(TransitionOver, TwoModesFollowTheClosedForm) {
  const Eigen::MatrixXd stationary = matrix({{.3, .05}, {.3, .05}}) / 0.35;
  for (const double ratio : {0.01, 0.5, 1.5, 2.0, 7.25}) {
    const Eigen::MatrixXd expected =
        stationary + std::pow(0.65, ratio) * (Eigen::MatrixXd::Identity(2, 2) - stationary);
    EXPECT_TRUE(near(transition_over(kTwoModes, ratio).value(), expected, kMatrixFunction)) << ratio;
  }
}

// Whatever has no continuous-time chain behind it has no half: a chain that would rather jump than stay has a
// negative eigenvalue, one that forgets in a single step has none but zero, and one whose third mode is
// reached from the first only by way of the second would have to have been there already.
TEST(TransitionOver, ChainWithoutAFractionIsEmpty) {
  EXPECT_FALSE(transition_over(matrix({{.1, .9}, {.9, .1}}), 0.5));
  EXPECT_FALSE(transition_over(matrix({{.5, .5}, {.5, .5}}), 0.5));
  EXPECT_FALSE(transition_over(matrix({{.8, .2, 0}, {0, .8, .2}, {.2, 0, .8}}), 0.5));
  EXPECT_FALSE(transition_over(matrix({{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}), 0.5));
}

TEST(TransitionOver, ChainWithoutAFractionStillHasItsPowers) {
  const Eigen::MatrixXd jumpy = matrix({{.1, .9}, {.9, .1}});
  EXPECT_TRUE(near(transition_over(jumpy, 2.0).value(), matrix({{.82, .18}, {.18, .82}}), 4.0 * kEpsilon));
}

TEST(TransitionOver, OneModeStays) { EXPECT_EQ(transition_over(matrix({{1.0}}), 0.37).value()(0, 0), 1.0); }

// Two pairs that never meet: rounding puts nothing between them, and nothing under zero.
TEST(TransitionOver, ModesThatNeverMeetStayApart) {
  const Eigen::MatrixXd pairs = matrix({{.95, 0, .05, 0}, {0, .9, 0, .1}, {.3, 0, .7, 0}, {0, .25, 0, .75}});
  for (const double ratio : {0.01, 0.3, 0.5, 1.7}) {
    const Eigen::MatrixXd part = transition_over(pairs, ratio).value();
    EXPECT_GE(part.minCoeff(), 0.0) << ratio;
    EXPECT_LT(part(0, 1) + part(0, 3) + part(1, 0) + part(3, 2), kMatrixFunction) << ratio;
  }
}

class NamedBankLaw : public testing::TestWithParam<std::string> {
 protected:
  ModeBank bank() const { return named_bank(GetParam()).value(); }
};

INSTANTIATE_TEST_SUITE_P(Every, NamedBankLaw, testing::ValuesIn(catalogue::every_bank()),
                         [](const auto& row) { return row.param; });

TEST_P(NamedBankLaw, IsAProbabilityModel) {
  const ModeBank named = bank();
  const Eigen::Index modes = std::ssize(named.modes);
  ASSERT_EQ(named.transition.rows(), modes);
  ASSERT_EQ(named.transition.cols(), modes);
  ASSERT_EQ(named.initial_probability.size(), modes);
  EXPECT_GT(named.transition_interval_s, 0.0);
  EXPECT_GE(named.transition.minCoeff(), 0.0);
  EXPECT_GE(named.initial_probability.minCoeff(), 0.0);
  // Each sum is of at most a few decimals, each half an eps off.
  EXPECT_TRUE(near(named.transition.rowwise().sum(), Eigen::VectorXd::Ones(modes), 2.0 * kEpsilon));
  EXPECT_NEAR(named.initial_probability.sum(), 1.0, 2.0 * kEpsilon);
}

TEST_P(NamedBankLaw, EveryFractionIsAChain) {
  const Eigen::MatrixXd whole = bank().transition;
  for (const double ratio : {1e-3, 0.1, 0.5, 1.0 / 3.0, 2.5, 17.0}) {
    const auto part = transition_over(whole, ratio);
    ASSERT_TRUE(part) << ratio;
    EXPECT_GE(part->minCoeff(), 0.0) << ratio;
    EXPECT_TRUE(near(part->rowwise().sum(), Eigen::VectorXd::Ones(whole.rows()), 64.0 * kEpsilon)) << ratio;
  }
}

TEST_P(NamedBankLaw, FractionsComposeToTheWhole) {
  const Eigen::MatrixXd whole = bank().transition;
  const Eigen::MatrixXd half = transition_over(whole, 0.5).value();
  EXPECT_TRUE(near(half * half, whole, kMatrixFunction));
  Eigen::MatrixXd power = Eigen::MatrixXd::Identity(whole.rows(), whole.cols());
  for (int i = 0; i < 10; ++i) power = power * transition_over(whole, 0.1).value();
  EXPECT_TRUE(near(power, whole, 10.0 * kMatrixFunction));
}

TEST_P(NamedBankLaw, DiscretisesModeByMode) {
  const ModeBank named = bank();
  const DiscreteBank discrete = discretise(named, 2.0).value();
  ASSERT_EQ(discrete.size(), std::ssize(named.modes));
  ASSERT_EQ(discrete.q.size(), named.modes.size());
  EXPECT_EQ(discrete.transition, *transition_over(named.transition, 2.0 / named.transition_interval_s));
  for (std::size_t j = 0; j < named.modes.size(); ++j) {
    EXPECT_EQ(discrete.f[j], transition(named.modes[j].motion, 2.0));
    EXPECT_EQ(discrete.q[j], process_noise(named.modes[j].motion, named.modes[j].noise, 2.0));
  }
}

TEST(Discretise, CountsIntervalsOfTheChain) {
  ModeBank bank;
  bank.modes.resize(2);
  bank.transition = kTwoModes;
  bank.transition_interval_s = 2.0;
  EXPECT_EQ(discretise(bank, 4.0)->transition, kTwoModes * kTwoModes);
  EXPECT_EQ(discretise(bank, 4.0)->f[0](kX, kVx), 4.0);
}

TEST(Discretise, ChainWithoutAFractionIsEmpty) {
  ModeBank bank;
  bank.modes.resize(2);
  bank.transition = matrix({{.1, .9}, {.9, .1}});
  EXPECT_FALSE(discretise(bank, 0.5));
  EXPECT_TRUE(discretise(bank, 2.0));
}

// --- guards

/// From mode 0 to `to` where x <= at.
Guard below(double at, int to, double sigma) {
  Guard guard{0, to, Eigen::RowVector4d(1.0, 0.0, 0.0, 0.0), Eigen::VectorXd::Constant(1, -at),
              Eigen::MatrixXd::Constant(1, 1, sigma)};
  return guard;
}

DiscreteBank guarded_bank(std::vector<Guard> guards) {
  const Eigen::MatrixXd chain = matrix({{.9, .1, 0}, {.2, .8, 0}, {0, .5, .5}});
  return {std::vector<StateMatrix>(3, StateMatrix::Identity()), std::vector<StateMatrix>(3, StateMatrix::Zero()), chain,
          std::move(guards)};
}

// x ~ N(8, 3^2) against a threshold N(10, 4^2): Phi(2 / 5), and the chain for the rest of the row alone.
TEST(TransitionAt, IsTheGuardsProbabilityAndTheChainForTheRest) {
  Gaussian belief;
  belief.mean = make_state({8.0, 0.0}, {0.0, 0.0});
  belief.covariance(kX, kX) = 9.0;
  const Eigen::MatrixXd at = transition_at(guarded_bank({below(10.0, 2, 4.0)}), std::vector<Gaussian>(3, belief));
  const double g = 0.5 * std::erfc(-0.4 / std::sqrt(2.0));
  const Eigen::MatrixXd expected = matrix({{.9 * (1 - g), .1 * (1 - g), g}, {.2, .8, 0}, {0, .5, .5}});
  EXPECT_TRUE(near(at, expected, kEpsilon));
}

// Without any uncertainty a guard holds or it does not; guards that overlap share the row.
TEST(TransitionAt, CertainStates) {
  const std::vector<Gaussian> here(3);  // x = 0, no covariance
  EXPECT_EQ(transition_at(guarded_bank({below(1.0, 1, 0.0)}), here).row(0), Eigen::RowVector3d(0, 1, 0));
  EXPECT_EQ(transition_at(guarded_bank({below(-1.0, 1, 0.0)}), here).row(0), Eigen::RowVector3d(.9, .1, 0));
  EXPECT_EQ(transition_at(guarded_bank({below(1.0, 1, 0.0), below(2.0, 2, 0.0)}), here).row(0),
            Eigen::RowVector3d(0, .5, .5));
}

// Two rows that share their threshold, of a covariance of full rank, against drawn states and thresholds.
TEST(TransitionAt, EqualsTheShareOfDrawnStates) {
  RandomStream stream(5);
  const Gaussian belief = matrices::random_gaussian(stream);
  Guard guard{0, 1, Eigen::MatrixXd::Zero(2, kStateSize), Eigen::VectorXd(2), Eigen::MatrixXd::Zero(2, 2)};
  guard.l(0, kX) = guard.l(1, kVy) = 1.0;
  guard.l(1, kX) = -0.5;
  guard.b = -guard.l * belief.mean + Eigen::Vector2d(50.0, -200.0);
  guard.noise_root.col(0) = Eigen::Vector2d(100.0, -60.0);
  const int draws = scaled(100'000);
  int held = 0;
  const StateMatrix root = belief.covariance.llt().matrixL();
  for (int i = 0; i < draws; ++i) {
    const State x = belief.mean + root * matrices::normal_state(stream);
    const Eigen::Vector2d e = guard.noise_root * Eigen::Vector2d(stream.normal(), stream.normal());
    held += (guard.l * x + guard.b + e).maxCoeff() <= 0.0 ? 1 : 0;
  }
  DiscreteBank bank = guarded_bank({guard});
  bank.transition.setIdentity();
  const double p = transition_at(bank, std::vector<Gaussian>(3, belief))(0, 1);
  EXPECT_TRUE(statistics::binomial_band(draws, p).contains(held)) << p << " " << held;
  EXPECT_FALSE(statistics::binomial_band(draws, 0.9 * p).contains(held));
}

TEST(NamedBank, UnknownNameIsEmpty) {
  EXPECT_FALSE(named_bank(""));
  EXPECT_FALSE(named_bank("cruise"));
  EXPECT_FALSE(named_bank("cruise_and_turn "));
}

// Evans et al. (2005), (30): B = diag(sqrt .1, sqrt .1, .1, .1) and T = 1 s; Q = B B', ten times that while
// manoeuvring. The chain and its start: section V.
TEST(NamedBank, EvansAsPrinted) {
  const ModeBank bank = named_bank("as_printed").value();
  const DiscreteBank discrete = discretise(bank, 1.0).value();
  const StateMatrix q = StateMatrix(State(0.1, 0.1, 0.01, 0.01).asDiagonal());
  StateMatrix a;
  a << 1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1;
  EXPECT_EQ(discrete.f[0], a);
  EXPECT_EQ(discrete.f[1], a);
  EXPECT_TRUE(near(discrete.q[0], q, 0.1 * kEpsilon));
  EXPECT_TRUE(near(discrete.q[1], 10.0 * q, 2.0 * kEpsilon));
  EXPECT_EQ(discrete.transition, kTwoModes);
  EXPECT_EQ(bank.initial_probability, Eigen::Vector2d(.9, .1));
}

// sigma_a^2 [T^4/4 T^3/2; T^3/2 T^2] with sigma_a = 0.3 and 100 m/s^2.
TEST(NamedBank, EvansPractical) {
  const ModeBank bank = named_bank("evans_practical").value();
  const DiscreteBank discrete = discretise(bank, 1.0).value();
  EXPECT_NEAR(discrete.q[0](kVx, kVx), 0.09, kEpsilon);
  EXPECT_EQ(discrete.q[1](kX, kX), 2500.0);
  EXPECT_EQ(discrete.q[1](kX, kVx), 5000.0);
  EXPECT_EQ(discrete.q[1](kVy, kVy), 10000.0);
  EXPECT_EQ(discrete.transition, kTwoModes);
}

// Liu, Hwang (2011), (22)-(24): left and right turn at 10 deg/s, constant velocity; noise [T^2/2 T] of 1
// m/s^2.
TEST(NamedBank, LiuHwang) {
  const ModeBank bank = named_bank("liu_hwang").value();
  const DiscreteBank discrete = discretise(bank, 1.0).value();
  const double w = 10.0 * kDegree;
  StateMatrix left, q;
  left << 1, std::sin(w) / w, 0, -(1 - std::cos(w)) / w,  //
      0, std::cos(w), 0, -std::sin(w),                    //
      0, (1 - std::cos(w)) / w, 1, std::sin(w) / w,       //
      0, std::sin(w), 0, std::cos(w);
  q << .25, .5, 0, 0, .5, 1, 0, 0, 0, 0, .25, .5, 0, 0, .5, 1;
  // 1 - cos w as printed cancels: an eps over its w.
  EXPECT_TRUE(near(discrete.f[0], left, kEpsilon / w));
  StateMatrix right = left;  // the sines of -w: the elements between the axes change sign
  right.topRightCorner<2, 2>() *= -1.0;
  right.bottomLeftCorner<2, 2>() *= -1.0;
  EXPECT_TRUE(near(discrete.f[1], right, kEpsilon / w));
  EXPECT_EQ(discrete.f[2], transition(ConstantVelocity{}, 1.0));
  for (const StateMatrix& noise : discrete.q) EXPECT_EQ(noise, q);
  EXPECT_EQ(discrete.transition, matrix({{.6, .2, .2}, {.2, .6, .2}, {.2, .2, .6}}));
}

TEST(NamedBank, CruiseAndTurn) {
  const ModeBank bank = named_bank("cruise_and_turn").value();
  const DiscreteBank discrete = discretise(bank, 1.0).value();
  EXPECT_EQ(discrete.q[0](kVx, kVx), 0.1);
  EXPECT_EQ(discrete.q[1](kVx, kVx), 60.0);
  EXPECT_EQ(discrete.q[2](kVx, kVx), 2000.0);
  EXPECT_EQ(discrete.transition, matrix({{.9940, .0055, .0005}, {.0100, .9850, .0050}, {.0100, .1400, .8500}}));
  EXPECT_EQ(bank.initial_probability, Eigen::Vector3d(.9, .05, .05));
}

// cruise_and_turn's modes and a turn to either side, which the chain does not tell apart.
TEST(NamedBank, Manoeuvring) {
  const DiscreteBank discrete = discretise(named_bank("manoeuvring").value(), 1.0).value();
  const DiscreteBank white = discretise(named_bank("cruise_and_turn").value(), 1.0).value();
  ASSERT_EQ(discrete.size(), 5);
  for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(discrete.q[j], white.q[j]);
  EXPECT_EQ(discrete.f[3], transition(CoordinatedTurn{7.0 * kDegree}, 1.0));
  EXPECT_EQ(discrete.f[4], transition(CoordinatedTurn{-7.0 * kDegree}, 1.0));
  EXPECT_EQ(discrete.transition.col(3).head<3>(), discrete.transition.col(4).head<3>());
  EXPECT_EQ(discrete.transition.row(3).head<3>(), discrete.transition.row(4).head<3>());
  EXPECT_EQ(discrete.transition(3, 4), discrete.transition(4, 3));
}

}  // namespace
}  // namespace dwell
