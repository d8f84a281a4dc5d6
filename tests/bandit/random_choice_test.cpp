#include "bandit/random_choice.hpp"

#include <numeric>

#include <gtest/gtest.h>

#include "tests/bandit/linear_plan.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"

namespace dwell::testing {
namespace {

constexpr RandomSettings kUniform{RandomSettings::Probabilities::kUniform};

/// How often each pair is chosen first over `scans` scans of an unchanging scene.
std::vector<double> frequencies(RandomChoice& policy, Scene& scene, int scans) {
  std::vector<double> counts(scene.situation().feasible.size(), 0.0);
  Decision decision;
  for (int i = 0; i < scans; ++i) {
    ++scene.scans;
    policy.decide(scene.situation(), decision);
    counts[decision.chosen[0]] += 1.0;
  }
  return counts;
}

void expect_drawn_from(const std::vector<double>& counts, std::vector<double> q) {
  const double scans = std::accumulate(counts.begin(), counts.end(), 0.0);
  for (double& share : q) share *= scans;
  const double degrees = static_cast<double>(q.size() - 1);
  EXPECT_LT(statistics::pearson(counts, q), statistics::chi_square_band(degrees).high);
}

TEST(RandomChoice, UniformGivesEveryPairTheSameShare) {
  Scene scene = random_scene(2, 1);
  RandomChoice policy(kUniform);
  expect_drawn_from(frequencies(policy, scene, scaled(6000)), std::vector<double>(6, 1.0 / 6.0));
}

TEST(RandomChoice, DrawsWithTheProbabilitiesThatItSays) {
  Scene scene = linear_scene(3, 1, 2);
  RandomChoice policy{RandomSettings{}};
  Decision decision;
  for (int i = 0; i < 20; ++i) policy.decide(scene.situation(), decision);  // the descent comes to rest
  const std::vector<double> q(policy.probabilities().begin(), policy.probabilities().end());
  EXPECT_NEAR(std::accumulate(q.begin(), q.end(), 0.0), 1.0, 1e-12);
  expect_drawn_from(frequencies(policy, scene, scaled(6000)), q);
}

/// Two looks of a scan: the second in proportion among the pairs of other sensors and tracks.
TEST(RandomChoice, TheSecondLookIsDrawnFromWhatIsLeft) {
  Scene scene = plain_scene(3, {1, 2});
  RandomChoice policy(kUniform);
  Decision decision;
  std::vector<double> counts(2, 0.0);
  for (int i = 0; i < scaled(4000); ++i) {
    ++scene.scans;
    policy.decide(scene.situation(2), decision);
    ASSERT_EQ(decision.chosen.size(), 2U);
    // Two other sensors are left for the other track: the lower or the higher of them.
    const std::size_t first = decision.pair(0).sensor;
    const std::size_t lower = first == 0 ? 1 : 0;
    ++counts[decision.pair(1).sensor == lower ? 0 : 1];
  }
  expect_drawn_from(counts, {0.5, 0.5});
}

/// The bound at rest against a grid over the simplex of two pairs: no worse than 2 %, of which the even hundredth of
/// the probability is the larger part.
TEST(RandomChoice, OptimisedIsNearTheLeastBoundOfAGrid) {
  for (int seed = 0; seed < scaled(20); ++seed) {
    Scene scene = linear_scene(seed % 2 == 0 ? 2 : 1, seed % 2 == 0 ? 1 : 2, static_cast<std::uint64_t>(seed));
    RandomChoice policy{RandomSettings{}};
    Decision decision;
    for (int i = 0; i < 10; ++i) policy.decide(scene.situation(), decision);
    const Situation situation = scene.situation();
    PredictedPaths paths;
    paths.lay(situation, RandomSettings{}.horizon);
    AveragedPaths averaged;
    std::vector<double> gradient(2);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= 100; ++i) {
      const std::vector<double> q{i / 100.0, 1.0 - i / 100.0};
      least = std::min(least, averaged.bound(paths, scene.feasible, q, gradient));
    }
    EXPECT_LE(averaged.bound(paths, scene.feasible, policy.probabilities(), gradient), 1.02 * least);
  }
}

/// A radar that goes down takes nothing but its own pairs out of the draw.
TEST(RandomChoice, APairDrawsTheSameWhateverElseThereIs) {
  Scene scene = random_scene(3, 4);
  RandomChoice policy(kUniform);
  Decision with, without;
  policy.decide(scene.situation(), with);
  scene.up[1] = false;
  policy.decide(scene.situation(), without);
  for (const Candidate& left : without.candidates) {
    for (const Candidate& candidate : with.candidates) {
      if (candidate.pair.sensor != left.pair.sensor || candidate.pair.track != left.pair.track) continue;
      EXPECT_NEAR(left.score - std::log(9.0 / 6.0), candidate.score, 1e-12);  // its share alone has changed
    }
  }
}

}  // namespace
}  // namespace dwell::testing
