#include "bandit/sa_imm.hpp"

#include <gtest/gtest.h>

#include "tests/bandit/expected_cost_oracle.hpp"
#include "tests/bandit/scene.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

SaImmSettings settings(SaImmSettings::Cost cost, double beta, int nodes) {
  SaImmSettings made;
  made.cost = cost;
  made.beta = beta;
  made.nodes = nodes;
  return made;
}

/// The whole cost after a look, over all tracks, by the oracle.
double total_after(const CostKind& kind, const Scene& scene, const Pair& pair) {
  double total = scene.usage_cost[pair.sensor];
  for (std::size_t t = 0; t < scene.tracks.size(); ++t) {
    const Track& track = scene.tracks[t];
    const PredictedState state{"", track.estimate, scene.owned[pair.sensor], scene.update};
    const CostParts parts = t == pair.track ? oracle_parts(state) : cost_parts(track.estimate);
    total += track.weight * kind.of(parts);
  }
  return total;
}

/// The choice is that of enumeration, up to twice the rule's error on the tracks concerned.
TEST(SaImm, ChoosesWhatEnumerationOfTheTotalCostSays) {
  const struct {
    CostKind kind;
    SaImmSettings::Cost cost;
  } cases[] = {{kCostKinds[0], SaImmSettings::Cost::kPosition},
               {kCostKinds[3], SaImmSettings::Cost::kFull},
               {kCostKinds[4], SaImmSettings::Cost::kNone}};
  int same = 0;
  int all = 0;
  for (const auto& [kind, cost] : cases) {
    SaImm policy(settings(cost, kind.beta, 10));
    Decision decision;
    for (int seed = 0; seed < scaled(50); ++seed) {
      Scene scene = random_scene(3, static_cast<std::uint64_t>(seed));
      const double price = 0.01 * kind.of(cost_parts(scene.tracks[0].estimate));
      for (std::size_t s = 0; s < 3; ++s) scene.usage_cost[s] = price * static_cast<double>(s);
      const Situation situation = scene.situation();
      policy.decide(situation, decision);
      const Pair chosen = decision.pair(0);
      const double ours = total_after(kind, scene, chosen);
      Pair best = chosen;
      for (const Pair& pair : situation.feasible) {
        if (total_after(kind, scene, pair) < total_after(kind, scene, best)) best = pair;
      }
      const auto error = [&, &kind = kind](const Pair& pair) {
        const Track& track = scene.tracks[pair.track];
        return 0.005 * track.weight * kind.of(cost_parts(track.estimate));
      };
      EXPECT_LE(ours, total_after(kind, scene, best) + error(chosen) + error(best)) << kind.name << ", " << seed;
      same += best.sensor == chosen.sensor && best.track == chosen.track ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GE(same, 0.98 * all);  // 0.5 % of error rarely decides
}

/// One mode, P = I on x and y, R = I: 2 before, 1 after.
TEST(SaImm, TheScoreIsTheGainInWeightedCostLessTheUse) {
  SaImm policy{SaImmSettings{}};
  Scene scene = plain_scene(2, {1});
  scene.tracks[0].weight = 5.0;
  scene.usage_cost = {0.0, 7.0};
  Decision decision;
  policy.decide(scene.situation(), decision);
  EXPECT_NEAR(decision.candidates[0].score, 5.0, 1e-14);
  EXPECT_NEAR(decision.candidates[1].score, 5.0 - 7.0, 1e-14);
  for (const Candidate& candidate : decision.candidates) {
    EXPECT_NEAR(candidate.cost_without_look.value(), 10.0, 1e-14);
    EXPECT_NEAR(candidate.expected_cost.value(), 5.0, 1e-14);
  }
  EXPECT_NEAR(decision.margin.value(), 7.0, 1e-14);
}

TEST(SaImm, ALookIsMadeEvenAtALoss) {
  SaImm policy{SaImmSettings{}};
  Scene scene = plain_scene(2, {1});
  scene.usage_cost = {9.0, 8.0};
  Decision decision;
  policy.decide(scene.situation(), decision);
  EXPECT_EQ(choice_of(scene, decision), Choice(2, 1));
  EXPECT_NEAR(decision.candidates[1].score, 1.0 - 8.0, 1e-14);
}

/// What each cost counts: P = diag(4, 1, 16, 1), R = I. x: 4 - .8; y: 16 - 16/17; velocities are not
/// correlated.
TEST(SaImm, TheCostSelectsTheTrace) {
  using Cost = SaImmSettings::Cost;
  const double x = 4.0 - 0.8;
  const double y = 16.0 - 16.0 / 17.0;
  for (const auto& [cost, without, gain] : {std::tuple{Cost::kPosition, 20.0, x + y},
                                            {Cost::kXOnly, 4.0, x},
                                            {Cost::kFull, 22.0, x + y},
                                            {Cost::kNone, 0.0, 0.0}}) {
    SaImm policy(settings(cost, 0.0, 5));
    Scene scene = plain_scene(1, {1});
    scene.tracks[0].estimate.modes[0].covariance = State(4.0, 1.0, 16.0, 1.0).asDiagonal();
    Decision decision;
    policy.decide(scene.situation(), decision);
    EXPECT_DOUBLE_EQ(decision.candidates[0].cost_without_look.value(), without);
    EXPECT_NEAR(decision.candidates[0].score, gain, 1e-13);
  }
}

/// The second sensor measures velocity, and the first track's velocity variance is spoilt: that pair fails
/// alone.
TEST(SaImm, APairThatFailsIsOfNoUseAndTheOthersAreAsBefore) {
  SaImm policy{SaImmSettings{}};
  Scene scene = plain_scene(1, {1, 2});
  const MeasurementJacobian velocity = (MeasurementJacobian() << 0, 1, 0, 0, 0, 0, 0, 1).finished();
  scene.add_sensor(std::make_shared<LinearSensor>(velocity, Matrix2::Identity(), 1.0));
  Decision before;
  policy.decide(scene.situation(), before);
  scene.tracks[0].estimate.modes[0].covariance(kVx, kVx) = -7.0;
  Decision after;
  policy.decide(scene.situation(), after);
  EXPECT_EQ(after.candidates[1].score, 0.0);
  EXPECT_EQ(after.candidates[1].expected_cost, after.candidates[1].cost_without_look);
  for (const std::size_t other : {0U, 2U, 3U}) EXPECT_EQ(after.candidates[other].score, before.candidates[other].score);
}

}  // namespace
}  // namespace dwell::testing
