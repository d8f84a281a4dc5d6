#include "bandit/round_robin.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bandit/scene.hpp"

namespace dwell::testing {
namespace {

using ::testing::ElementsAre;
using Order = RoundRobinSettings::Order;

RoundRobin in_order(Order order) { return RoundRobin(RoundRobinSettings{order}); }

// PAPERS, scenario 2: {sensor, track}, three of each, starting at sensor 1.

TEST(RoundRobin, RadarFastestIsRr9) {
  RoundRobin policy = in_order(Order::kRadarFastest);
  Scene scene = plain_scene(3, {1, 2, 3});
  EXPECT_THAT(choices(policy, scene, 11),
              ElementsAre(Choice{1, 1}, Choice{2, 1}, Choice{3, 1}, Choice{1, 2}, Choice{2, 2}, Choice{3, 2},
                          Choice{1, 3}, Choice{2, 3}, Choice{3, 3}, Choice{1, 1}, Choice{2, 1}));
}

TEST(RoundRobin, TrackFastestIsRr9t) {
  RoundRobin policy = in_order(Order::kTrackFastest);
  Scene scene = plain_scene(3, {1, 2, 3});
  EXPECT_THAT(choices(policy, scene, 11),
              ElementsAre(Choice{1, 1}, Choice{1, 2}, Choice{1, 3}, Choice{2, 1}, Choice{2, 2}, Choice{2, 3},
                          Choice{3, 1}, Choice{3, 2}, Choice{3, 3}, Choice{1, 1}, Choice{1, 2}));
}

TEST(RoundRobin, LockedIsRrlock) {
  RoundRobin policy = in_order(Order::kLocked);
  Scene scene = plain_scene(3, {1, 2, 3});
  EXPECT_THAT(choices(policy, scene, 5),
              ElementsAre(Choice{1, 1}, Choice{2, 2}, Choice{3, 3}, Choice{1, 1}, Choice{2, 2}));
}

TEST(RoundRobin, LockedWithMoreTracksThanRadarsMeetsEveryPair) {
  RoundRobin policy = in_order(Order::kLocked);
  Scene scene = plain_scene(2, {1, 2, 3});
  EXPECT_THAT(choices(policy, scene, 7), ElementsAre(Choice{1, 1}, Choice{2, 2}, Choice{1, 3}, Choice{2, 1},
                                                     Choice{1, 2}, Choice{2, 3}, Choice{1, 1}));
}

TEST(RoundRobin, PassesOverARadarThatIsDown) {
  Scene scene = plain_scene(3, {1, 2, 3});
  scene.up[1] = false;
  RoundRobin radar = in_order(Order::kRadarFastest);
  EXPECT_THAT(choices(radar, scene, 5),
              ElementsAre(Choice{1, 1}, Choice{3, 1}, Choice{1, 2}, Choice{3, 2}, Choice{1, 3}));
  RoundRobin track = in_order(Order::kTrackFastest);
  EXPECT_THAT(choices(track, scene, 7), ElementsAre(Choice{1, 1}, Choice{1, 2}, Choice{1, 3}, Choice{3, 1},
                                                    Choice{3, 2}, Choice{3, 3}, Choice{1, 1}));
  RoundRobin locked = in_order(Order::kLocked);
  EXPECT_THAT(choices(locked, scene, 5),
              ElementsAre(Choice{1, 1}, Choice{3, 2}, Choice{1, 3}, Choice{3, 1}, Choice{1, 2}));
}

TEST(RoundRobin, ARadarThatComesBackHasItsTurn) {
  RoundRobin policy = in_order(Order::kRadarFastest);
  Scene scene = plain_scene(3, {1, 2});
  scene.up[1] = false;
  EXPECT_THAT(choices(policy, scene, 2), ElementsAre(Choice{1, 1}, Choice{3, 1}));
  scene.up[1] = true;
  EXPECT_THAT(choices(policy, scene, 4), ElementsAre(Choice{1, 2}, Choice{2, 2}, Choice{3, 2}, Choice{1, 1}));
}

/// After {2, 1}: track 1 is lost, then removed; 3 is the next; 7 appears after it and before 2's turn comes
/// again.
TEST(RoundRobin, TracksThatComeAndGoDoNotMoveTheOthersTurns) {
  RoundRobin policy = in_order(Order::kRadarFastest);
  Scene scene = plain_scene(2, {1, 2, 3});
  EXPECT_THAT(choices(policy, scene, 2), ElementsAre(Choice{1, 1}, Choice{2, 1}));
  scene.tracks[1].lose(LossCause::kNoPlots);
  EXPECT_THAT(choices(policy, scene, 1), ElementsAre(Choice{1, 3}));
  scene.tracks.erase(scene.tracks.begin() + 1);
  scene.add_track(7, scene.tracks[0].estimate);
  EXPECT_THAT(choices(policy, scene, 5),
              ElementsAre(Choice{2, 3}, Choice{1, 7}, Choice{2, 7}, Choice{1, 1}, Choice{2, 1}));
}

TEST(RoundRobin, TheTrackOfTheLastLookMayBeGone) {
  for (const Order order : {Order::kRadarFastest, Order::kTrackFastest, Order::kLocked}) {
    RoundRobin policy = in_order(order);
    Scene scene = plain_scene(1, {1, 2, 3});
    EXPECT_THAT(choices(policy, scene, 3), ElementsAre(Choice{1, 1}, Choice{1, 2}, Choice{1, 3}));
    scene.tracks.pop_back();
    EXPECT_THAT(choices(policy, scene, 3), ElementsAre(Choice{1, 1}, Choice{1, 2}, Choice{1, 1}));
  }
}

TEST(RoundRobin, TheFirstTrackNeedNotBeNumberOne) {
  RoundRobin policy = in_order(Order::kTrackFastest);
  Scene scene = plain_scene(2, {4, 6});
  EXPECT_THAT(choices(policy, scene, 5),
              ElementsAre(Choice{1, 4}, Choice{1, 6}, Choice{2, 4}, Choice{2, 6}, Choice{1, 4}));
}

/// Two looks a scan, rrlock: both go on from the second.
TEST(RoundRobin, SeveralLooksStarveNoPair) {
  for (const Order order : {Order::kRadarFastest, Order::kTrackFastest, Order::kLocked}) {
    for (const int looks : {1, 2, 3}) {
      RoundRobin policy = in_order(order);
      Scene scene = plain_scene(3, {1, 2, 3});
      Decision decision;
      std::map<Choice, int> seen;
      std::map<int, int> of_sensor, of_track;
      for (int scan = 0; scan < 90; ++scan) {
        policy.decide(scene.situation(looks), decision);
        for (int look = 0; look < looks; ++look) {
          const Choice choice = choice_of(scene, decision, static_cast<std::size_t>(look));
          ++seen[choice];
          ++of_sensor[choice.first];
          ++of_track[choice.second];
        }
      }
      EXPECT_EQ(seen.size(), order == Order::kLocked ? 3 : 9) << looks << " looks";
      for (int number = 1; number <= 3; ++number) {
        EXPECT_EQ(of_sensor[number], 30 * looks) << "sensor " << number << ", " << looks << " looks";
        EXPECT_EQ(of_track[number], 30 * looks) << "track " << number << ", " << looks << " looks";
      }
    }
  }
}

/// The score is minus the turns until a pair is next.
TEST(RoundRobin, TheScoreCountsTurns) {
  RoundRobin policy = in_order(Order::kRadarFastest);
  Scene scene = plain_scene(2, {1, 2});
  Decision decision;
  policy.decide(scene.situation(), decision);
  policy.decide(scene.situation(),
                decision);  // {2, 1} is next, then {1, 2}, {2, 2}, {1, 1}
  std::vector<double> scores;
  for (const Candidate& candidate : decision.candidates) scores.push_back(candidate.score);
  EXPECT_THAT(scores, ElementsAre(-3.0, 0.0, -1.0, -2.0));
}

}  // namespace
}  // namespace dwell::testing
