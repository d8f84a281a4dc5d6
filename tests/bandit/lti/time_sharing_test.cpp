#include "bandit/lti/time_sharing.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/bandit/lti/problems.hpp"
#include "tests/scale.hpp"

namespace dwell::lti {
namespace {

double bound_of(const Problem& problem) {
  Riccati riccati(problem);
  SearchTree tree(problem, riccati);
  const Level root = tree.root();
  TimeSharing sharing(tree, root[0], problem.horizon);
  return root[0].cost + sharing.bound(root[0], problem.horizon);
}

TEST(TimeSharing, IsBelowEverySchedule) {
  RandomStream stream(50);
  for (int run = 0; run < scaled(200); ++run) {
    Problem problem = random_variant(stream);
    problem.objective = Objective::kSum;
    EXPECT_LE(bound_of(problem), enumerated_minimum(problem).objective * (1.0 + 1e-10)) << run;
  }
}

// The shares are made for the root; they must do for any node below it too.
TEST(TimeSharing, IsBelowEveryScheduleFromEveryNode) {
  RandomStream stream(51);
  for (int run = 0; run < scaled(50); ++run) {
    Problem problem = random_variant(stream);
    problem.objective = Objective::kSum;
    Riccati riccati(problem);
    SearchTree tree(problem, riccati);
    const Level root = tree.root();
    TimeSharing sharing(tree, root[0], problem.horizon);
    const std::vector<std::vector<int>> schedules = all_schedules(problem);
    const auto& schedule =
        schedules[static_cast<std::size_t>(stream.uniform() * static_cast<double>(schedules.size()))];
    const double whole = textbook_cost(problem, schedule).objective;
    std::vector<double> covariance = riccati.initial();
    std::vector<std::uint16_t> looks(problem.sensors.size(), 0);
    double cost = root[0].cost;
    for (int k = 0; k < problem.horizon; ++k) {
      const int choice = schedule[static_cast<std::size_t>(k)];
      riccati.step(covariance.data(), choice, covariance.data());
      cost = tree.cost_after(cost, choice, covariance.data());
      if (choice > 0) ++looks[static_cast<std::size_t>(choice - 1)];
      const Node node{covariance.data(), cost, looks, 0, choice, 0};
      EXPECT_LE(cost + sharing.bound(node, problem.horizon - 1 - k), whole * (1.0 + 1e-10)) << run;
    }
  }
}

TEST(TimeSharing, IsExactForOneSensor) {
  RandomStream stream(52);
  const Problem problem = random_problem({3, 1, 8}, stream);
  const double cost = textbook_cost(problem, std::vector<int>(8, 1)).objective;
  EXPECT_NEAR(bound_of(problem), cost, 1e-10 * cost);
}

TEST(TimeSharing, KnowsBudgets) {
  Problem problem = alriksson(10.0, 12);
  problem.objective = Objective::kSum;
  const double free = bound_of(problem);
  problem.sensors[0].max_looks = 2;
  // By little: shared, a sixth of a look in every step tells nearly as much as whole looks.
  EXPECT_GT(bound_of(problem), 1.01 * free);
}

// Against all ways to take a row in each of five columns.
TEST(AssignmentBound, IsBelowTheCheapestAssignment) {
  RandomStream stream(53);
  for (int run = 0; run < scaled(200); ++run) {
    Eigen::MatrixXd cost(3, 5);
    for (double& entry : cost.reshaped()) entry = stream.normal();
    const std::vector<double> left{1.0 + run % 2, 2.0 + run % 3, run % 5 == 0 ? 2.0 : 1e9};
    double least = 1e300;
    double least_of_first = 1e300;  // with the first row's limit alone
    for (int code = 0; code < 243; ++code) {
      double sum = 0.0;
      double used[] = {0.0, 0.0, 0.0};
      for (int k = 0, rest = code; k < 5; ++k, rest /= 3) {
        sum += cost(rest % 3, k);
        used[rest % 3] += 1.0;
      }
      if (used[0] <= left[0]) least_of_first = std::min(least_of_first, sum);
      if (used[0] <= left[0] && used[1] <= left[1] && used[2] <= left[2]) least = std::min(least, sum);
    }
    EXPECT_LE(assignment_bound(cost, left), least + 1e-12);
    EXPECT_NEAR(assignment_bound(cost, {left[0], 1e9, 1e9}), least_of_first, 1e-12);
  }
}

}  // namespace
}  // namespace dwell::lti
