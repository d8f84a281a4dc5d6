// What holds for every policy of the catalogue.

#include "bandit/policy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "bandit/catalogue.hpp"
#include "bandit/round_robin.hpp"
#include "bandit/value_table.hpp"
#include "tests/allocations.hpp"
#include "tests/bandit/scene.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

struct NamedPolicy {
  std::string name;
  PolicySettings settings;
};

std::vector<NamedPolicy> all_policies() {
  // A new policy is a new row here as well.
  static_assert(std::variant_size_v<PolicySettings> == 15);
  SaImmSettings with_modes;
  with_modes.cost = SaImmSettings::Cost::kFull;
  with_modes.beta = 10.0;
  SaImmSettings modes_alone;
  modes_alone.cost = SaImmSettings::Cost::kNone;
  modes_alone.beta = 1.0;
  return {{"sa_imm", SaImmSettings{}},
          {"sa_imm_full_and_modes", with_modes},
          {"sa_imm_modes_alone", modes_alone},
          {"round_robin", RoundRobinSettings{}},
          {"round_robin_track_fastest", RoundRobinSettings{RoundRobinSettings::Order::kTrackFastest}},
          {"round_robin_locked", RoundRobinSettings{RoundRobinSettings::Order::kLocked}},
          {"fixed", FixedSettings{2}},
          {"largest_variance", LargestVarianceSettings{}},
          {"bhattacharyya", BhattacharyyaSettings{}},
          {"random", RandomSettings{}},
          {"random_uniform", RandomSettings{RandomSettings::Probabilities::kUniform}},
          {"window", WindowSettings{}},
          {"window_of_two", WindowSettings{2}},
          {"threshold", ThresholdSettings{}},
          {"threshold_of_a_tenth", ThresholdSettings{1.1, 2}},
          {"relaxed_dp", RelaxedDpSettings{1.1, 2}},
          {"beam", BeamSettings{}},
          {"optimum", OptimumSettings{3}},
          {"lookahead", LookAheadSettings{}},
          {"orbit", OrbitSettings{}},
          {"index", IndexSettings{}},
          {"index_of_depth_one", IndexSettings{1}},
          {"gittins_hmm", GittinsHmmSettings{}}};
}

class EveryPolicy : public ::testing::TestWithParam<NamedPolicy> {
 protected:
  std::unique_ptr<Policy> policy_ = make_policy(GetParam().settings);
  Decision decision_;
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryPolicy, ::testing::ValuesIn(all_policies()),
                         [](const auto& test) { return test.param.name; });

bool free_of(const Decision& decision, std::size_t looks, const Pair& pair) {
  for (std::size_t i = 0; i < looks; ++i) {
    if (decision.pair(i).sensor == pair.sensor || decision.pair(i).track == pair.track) return false;
  }
  return true;
}

/// Of all sets of so many looks that hold those chosen, by enumeration.
double greatest_total(const Decision& decision, const std::vector<std::size_t>& chosen, std::size_t looks) {
  double total = 0.0;
  for (const std::size_t c : chosen) total += decision.candidates[c].score;
  if (chosen.size() == looks) return total;
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t i = chosen.empty() ? 0 : chosen.back() + 1; i < decision.candidates.size(); ++i) {
    const auto shares = [&](std::size_t c) {
      const Pair& other = decision.candidates[c].pair;
      return other.sensor == decision.candidates[i].pair.sensor || other.track == decision.candidates[i].pair.track;
    };
    if (std::ranges::any_of(chosen, shares)) continue;
    std::vector<std::size_t> more = chosen;
    more.push_back(i);
    best = std::max(best, greatest_total(decision, more, looks));
  }
  return best;
}

/// Scores that are gains in cost.
bool scores_add_up(std::string_view policy) { return policy == "sa_imm" || policy == "index"; }

/// The rule that all policies share, said again: each look takes the first of the best among what is free; where scores
/// add up their total is the greatest.
void expect_choice_follows_scores(std::string_view policy, const Situation& situation, const Decision& decision) {
  const auto& candidates = decision.candidates;
  ASSERT_EQ(candidates.size(), situation.feasible.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    EXPECT_EQ(candidates[i].pair.sensor, situation.feasible[i].sensor);
    EXPECT_EQ(candidates[i].pair.track, situation.feasible[i].track);
    EXPECT_TRUE(std::isfinite(candidates[i].score));
  }
  if (scores_add_up(policy)) {
    double total = 0.0;
    for (const std::size_t c : decision.chosen) total += candidates[c].score;
    EXPECT_NEAR(total, greatest_total(decision, {}, decision.chosen.size()), 1e-9 * std::abs(total));
  }
  for (std::size_t look = 0; look < static_cast<std::size_t>(situation.looks) && !scores_add_up(policy); ++look) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (!free_of(decision, std::min(look, decision.chosen.size()), candidates[i].pair)) continue;
      if (!best || candidates[i].score > candidates[*best].score) best = i;
    }
    ASSERT_EQ(best.has_value(), look < decision.chosen.size());
    if (best) {
      EXPECT_EQ(decision.chosen[look], *best);
    }
  }
  std::vector<double> left;  // not chosen
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (std::ranges::count(decision.chosen, i) == 0) left.push_back(candidates[i].score);
  }
  EXPECT_EQ(decision.margin.has_value(), !left.empty());
  if (decision.margin) {
    EXPECT_EQ(*decision.margin, candidates[decision.chosen[0]].score - *std::ranges::max_element(left));
  }
}

