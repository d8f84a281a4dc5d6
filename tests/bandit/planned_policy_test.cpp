// Window, optimum, threshold, beam and relaxed_dp against enumeration with Kalman's own steps.

#include "bandit/planned_policy.hpp"

#include <gtest/gtest.h>

#include "bandit/catalogue.hpp"
#include "tests/bandit/linear_plan.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

constexpr double kRounding = 1e-10;  // relative to the cost of the horizon: sums of a few dozen terms

Decision decide(const PolicySettings& settings, Scene& scene) {
  Decision decision;
  make_policy(settings)->decide(scene.situation(), decision);
  return decision;
}

/// Cost of the horizon without a look, less the score of a pair: what the policy takes the pair to cost.
double value(const LinearPlan& plan, const Candidate& candidate) { return plan.without_looks() - candidate.score; }

TEST(Window, EveryPairIsScoredByItsBestSchedule) {
  for (int seed = 0; seed < scaled(30); ++seed) {
    for (const int d : {1, 2, 3}) {
      Scene scene = linear_scene(2, 3, static_cast<std::uint64_t>(seed));
      scene.usage_cost = {0.3, 0.0};
      const LinearPlan plan(scene, d);
      for (const Candidate& candidate : decide(WindowSettings{d}, scene).candidates) {
        const double best = plan.best_from(candidate.pair);
        EXPECT_NEAR(value(plan, candidate), best, kRounding * plan.without_looks());
      }
    }
  }
}

/// Branch and bound: the pair that is chosen has the least cost of all, and its score says what that is.
TEST(Optimum, IsThatOfEnumeration) {
  for (int seed = 0; seed < scaled(60); ++seed) {
    const int tracks = 1 + seed % 3;
    const int horizon = 1 + seed % 4;
    Scene scene = linear_scene(2, tracks, static_cast<std::uint64_t>(seed));
    if (seed % 2 == 0) scene.usage_cost = {0.0, 0.5};
    const LinearPlan plan(scene, horizon);
    const Decision decision = decide(OptimumSettings{horizon}, scene);
    double best = std::numeric_limits<double>::infinity();
    for (const Pair& pair : scene.feasible) best = std::min(best, plan.best_from(pair));
    const Candidate& chosen = decision.candidates[decision.chosen[0]];
    EXPECT_FALSE(decision.fell_back);
    EXPECT_NEAR(value(plan, chosen), best, kRounding * plan.without_looks());
    EXPECT_NEAR(plan.best_from(chosen.pair), best, kRounding * plan.without_looks());
  }
}

/// A window of many pairs is no longer enumerated: the same answer as the optimum's.
TEST(Optimum, IsTheWindowOfItsHorizonOnRadarTracks) {
  for (int seed = 0; seed < scaled(20); ++seed) {
    Scene scene = random_scene(4, static_cast<std::uint64_t>(seed));
    const Decision window = decide(WindowSettings{3}, scene);
    const Decision optimum = decide(OptimumSettings{3}, scene);
    EXPECT_EQ(window.chosen, optimum.chosen);
    EXPECT_DOUBLE_EQ(window.candidates[window.chosen[0]].score, optimum.candidates[optimum.chosen[0]].score);
  }
}

/// A sensor with one look in ten scans; the other is poor. Also that every score counts the budget.
TEST(Window, PlansWithinTheBudgets) {
  for (int seed = 0; seed < scaled(30); ++seed) {
    Scene scene = linear_scene(2, 2, static_cast<std::uint64_t>(seed));
    const auto spread = seed % 2 == 0 ? BudgetSettings::Spread::kFree : BudgetSettings::Spread::kEven;
    scene.budgets[0] = LookBudget({1 + seed % 2, 10, BudgetSettings::Span::kWindow, spread});
    scene.budgets[0].next_scan();
    const LinearPlan plan(scene, 3);
    const auto allowed = [&](int scan, std::size_t sensor, const std::vector<int>& looks) {
      LookBudget::Plan taken = 0;
      for (std::size_t k = 0; k < looks.size(); ++k) {
        if (looks[k] == static_cast<int>(sensor)) taken = static_cast<LookBudget::Plan>(taken | (1U << k));
      }
      return scene.budgets[sensor].allows(scan, taken);
    };
    for (const PolicySettings& settings : {PolicySettings(WindowSettings{3}), PolicySettings(OptimumSettings{3})}) {
      const Decision decision = decide(settings, scene);
      double best = std::numeric_limits<double>::infinity();
      for (const Pair& pair : scene.feasible) best = std::min(best, plan.best_from(pair, allowed));
      EXPECT_NEAR(value(plan, decision.candidates[decision.chosen[0]]), best, kRounding * plan.without_looks());
    }
  }
}

