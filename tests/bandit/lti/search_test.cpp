// Window, threshold, beam and optimum: what they must share with an enumeration of all schedules.

#include <algorithm>

#include <gmock/gmock.h>

#include "bandit/lti/catalogue.hpp"
#include "tests/bandit/lti/problems.hpp"
#include "tests/scale.hpp"

namespace dwell::lti {
namespace {

/// The textbook's form of the enumeration loses about 1e-13 of the largest covariance.
constexpr double kRounding = 1e-9;

class Systems : public ::testing::Test {
 protected:
  RandomStream stream_{20};
};

TEST_F(Systems, TheOptimumIsThatOfAnEnumeration) {
  for (int run = 0; run < scaled(300); ++run) {
    const Problem problem = random_variant(stream_);
    const double least = enumerated_minimum(problem).objective;
    const Solution best = optimum(problem);
    EXPECT_NEAR(best.cost, least, kRounding * least) << run;
    EXPECT_EQ(best.cost, evaluate(problem, best.schedule).cost);
  }
}

// 2^12 or 3^8 schedules: trees that are searched, not enumerated, by the bounds and orders of the optimum.
TEST_F(Systems, TheSearchOfALargeTreeIsThatOfAnEnumeration) {
  for (int run = 0; run < scaled(60); ++run) {
    const bool two = run % 2 == 0;
    Problem problem = random_problem({1 + run % 4, two ? 2 : 3, two ? 12 : 8}, stream_);
    if (run % 3 == 1) problem.covariance = CovarianceKind::kFiltered;
    if (run % 4 == 3) problem.objective = Objective::kFinal;
    if (run % 5 == 2) problem.communication_noise = 0.3;
    if (run % 7 >= 4) problem.sensors[0].max_looks = 2 + run % 3;
    if (run % 4 == 1) problem.sensors[1].cost = 0.3 * (problem.w.trace() + problem.initial.trace());
    const double least = enumerated_minimum(problem).objective;
    EXPECT_NEAR(optimum(problem).cost, least, kRounding * least) << run;
  }
}

TEST_F(Systems, AWindowOfTheHorizonIsTheOptimum) {
  for (int run = 0; run < scaled(60); ++run) {
    const Problem problem = random_variant(stream_);
    const Solution best = optimum(problem);
    for (const int d : {problem.horizon, problem.horizon + 3}) {
      const Solution wide = window(problem, {d});
      EXPECT_NEAR(wide.cost, best.cost, 1e-12 * best.cost);
    }
  }
}

TEST_F(Systems, AThresholdThatKeepsAllIsTheOptimum) {
  for (int run = 0; run < scaled(60); ++run) {
    const Problem problem = random_variant(stream_);
    const double least = optimum(problem).cost;
    EXPECT_NEAR(threshold(problem, {1e300}).cost, least, 1e-12 * least);
  }
}

TEST_F(Systems, ABeamThatKeepsAllIsTheOptimumAndNoneIsWorseThanMyopic) {
  for (int run = 0; run < scaled(60); ++run) {
    const Problem problem = random_variant(stream_);
    const double least = optimum(problem).cost;
    EXPECT_NEAR(beam(problem, {100'000}).cost, least, 1e-12 * least);
    const double greedy = window(problem, {}).cost;
    for (const int width : {1, 2, 5}) EXPECT_LE(beam(problem, {width}).cost, greedy * (1.0 + 1e-12));
  }
}

std::vector<PolicySettings> every_policy() {
  // A new policy is a new row here as well.
  static_assert(std::variant_size_v<PolicySettings> == 8);
  return {RoundRobinSettings{}, FixedSettings{1},
          RandomSettings{},     RandomSettings{RandomSettings::Probabilities::kUniform},
          WindowSettings{3},    ThresholdSettings{1.01},
          BeamSettings{10},     RelaxedDpSettings{1.1},
          OptimumSettings{}};
}

class EveryLtiPolicy : public ::testing::TestWithParam<PolicySettings> {
 protected:
  RandomStream stream_{21};
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryLtiPolicy, ::testing::ValuesIn(every_policy()));

/// One of all_schedules, without making them.
void expect_feasible(const Problem& problem, const std::vector<int>& schedule) {
  ASSERT_EQ(schedule.size(), static_cast<std::size_t>(problem.horizon));
  for (const int choice : schedule) {
    EXPECT_GE(choice, problem.allow_idle ? 0 : 1);
    EXPECT_LE(choice, problem.sensor_count());
  }
  for (int j = 1; j <= problem.sensor_count(); ++j) {
    const int limit = problem.sensors[static_cast<std::size_t>(j - 1)].max_looks;
    if (limit > 0) {
      EXPECT_LE(std::count(schedule.begin(), schedule.end(), j), limit);
    }
  }
}

TEST_P(EveryLtiPolicy, GivesAFeasibleScheduleAndItsTrueCost) {
  for (int run = 0; run < scaled(40); ++run) {
    const Problem problem = random_variant(stream_);
    const Solution solution = solve(problem, {GetParam()}, stream_);
    expect_feasible(problem, solution.schedule);
    const Cost cost = textbook_cost(problem, solution.schedule);
    EXPECT_NEAR(solution.cost, cost.objective, kRounding * cost.objective);
    EXPECT_NEAR(solution.final_trace, cost.final_trace, kRounding * cost.objective);
    EXPECT_GT(solution.expanded, 0U);
  }
}

TEST_P(EveryLtiPolicy, GivesTheSameTwice) {
  const Problem problem = random_variant(stream_);
  EXPECT_EQ(solve(problem, {GetParam()}, stream_).schedule, solve(problem, {GetParam()}, stream_).schedule);
}

TEST_P(EveryLtiPolicy, SolvesEightUnstableStatesAndSixSensors) {
  Problem problem = random_problem({8, 6, 7}, stream_);
  problem.a *= 1.3;
  problem.w.setZero();
  problem.w(2, 2) = 1.0;
  const Solution solution = solve(problem, {GetParam()}, stream_);
  expect_feasible(problem, solution.schedule);
  const Cost cost = textbook_cost(problem, solution.schedule);
  EXPECT_NEAR(solution.cost, cost.objective, kRounding * cost.objective);
}

TEST_P(EveryLtiPolicy, SpendsBudgetsThatJustLast) {
  Problem problem = random_problem({2, 3, 9}, stream_);
  for (Sensor& sensor : problem.sensors) sensor.max_looks = 3;
  expect_feasible(problem, solve(problem, {GetParam()}, stream_).schedule);
}

TEST_P(EveryLtiPolicy, SpreadsBudgetsThatJustLast) {
  Problem problem = random_problem({2, 3, 9}, stream_);
  for (Sensor& sensor : problem.sensors) sensor.max_looks = 3;
  const std::vector<int> schedule = solve(problem, {GetParam(), true}, stream_).schedule;
  expect_feasible(problem, schedule);
  // Three looks in nine steps are one in every three.
  for (int j = 1; j <= 3; ++j) {
    EXPECT_LE(std::count(schedule.begin(), schedule.begin() + 3, j), 1);
    EXPECT_LE(std::count(schedule.begin(), schedule.begin() + 6, j), 2);
  }
}

TEST_P(EveryLtiPolicy, AlwaysIdlesWhereAllLooksAreSpent) {
  Problem problem = random_problem({2, 1, 9}, stream_);
  problem.allow_idle = true;
  problem.sensors[0].max_looks = 2;
  const std::vector<int> schedule = solve(problem, {GetParam()}, stream_).schedule;
  expect_feasible(problem, schedule);
  EXPECT_GE(std::count(schedule.begin(), schedule.end(), 0), 7);
}

// Two sensors that are the same: every schedule costs the same.
TEST(LtiTies, GoToTheFirstSensor) {
  Problem problem = alriksson(1.0, 11);
  problem.objective = Objective::kSum;
  problem.sensors[1] = problem.sensors[0];
  const std::vector<int> first(11, 1);
  EXPECT_EQ(window(problem, {}).schedule, first);
  EXPECT_EQ(window(problem, {3}).schedule, first);
  EXPECT_EQ(threshold(problem, {1.0}).schedule, first);
  EXPECT_EQ(beam(problem, {3}).schedule, first);
  EXPECT_EQ(relaxed_dp(problem, {1.1}).schedule, first);
  EXPECT_EQ(optimum(problem).schedule, first);
}

TEST(LtiOptimum, TheSearchStaysSmall) {
  const Solution best = optimum(gupta());
  EXPECT_LT(best.expanded, 60'000U);  // of 21 million steps in all; 45 550 when it was written
}

// The trace at the end after fifty steps: what came long before is forgotten, and the search goes from the end.
TEST(LtiOptimum, TheFinalTraceOfALongHorizonIsFoundFromTheEnd) {
  EXPECT_LT(optimum(alriksson(110.0, 50)).expanded, 20'000U);
  EXPECT_LT(optimum(alriksson(110.0, 500)).expanded, 200'000U);
}

TEST(LtiSearchTree, SaysWhereTooManySchedulesRemain) {
  const Problem problem = gupta(8);
  Riccati riccati(problem);
  SearchTree tree(problem, riccati, 100'000);
  BeamPruning everything(1'000'000);
  EXPECT_NO_THROW(tree.grow(tree.root(), 5, everything));
  EXPECT_THROW(tree.grow(tree.root(), 8, everything), std::length_error);
}

TEST(LtiCatalogue, SettingsAreChecked) {
  const Problem problem = gupta();
  EXPECT_TRUE(validate(FixedSettings{3}, problem).empty());
  EXPECT_EQ(validate(FixedSettings{4}, problem).front().rule, "must be from 1 to 3");
  EXPECT_EQ(validate(FixedSettings{0}, problem).front().field, "sensor");
  EXPECT_EQ(validate(WindowSettings{0}, problem).front().field, "d");
  EXPECT_EQ(validate(ThresholdSettings{0.999}, problem).front().field, "f");
  EXPECT_EQ(validate(BeamSettings{-1}, problem).front().field, "width");
  EXPECT_EQ(validate(RelaxedDpSettings{std::numeric_limits<double>::quiet_NaN()}, problem).front().field, "alpha");
  for (const PolicySettings& settings : every_policy()) EXPECT_TRUE(validate(settings, problem).empty());
}

// A longer window is not always better: of 300 systems some show it, and more the other way.
TEST_F(Systems, ALongerWindowIsNotAlwaysBetter) {
  int worse = 0;
  int better = 0;
  for (int run = 0; run < 300; ++run) {
    const Problem problem = random_problem({3, 3, 8}, stream_);
    const double one = window(problem, {1}).cost;
    const double two = window(problem, {2}).cost;
    worse += two > one * (1.0 + 1e-9) ? 1 : 0;
    better += two < one * (1.0 - 1e-9) ? 1 : 0;
  }
  EXPECT_GT(worse, 0);
  EXPECT_GT(better, worse);
}

}  // namespace
}  // namespace dwell::lti
