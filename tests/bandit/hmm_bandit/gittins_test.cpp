#include "bandit/hmm_bandit/gittins.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "bandit/gauss_legendre.hpp"
#include "radar/random.hpp"
#include "tests/bandit/hmm_bandit/gittins_on_grid.hpp"
#include "tests/scale.hpp"

namespace dwell::hmm_bandit {
namespace {

Arm two_states() {
  Arm arm;
  arm.transition.resize(2, 2);
  arm.transition << 0.8, 0.2, 0.3, 0.7;
  arm.emission.resize(2, 2);
  arm.emission << 0.7, 0.3, 0.2, 0.8;
  arm.reward = Eigen::Vector2d(0, 1);
  return arm;
}

Arm three_states() {
  Arm arm;
  arm.transition.resize(3, 3);
  arm.transition << 0.8, 0.15, 0.05, 0.1, 0.7, 0.2, 0.05, 0.25, 0.7;
  arm.emission.resize(3, 3);
  arm.emission << 0.7, 0.2, 0.1, 0.2, 0.6, 0.2, 0.1, 0.2, 0.7;
  arm.reward = Eigen::Vector3d(0, 0.4, 1);
  return arm;
}

Eigen::MatrixXd random_rows(RandomStream& random, int rows, int columns) {
  Eigen::MatrixXd p(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) p(i, j) = 0.02 - std::log(1.0 - random.uniform());
    p.row(i) /= p.row(i).sum();
  }
  return p;
}

/// Values of an independent program, stable to 1e-13; the set is exact once it no longer changes.
TEST(Gittins, EqualsTheReferenceValues) {
  const double at[] = {0.1, 0.3, 0.5, 0.8};
  const double index[] = {0.3499068460612, 0.4749116607774, 0.6166112956811, 0.8};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(gittins_index(two_states(), Eigen::Vector2d(1 - at[i], at[i]), 0.9).index, index[i], 1e-12);
  }
  const Eigen::Vector3d uniform = Eigen::Vector3d::Constant(1.0 / 3.0);
  EXPECT_NEAR(gittins_index(three_states(), uniform, 0.8).index, 0.5802031240119, 1e-12);
  EXPECT_NEAR(gittins_index(three_states(), Eigen::Vector3d(0.1, 0.3, 0.6), 0.8).index, 0.7779518187691, 1e-12);
}

/// An arm that pays c in every state has index c, whatever it shows.
TEST(Gittins, OfAConstantRewardIsTheReward) {
  Arm arm = three_states();
  arm.reward.setConstant(0.37);
  EXPECT_NEAR(gittins_index(arm, Eigen::Vector3d(0.2, 0.5, 0.3), 0.9).index, 0.37, 1e-13);
}

/// Point-based from below, grid from above; rounding of either is 1e-9 of the rewards.
TEST(Gittins, PointsAndGridBracketTheIndex) {
  RandomStream random(3);
  for (int trial = 0; trial < scaled(10); ++trial) {
    const int n = 2 + trial % 3;
    Arm arm;
    arm.transition = random_rows(random, n, n);
    arm.emission = random_rows(random, n, 2 + trial % 2);
    arm.reward.resize(n);
    for (int i = 0; i < n; ++i) arm.reward[i] = random.uniform();
    arm.belief = random_rows(random, 1, n).row(0);
    const double discount = random.uniform(0.5, 0.9);
    const double below = gittins_index(arm, arm.belief, discount, 300).index;
    const double above = gittins_index_on_grid(arm, arm.belief, discount, n == 2 ? 200 : n == 3 ? 20 : 10);
    EXPECT_LE(below, above + 1e-9);
    EXPECT_LE(above - below, 0.01) << "n " << n;
  }
}

