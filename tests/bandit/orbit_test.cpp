#include "bandit/orbit.hpp"

#include <gtest/gtest.h>

#include "bandit/restless/orbit_index.hpp"
#include "tests/bandit/linear_plan.hpp"
#include "tests/bandit/restless_arm.hpp"

namespace dwell::testing {
namespace {

/// Where a track has one mode and its sensors are linear nothing is approximated: the index of the restless arm, which
/// shares no code with ours. Both add 2 x 150 terms of one sign: rounding of 1e-12 of the sums, divided by .05.
TEST(Orbit, OfALinearTrackIsTheIndexOfTheRestlessArm) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scene scene = linear_scene(3, 2, seed);
    const Situation situation = scene.situation();
    OrbitIndex orbit(OrbitSettings{});
    for (std::size_t track = 0; track < scene.tracks.size(); ++track) {
      const restless::Arm arm = arm_of(scene, scene.tracks[track]);
      orbit.start(situation, track);
      for (std::size_t s = 0; s < scene.sensors.size(); ++s) {
        const double expected = restless::orbit_index(arm, s, arm.p0);
        EXPECT_NEAR(orbit.index(s), expected, 1e-8 * std::abs(expected)) << seed;
      }
    }
  }
}

TEST(Orbit, ScalesWithTheWeightAndIsLoweredByTheUseOfTheSensor) {
  Scene scene = linear_scene(1, 1, 3);
  OrbitIndex orbit(OrbitSettings{});
  orbit.start(scene.situation(), 0);
  const double plain = orbit.index(0);
  scene.tracks[0].weight *= 4.0;
  orbit.start(scene.situation(), 0);
  EXPECT_NEAR(orbit.index(0), 4.0 * plain, 1e-9 * plain);
  scene.usage_cost[0] = 0.1 * plain;
  orbit.start(scene.situation(), 0);
  EXPECT_LT(orbit.index(0), 4.0 * plain);
}

}  // namespace
}  // namespace dwell::testing