TEST_P(EveryPolicy, ScoresEveryCandidateAndTakesTheBest) {
  for (int seed = 0; seed < scaled(100); ++seed) {
    Scene scene = random_scene(1 + seed % 5, static_cast<std::uint64_t>(seed));
    const Situation situation = scene.situation();
    policy_->decide(situation, decision_);
    expect_choice_follows_scores(policy_->name(), situation, decision_);
    // The first decisions of `index` wait for their value sets.
    EXPECT_EQ(decision_.fell_back && policy_->name() != "index", false);
  }
}

TEST_P(EveryPolicy, SeveralLooksTakeDistinctSensorsAndTracks) {
  for (int seed = 0; seed < scaled(50); ++seed) {
    for (const int tracks : {1, 2, 4}) {
      for (const int looks : {2, 3, 7}) {
        Scene scene = random_scene(tracks, static_cast<std::uint64_t>(seed));
        const Situation situation = scene.situation(looks);
        policy_->decide(situation, decision_);
        EXPECT_EQ(std::ssize(decision_.chosen), std::min({looks, tracks, 3}));
        expect_choice_follows_scores(policy_->name(), situation, decision_);
      }
    }
  }
}

/// What is owed comes first, with its best score; the rest as ever.
TEST_P(EveryPolicy, WhatIsOwedALookComesFirst) {
  for (int seed = 0; seed < scaled(50); ++seed) {
    Scene scene = random_scene(4, static_cast<std::uint64_t>(seed));
    Situation situation = scene.situation(2);
    const std::vector<Owed> owed{{{}, static_cast<std::size_t>(seed % 4)}, {static_cast<std::size_t>(seed % 3), {}}};
    situation.owed = owed;
    policy_->decide(situation, decision_);
    const auto& candidates = decision_.candidates;
    const auto best_of_owed = [&](std::size_t look) {
      const double score = candidates[decision_.chosen[look]].score;
      return std::ranges::all_of(candidates, [&](const Candidate& other) {
        return !owed[look].matches(other.pair) || !free_of(decision_, look, other.pair) || other.score <= score;
      });
    };
    ASSERT_EQ(decision_.chosen.size(), 2U);
    EXPECT_EQ(decision_.pair(0).track, *owed[0].track);
    EXPECT_TRUE(best_of_owed(0));
    EXPECT_EQ(decision_.owed,
              *decision_.margin < 0 || candidates[decision_.chosen[1]].score > candidates[decision_.chosen[0]].score);
    if (decision_.pair(0).sensor == *owed[1].sensor) continue;  // has its look
    EXPECT_EQ(decision_.pair(1).sensor, *owed[1].sensor);
    EXPECT_TRUE(best_of_owed(1));
  }
}

/// A turn that an owed look takes before its time is not skipped.
TEST(RoundRobinPolicy, OwedLooksDoNotMoveTheTurn) {
  Scene scene = plain_scene(3, {1, 2, 3});
  const Situation plain = scene.situation();
  const std::vector<Owed> last_track{{{}, 2}};
  Situation owing = plain;
  owing.owed = last_track;
  RoundRobin calm{{}};
  RoundRobin interrupted{{}};
  Decision turn;
  Decision decision;
  for (int scan = 0; scan < 9; ++scan) {
    calm.decide(plain, turn);
    if (turn.pair(0).track != 2) {
      interrupted.decide(owing, decision);
      EXPECT_EQ(decision.pair(0).track, 2U);
      EXPECT_TRUE(decision.owed);
    }
    interrupted.decide(plain, decision);
    EXPECT_EQ(decision.chosen, turn.chosen) << scan;
  }
}

/// Twins of everything: whatever the policy, a tie goes to the candidate that comes first.
TEST_P(EveryPolicy, TiesGoToTheFirst) {
  Scene scene = plain_scene(3, {1, 2, 3});
  const Situation situation = scene.situation();
  policy_->decide(situation, decision_);
  expect_choice_follows_scores(policy_->name(), situation, decision_);
}

