#include "bandit/fixed.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bandit/scene.hpp"

namespace dwell::testing {
namespace {

using ::testing::ElementsAre;

TEST(Fixed, OneSensorItsTracksInTurn) {
  Fixed policy(FixedSettings{2});
  Scene scene = plain_scene(3, {1, 2, 5});
  EXPECT_THAT(choices(policy, scene, 5),
              ElementsAre(Choice{2, 1}, Choice{2, 2}, Choice{2, 5}, Choice{2, 1}, Choice{2, 2}));
}

TEST(Fixed, OtherSensorsOnlyWhileItIsDown) {
  Fixed policy(FixedSettings{2});
  Scene scene = plain_scene(3, {1, 2, 3});
  EXPECT_THAT(choices(policy, scene, 1), ElementsAre(Choice{2, 1}));
  scene.up[1] = false;
  EXPECT_THAT(choices(policy, scene, 3), ElementsAre(Choice{1, 2}, Choice{1, 3}, Choice{1, 1}));
  scene.up[1] = true;
  EXPECT_THAT(choices(policy, scene, 2), ElementsAre(Choice{2, 2}, Choice{2, 3}));
}

TEST(Fixed, ATrackThatIsLostIsPassedOver) {
  Fixed policy(FixedSettings{1});
  Scene scene = plain_scene(2, {1, 2, 3});
  EXPECT_THAT(choices(policy, scene, 1), ElementsAre(Choice{1, 1}));
  scene.tracks[1].lose(LossCause::kNumerics);
  EXPECT_THAT(choices(policy, scene, 3), ElementsAre(Choice{1, 3}, Choice{1, 1}, Choice{1, 3}));
}

}  // namespace
}  // namespace dwell::testing
