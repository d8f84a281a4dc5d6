#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "bandit/hmm_selection/belief.hpp"
#include "bandit/hmm_selection/policies.hpp"
#include "tests/scale.hpp"

namespace dwell::hmm_selection {
namespace {

using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

Eigen::MatrixXd distributions(int rows, int cols, RandomStream& stream) {
  Eigen::MatrixXd m(rows, cols);
  for (double& entry : m.reshaped()) entry = -std::log(1.0 - stream.uniform());
  for (int i = 0; i < rows; ++i) m.row(i) /= m.row(i).sum();
  return m;
}

Problem random_problem(int states, int sensors, int horizon, RandomStream& stream) {
  Problem problem;
  problem.transition = distributions(states, states, stream);
  problem.belief = distributions(1, states, stream).row(0);
  problem.horizon = horizon;
  problem.beta = 0.5 + stream.uniform();
  for (int u = 0; u < sensors; ++u) {
    const int symbols = 2 + static_cast<int>(2.0 * stream.uniform());
    problem.sensors.push_back({distributions(states, symbols, stream), 0.05 * stream.uniform()});
  }
  return problem;
}

/// Sensor 1 sees the state, sensor 2 nothing. The chain keeps its state.
Problem sight_and_blind(double cost_of_sight) {
  Problem problem;
  problem.transition = Eigen::Matrix2d::Identity();
  problem.belief = Eigen::Vector2d(0.5, 0.5);
  problem.horizon = 3;
  problem.sensors = {{Eigen::Matrix2d::Identity(), cost_of_sight}, {Eigen::MatrixXd::Ones(2, 1), 0.0}};
  return problem;
}

TEST(HmmBelief, ByHand) {
  Problem problem;
  problem.transition = Eigen::Matrix2d{{0.9, 0.1}, {0.3, 0.7}};
  problem.belief = Eigen::Vector2d(0.5, 0.5);  // predicted (0.6, 0.4)
  problem.sensors = {{Eigen::Matrix2d{{0.8, 0.2}, {0.1, 0.9}}, 0.25}};
  const std::vector<Outcome> seen = outcomes(problem, problem.belief, 0);
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_NEAR(seen[0].probability, 0.52, 1e-15);
  EXPECT_NEAR(seen[0].belief[0], 0.48 / 0.52, 1e-15);
  EXPECT_NEAR(seen[1].probability, 0.48, 1e-15);
  EXPECT_NEAR(seen[1].belief[0], 0.25, 1e-15);
  const double expected = 0.25 + 1.0 - (0.48 * 0.48 + 0.04 * 0.04) / 0.52 - (0.12 * 0.12 + 0.36 * 0.36) / 0.48;
  EXPECT_NEAR(expected_cost(problem, problem.belief, 0), expected, 1e-15);
}

TEST(HmmBelief, WhatCannotBeSeenIsNoOutcome) {
  Problem problem = sight_and_blind(0.0);
  problem.belief = Eigen::Vector2d(1.0, 0.0);
  EXPECT_EQ(outcomes(problem, problem.belief, 0).size(), 1U);
}

TEST(HmmBelief, AveragesToThePrediction) {
  RandomStream stream(60);
  for (int run = 0; run < scaled(100); ++run) {
    const Problem problem = random_problem(3, 1, 1, stream);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Outcome& outcome : outcomes(problem, problem.belief, 0)) mean += outcome.probability * outcome.belief;
    EXPECT_LT((mean - problem.transition.transpose() * problem.belief).norm(), 1e-14);
  }
}

// Sight for 0.6: the first look clears 1/2 a step for three steps, but only 1/2 in the first.
TEST(HmmSelection, TheOneStepRuleDoesNotInvest) {
  const Problem problem = sight_and_blind(0.6);
  const RandomStream stream(61);
  EXPECT_NEAR(solve(problem, WindowSettings{}, 2, stream).cost, 1.5, 1e-14);
  const Solution best = solve(problem, OptimumSettings{}, 2, stream);
  EXPECT_NEAR(best.cost, 0.6, 1e-14);
  EXPECT_EQ(best.first, 1);
  EXPECT_NEAR(best.looks[0], 1.0, 1e-14);
  EXPECT_NEAR(best.looks[1], 2.0, 1e-14);
  EXPECT_NEAR(solve(problem, FixedSettings{1}, 2, stream).cost, 1.8, 1e-14);
  EXPECT_NEAR(solve(problem, RoundRobinSettings{}, 2, stream).cost, 1.2, 1e-14);
}

TEST(HmmSelection, TiesGoToTheFirstSensor) {
  Problem problem = sight_and_blind(0.0);
  problem.sensors[1] = problem.sensors[0];
  EXPECT_EQ(solve(problem, WindowSettings{}, 2, RandomStream(62)).first, 1);
  EXPECT_EQ(solve(problem, OptimumSettings{}, 2, RandomStream(62)).first, 1);
}

TEST(HmmSelection, TheOptimumIsBelowAllAndEqualAtOneStep) {
  RandomStream stream(63);
  for (int run = 0; run < scaled(100); ++run) {
    Problem problem = random_problem(3, 3, 4, stream);
    const double best = solve(problem, OptimumSettings{}, 2, stream).cost;
    for (const PolicySettings& settings :
         {PolicySettings{WindowSettings{}}, PolicySettings{RoundRobinSettings{}}, PolicySettings{FixedSettings{2}}}) {
      EXPECT_LE(best, solve(problem, settings, 2, stream).cost * (1.0 + 1e-12));
    }
    problem.horizon = 1;
    const Solution one = solve(problem, WindowSettings{}, 2, stream);
    const Solution whole = solve(problem, OptimumSettings{}, 2, stream);
    EXPECT_EQ(one.first, whole.first);
    EXPECT_NEAR(one.cost, whole.cost, 1e-14);
  }
}

TEST(HmmSelection, AWindowOfTheHorizonIsTheOptimum) {
  RandomStream stream(67);
  for (int run = 0; run < scaled(30); ++run) {
    const Problem problem = random_problem(3, 2, 4, stream);
    const Solution best = solve(problem, OptimumSettings{}, 2, stream);
    for (const int d : {4, 9}) {
      const Solution wide = solve(problem, WindowSettings{d}, 2, stream);
      EXPECT_NEAR(wide.cost, best.cost, 1e-13 * best.cost);
      EXPECT_EQ(wide.first, best.first);
    }
  }
}

// By the printed rule: argmin_u expected_cost, at the first belief.
TEST(HmmSelection, AWindowOfOneIsTheOneStepRule) {
  RandomStream stream(68);
  for (int run = 0; run < scaled(100); ++run) {
    const Problem problem = random_problem(3, 3, 3, stream);
    std::vector<double> costs;
    for (int u = 0; u < 3; ++u) costs.push_back(expected_cost(problem, problem.belief, u));
    const auto least = std::min_element(costs.begin(), costs.end()) - costs.begin();
    EXPECT_EQ(solve(problem, WindowSettings{1}, 2, stream).first, least + 1);
  }
}

/// All plans of two steps: a first sensor, and a second for each symbol it may show.
double best_plan(const Problem& problem) {
  double best = 1e300;
  for (int first = 0; first < problem.sensor_count(); ++first) {
    double cost = problem.sensors[static_cast<std::size_t>(first)].cost;
    const Eigen::VectorXd predicted = problem.transition.transpose() * problem.belief;
    const Eigen::MatrixXd& emission = problem.sensors[static_cast<std::size_t>(first)].emission;
    for (int y = 0; y < emission.cols(); ++y) {
      const double p = emission.col(y).dot(predicted);
      const Eigen::VectorXd belief = emission.col(y).cwiseProduct(predicted) / p;
      double second = 1e300;
      for (int u = 0; u < problem.sensor_count(); ++u) second = std::min(second, expected_cost(problem, belief, u));
      cost += p * (problem.beta * (1.0 - belief.dot(belief)) + second);
    }
    best = std::min(best, cost);
  }
  return best;
}

TEST(HmmSelection, TheOptimumOfTwoStepsIsTheBestPlan) {
  RandomStream stream(64);
  for (int run = 0; run < scaled(100); ++run) {
    const Problem problem = random_problem(2 + run % 3, 3, 2, stream);
    const double best = best_plan(problem);
    EXPECT_NEAR(solve(problem, OptimumSettings{}, 2, stream).cost, best, 1e-13 * best);
  }
}

// The mean of 4000 runs within 5 of its standard errors: a false alarm in 1e6.
TEST(HmmSelection, RunsAgreeWithTheTree) {
  RandomStream stream(65);
  const Problem problem = random_problem(3, 2, 8, stream);
  const std::vector<PolicySettings> policies{WindowSettings{1}, WindowSettings{2}, RoundRobinSettings{}};
  for (const PolicySettings& settings : policies) {
    const Solution exact = solve(problem, settings, 2, stream);
    EXPECT_EQ(exact.standard_error, 0.0);
    const Solution runs = sample(problem, settings, 4000, stream);
    EXPECT_GT(runs.standard_error, 0.0);
    EXPECT_LT(runs.standard_error, 0.01 * runs.cost);  // so that the comparison says something
    EXPECT_NEAR(runs.cost, exact.cost, 5.0 * runs.standard_error);
    EXPECT_NEAR(runs.looks[0] + runs.looks[1], 8.0, 1e-9);
    EXPECT_EQ(runs.first, exact.first);
  }
}

TEST(HmmSelection, ALongHorizonIsSampled) {
  RandomStream stream(69);
  const Problem problem = random_problem(3, 2, 40, stream);
  EXPECT_GT(solve(problem, WindowSettings{1}, 100, stream).standard_error, 0.0);
}

TEST(HmmSelection, SaysWhereTheTreeIsTooLarge) {
  RandomStream stream(66);
  const Problem problem = random_problem(3, 3, 40, stream);
  EXPECT_THROW(solve(problem, OptimumSettings{}, 2, stream), std::length_error);
}

TEST(HmmSelection, AllViolationsAreListed) {
  Problem problem = sight_and_blind(0.0);
  EXPECT_THAT(validate(problem), IsEmpty());
  problem.transition(0, 0) = 0.5;
  problem.belief = Eigen::Vector2d(2.0, -1.0);
  problem.horizon = 0;
  problem.beta = 0.0;
  problem.sensors[0].emission(0, 0) = std::nan("");
  problem.sensors[1].cost = -1.0;
  std::vector<std::string> fields;
  for (const Violation& violation : validate(problem)) fields.push_back(violation.field);
  EXPECT_THAT(fields,
              UnorderedElementsAre("transition", "belief", "horizon", "beta", "sensor[1].emission", "sensor[2].cost"));
  EXPECT_EQ(validate(FixedSettings{3}, problem).front().rule, "must be from 1 to 2");
  EXPECT_EQ(validate(WindowSettings{0}, problem).front().field, "d");
}

}  // namespace
}  // namespace dwell::hmm_selection