TEST_P(EveryPolicy, NothingFeasibleIsNothingChosen) {
  Scene scene = random_scene(3, 1);
  policy_->decide(scene.situation(), decision_);
  scene.up = {false, false, false};
  policy_->decide(scene.situation(), decision_);
  EXPECT_TRUE(decision_.candidates.empty());
  EXPECT_TRUE(decision_.chosen.empty());
  EXPECT_FALSE(decision_.margin);
  EXPECT_FALSE(decision_.fell_back);
  scene.up = {true, true, true};
  scene.tracks.clear();
  policy_->decide(scene.situation(), decision_);
  EXPECT_TRUE(decision_.chosen.empty());
}

TEST_P(EveryPolicy, OneCandidateIsTakenWithoutMargin) {
  Scene scene = random_scene(1, 1);
  scene.up = {false, false, true};
  policy_->decide(scene.situation(), decision_);
  ASSERT_EQ(decision_.chosen, std::vector<std::size_t>{0});
  EXPECT_EQ(decision_.pair(0).sensor, 2U);
  EXPECT_FALSE(decision_.margin);
}

/// A radar goes down and comes up, a track is lost in mid-cycle, another appears: only what is feasible is
/// chosen, and every choice follows its scores.
TEST_P(EveryPolicy, RadarsAndTracksComeAndGo) {
  Scene scene = random_scene(4, 3);
  for (int scan = 0; scan < 60; ++scan) {
    if (scan == 10) scene.up[1] = false;
    if (scan == 20) scene.tracks[2].lose(LossCause::kNoPlots);
    if (scan == 30) scene.up[1] = true;
    if (scan == 40) scene.tracks.erase(scene.tracks.begin());
    if (scan == 50) scene.add_track(9, scene.tracks[0].estimate);
    const Situation situation = scene.situation(1 + scan % 3);
    policy_->decide(situation, decision_);
    expect_choice_follows_scores(policy_->name(), situation, decision_);
    for (std::size_t look = 0; look < decision_.chosen.size(); ++look) {
      EXPECT_TRUE(scene.up[decision_.pair(look).sensor]);
      EXPECT_TRUE(scene.tracks[decision_.pair(look).track].alive());
    }
    scene.move_on(decision_);
  }
}

TEST_P(EveryPolicy, SameSituationsSameDecisions) {
  const auto twin = make_policy(GetParam().settings);
  Scene scene = random_scene(5, 4);
  Decision other;
  for (int scan = 0; scan < 50; ++scan) {
    policy_->decide(scene.situation(2), decision_);
    twin->decide(scene.situation(2), other);
    ASSERT_EQ(decision_.chosen, other.chosen);
    EXPECT_EQ(decision_.margin, other.margin);
    for (std::size_t i = 0; i < decision_.candidates.size(); ++i) {
      EXPECT_EQ(decision_.candidates[i].score, other.candidates[i].score);
    }
    scene.move_on(decision_);
  }
}

/// Once its stores have grown: after the first decision; where a search takes more or less of them from scan to scan,
/// after the like of it; and where value sets are asked for, once the price has settled.
TEST_P(EveryPolicy, AllocatesNothingOnceItsStoresHaveGrown) {
  const std::string& name = GetParam().name;
  const bool prices = name.rfind("index", 0) == 0;
  const bool searches = name == "optimum" || name.rfind("threshold", 0) == 0 || name == "relaxed_dp";
  ValueTable table(ValueTable::OnDue::kGoOn);  // built outside of the decisions, as in a run in real time
  const auto decide = [&](Scene& scene) {
    Situation situation = scene.situation(3);
    situation.value_table = &table;
    const long before = allocations();
    policy_->decide(situation, decision_);
    return allocations() - before;
  };
  const auto build_asked = [&] {
    while (table.waiting() > 0) table.build_next();
  };
  Scene alike = random_scene(6, 5);
  for (int scan = 0; scan < (searches || prices ? 20 : 1); ++scan) {
    decide(alike);
    build_asked();
    alike.move_on(decision_);
  }
  Scene scene = random_scene(6, 5);
  for (int scan = 0; scan < 20; ++scan) {
    EXPECT_EQ(decide(scene), 0);
    build_asked();
    scene.move_on(decision_);
  }
}

TEST(Allocations, CountsNewAndEigen) {
  const long before = allocations();
  const Eigen::VectorXd on_the_heap = Eigen::VectorXd::Ones(100);
  const auto owned = std::make_unique<double>(on_the_heap.sum());
  EXPECT_EQ(allocations() - before, 2);
  EXPECT_EQ(*owned, 100.0);
}

TEST_P(EveryPolicy, HasTheNameOfTheCatalogue) { EXPECT_EQ(GetParam().name.find(policy_->name()), 0U); }

}  // namespace
}  // namespace dwell::testing