/// Three states in a row, seen, the reward at the end: r1, then a loss, then 1 for ever. From the first, stopping at
/// once gives r1, and playing for ever (1 - b)(r1 + b r2) + b^2; one play more is worse than both.
TEST(Gittins, SeesAFarRewardBehindALoss) {
  const struct { double discount, loss; } cases[] = {{0.9, -3.0}, {0.99, -40.0}, {0.999, -100.0}};
  for (const auto& c : cases) {
    Arm arm;
    arm.transition.resize(3, 3);
    arm.transition << 0, 1, 0, 0, 0, 1, 0, 0, 1;
    arm.emission = Eigen::MatrixXd::Ones(3, 1);
    arm.reward = Eigen::Vector3d(0.5, c.loss, 1.0);
    const double b = c.discount;
    const double for_ever = (1.0 - b) * (0.5 + b * c.loss) + b * b;
    const GittinsResult result = gittins_index(arm, Eigen::Vector3d(1, 0, 0), b);
    EXPECT_TRUE(result.converged);
    // A sweep that changes the values, up to 1 / (1 - b), by 1e-12 of them leaves 1 / (1 - b) times that of V, and as
    // many times of K = index / (1 - b).
    EXPECT_NEAR(result.index, std::max(0.5, for_ever), 1e-12 / ((1.0 - b) * (1.0 - b))) << "b " << b;
  }
}

/// What playing a Bernoulli arm with a uniform prior is worth more than `reward` a play for ever: dynamic programming
/// over successes and plays, from above, as late plays are all taken to succeed.
double worth_of_playing(double discount, double reward) {
  constexpr double kLate = 1e-12;  // what the discount leaves of them
  const auto plays = static_cast<std::size_t>(std::ceil(std::log(kLate) / std::log(discount)));
  const double retired = reward / (1.0 - discount);
  std::vector<double> value(plays + 1, 1.0 / (1.0 - discount));  // by successes
  double playing = 0.0;
  for (std::size_t played = plays; played-- > 0;) {
    for (std::size_t successes = 0; successes <= played; ++successes) {
      const double success = (static_cast<double>(successes) + 1.0) / (static_cast<double>(played) + 2.0);
      playing = success * (1.0 + discount * value[successes + 1]) + (1.0 - success) * discount * value[successes];
      value[successes] = std::max(playing, retired);
    }
  }
  return playing - retired;
}

/// A Bernoulli arm with a uniform prior is a chain that stands still in a state drawn from [0, 1]. At Gauss-Legendre's
/// n nodes the predictive probabilities of up to 2 n - 1 plays are exact. Published to four digits: Gittins (1989).
/// The index is below the true one, as the dynamic programme says, and by less than the last digit.
TEST(Gittins, OfABernoulliArm) {
  struct Case {
    double discount;
    int nodes, points;
    double index;
  };
  std::vector<Case> cases = {{0.9, 24, 300, 0.7029}, {0.95, 32, 600, 0.7614}};
  if (soak()) cases.push_back({0.99, 40, 1000, 0.8699});  // minutes
  for (const Case& c : cases) {
    const auto nodes = gauss_legendre(c.nodes);
    const auto n = static_cast<Eigen::Index>(nodes.size());
    Arm arm;
    arm.transition = Eigen::MatrixXd::Identity(n, n);
    arm.emission.resize(n, 2);
    arm.reward.resize(n);
    arm.belief.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const QuadratureNode& node = nodes[static_cast<std::size_t>(i)];
      arm.emission.row(i) << 1.0 - node.u, node.u;
      arm.reward[i] = node.u;
      arm.belief[i] = node.weight;
    }
    const GittinsResult result = gittins_index(arm, arm.belief, c.discount, c.points);
    EXPECT_TRUE(result.converged);
    EXPECT_NEAR(result.index, c.index, 5e-5) << "b " << c.discount << " sweeps " << result.sweeps;
    EXPECT_GE(worth_of_playing(c.discount, result.index - 1e-9), 0.0) << "b " << c.discount;
    EXPECT_LT(worth_of_playing(c.discount, result.index + 5e-5), 0.0) << "b " << c.discount;
  }
}

}  // namespace
}  // namespace dwell::hmm_bandit
