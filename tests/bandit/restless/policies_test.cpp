#include "bandit/restless/policy.hpp"

#include <gtest/gtest.h>

#include "bandit/restless/bound.hpp"
#include "bandit/restless/simulate.hpp"
#include "tests/bandit/restless/instances.hpp"

namespace dwell::restless::testing {
namespace {

class Table {
 public:
  explicit Table(Problem problem) : problem_(std::move(problem)), analysis_(analyse(problem_)) {}

  double gap_percent(const PolicySettings& settings) const {
    const auto policy = make_policy(settings, problem_, analysis_.priced);
    return 100.0 * (simulate(problem_, *policy, {}).cost / analysis_.bound.value - 1.0);
  }

  const Priced& priced() const { return analysis_.priced; }

 private:
  Problem problem_;
  Analysis analysis_;
};

/// The prototypes' gaps to the exact bound, printed to .1 %: half of that, and as much again for the last digit of
/// their averages, over 20 000 scans of the start. Lookahead meets ties, which rounding breaks: S2a's of depth 2 has
/// moved by .1 between programs, and is given that.
TEST(RestlessPolicies, GapsOfTheScalarTable) {
  const Table s2a_table(s2a());
  EXPECT_NEAR(s2a_table.gap_percent(RoundRobinSettings{}), 21.2, 0.06);
  EXPECT_NEAR(s2a_table.gap_percent(LookaheadSettings{2}), 49.7, 0.2);
  EXPECT_NEAR(s2a_table.gap_percent(LookaheadSettings{3}), 29.2, 0.1);
  const Table s4a_table(s4a());
  EXPECT_NEAR(s4a_table.gap_percent(RoundRobinSettings{}), 1.5, 0.06);
  EXPECT_NEAR(s4a_table.gap_percent(MyopicSettings{}), 48.5, 0.1);
}

/// What is promised of the default: half a percent of the bound, which no policy is below.
TEST(RestlessPolicies, IndexOfDepthTwoIsWithinHalfAPercent) {
  for (const Problem& problem : {s2a(), s2b(), s4a(), s4b()}) {
    const double gap = Table(problem).gap_percent(IndexSettings{2});
    EXPECT_LE(gap, 0.5);
    EXPECT_GE(gap, -1e-6);
  }
}

/// Whatever the period of the looks: of s2b it does not divide the scans that count.
TEST(RestlessPolicies, NoneIsBelowTheExactBound) {
  for (const Problem& problem : {s2b(), s4b()}) {
    const Table table(problem);
    for (const PolicySettings& settings :
         {PolicySettings(RoundRobinSettings{}), PolicySettings(LargestVarianceSettings{}),
          PolicySettings(MyopicSettings{}), PolicySettings(LookaheadSettings{2}), PolicySettings(IndexSettings{1}),
          PolicySettings(WhittleSettings{})}) {
      EXPECT_GE(table.gap_percent(settings), -1e-6);
    }
  }
}

/// The rule of the best sensor costs what it costs without the other.
TEST(RestlessPolicies, WhittleLooksWithNoBlindSensor) {
  const Problem without = s2a();
  Problem with = without;
  for (Arm& arm : with.arms) arm.sensors.insert(arm.sensors.begin(), blind_sensor());
  const auto cost = [](const Problem& problem) {
    return simulate(problem, *make_policy(WhittleSettings{}, problem, {}), {}).cost;
  };
  EXPECT_DOUBLE_EQ(cost(with), cost(without));
}

TEST(RestlessPolicies, WhittleLeavesAloneWhatCostsNothing) {
  for (const double p_detect : {1.0, 0.8}) {
    Problem problem = s2a();
    for (Arm& arm : problem.arms) arm.sensors[0].p_detect = p_detect;
    problem.arms[1].weight = 0.0;
    SimulationSettings settings;
    settings.scans = 1000;
    const Simulated run = simulate(problem, *make_policy(WhittleSettings{}, problem, {}), settings);
    EXPECT_EQ(run.look_rate[1], 0.0) << "P_d " << p_detect;
  }
}

/// The same policy, run again, is the same policy.
TEST(RestlessPolicies, StartAgain) {
  const Problem problem = s2a();
  const auto policy = make_policy(RoundRobinSettings{}, problem, {});
  SimulationSettings settings;
  settings.warm_up = 0;
  settings.scans = 7;
  const double first = simulate(problem, *policy, settings).cost;
  EXPECT_EQ(simulate(problem, *policy, settings).cost, first);
}

/// Dwells of 2 and 1: no policy is below the bound, which charges each look its dwell, and looks take their share.
TEST(RestlessPolicies, UnequalDwellsShareTheCapacity) {
  Problem problem = s2a();
  problem.arms[0].dwell = 2.0;
  const Table table(problem);
  for (const PolicySettings& settings : {PolicySettings(IndexSettings{2}), PolicySettings(WhittleSettings{})}) {
    EXPECT_GE(table.gap_percent(settings), -1e-6);
    const auto policy = make_policy(settings, problem, table.priced());
    const Simulated run = simulate(problem, *policy, {});
    EXPECT_LE(2.0 * run.look_rate[0] + run.look_rate[1], 1.0 + 2.0 / 20'000);  // what the bucket held at first
  }
}

/// Depth 2 takes the next scan to have a look, which it has not after one of dwell 2.
TEST(RestlessPolicies, LongDwellsAreNotLookedAheadOver) {
  Problem problem = s2a();
  problem.arms[0].dwell = 2.0;
  const Priced priced = analyse(problem).priced;
  const auto shallow = make_policy(IndexSettings{1}, problem, priced);
  const auto deep = make_policy(IndexSettings{2}, problem, priced);
  EXPECT_EQ(simulate(problem, *deep, {}).cost, simulate(problem, *shallow, {}).cost);
}

/// Two looks a scan at two arms: each is looked at in every scan, whatever the policy.
TEST(RestlessPolicies, EveryArmIsLookedAtWhereLooksSuffice) {
  Problem problem = s2a();
  problem.looks_per_scan = 2;
  const Analysis analysis = analyse(problem);
  for (const PolicySettings& settings :
       {PolicySettings(MyopicSettings{}), PolicySettings(IndexSettings{2}), PolicySettings(RoundRobinSettings{})}) {
    const auto policy = make_policy(settings, problem, analysis.priced);
    const Simulated run = simulate(problem, *policy, {});
    EXPECT_DOUBLE_EQ(run.look_rate[0], 1.0);
    EXPECT_DOUBLE_EQ(run.look_rate[1], 1.0);
  }
}

/// Looks of dwell 2 with a capacity of 1: every second scan has one.
TEST(RestlessPolicies, LongDwellsWaitForTheBucket) {
  Problem problem = s2a();
  for (Arm& arm : problem.arms) arm.dwell = 2.0;
  const auto policy = make_policy(MyopicSettings{}, problem, {});
  const Simulated run = simulate(problem, *policy, {});
  EXPECT_DOUBLE_EQ(run.look_rate[0] + run.look_rate[1], 0.5);
}

}  // namespace
}  // namespace dwell::restless::testing