/// Wide enough, a beam and a threshold hold every schedule; as narrow as can be, they are the one-step rule.
TEST(BeamAndThreshold, GoFromTheOneStepRuleToTheOptimum) {
  for (int seed = 0; seed < scaled(20); ++seed) {
    Scene scene = linear_scene(2, 2, static_cast<std::uint64_t>(seed));
    const Decision optimum = decide(OptimumSettings{4}, scene);
    const double best = optimum.candidates[optimum.chosen[0]].score;
    const LinearPlan plan(scene, 4);
    const double slack = kRounding * plan.without_looks();
    for (const PolicySettings& wide :
         {PolicySettings(BeamSettings{10'000, 4}), PolicySettings(ThresholdSettings{1e6, 4})}) {
      const Decision decision = decide(wide, scene);
      EXPECT_EQ(decision.chosen, optimum.chosen);
      EXPECT_NEAR(decision.candidates[decision.chosen[0]].score, best, slack);
    }
    for (const PolicySettings& narrow :
         {PolicySettings(BeamSettings{1, 4}), PolicySettings(ThresholdSettings{1.0, 4})}) {
      const Decision decision = decide(narrow, scene);
      EXPECT_LE(decision.candidates[decision.chosen[0]].score, best + slack);
    }
    EXPECT_EQ(decide(BeamSettings{1, 1}, scene).chosen, decide(WindowSettings{1}, scene).chosen);
    EXPECT_EQ(decide(ThresholdSettings{1.0, 1}, scene).chosen, decide(WindowSettings{1}, scene).chosen);
  }
}

/// With alpha = 1 nothing is given away; with more the cost of the horizon stays within alpha^2 of the least.
TEST(RelaxedDp, KeepsItsGuarantee) {
  for (int seed = 0; seed < scaled(40); ++seed) {
    Scene scene = linear_scene(2, 1 + seed % 2, static_cast<std::uint64_t>(seed));
    if (seed % 4 >= 2) scene.usage_cost = {0.0, 0.5};
    const LinearPlan plan(scene, 4);
    double least = std::numeric_limits<double>::infinity();
    for (const Pair& pair : scene.feasible) least = std::min(least, plan.best_from(pair));
    for (const double alpha : {1.0, 1.01, 1.1, 1.5}) {
      const Decision decision = decide(RelaxedDpSettings{alpha, 4}, scene);
      const double cost = value(plan, decision.candidates[decision.chosen[0]]);
      EXPECT_GE(cost, least * (1.0 - kRounding));
      EXPECT_LE(cost, alpha * alpha * least * (1.0 + 1e-8));
    }
  }
}

/// 40 tracks and three radars: 120 pairs, 2e8 schedules of four scans, none of which rules out many others.
TEST(PlannedPolicy, ASearchThatOutgrowsItsMemorySaysThatItFellBack) {
  Scene scene = random_scene(40, 1);
  const Decision decision = decide(ThresholdSettings{1e9, 4}, scene);
  EXPECT_TRUE(decision.fell_back);
  EXPECT_EQ(decision.chosen.size(), 1U);
  EXPECT_FALSE(decide(BeamSettings{}, scene).fell_back);
}

}  // namespace
}  // namespace dwell::testing
