#include "bandit/gittins_hmm.hpp"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "bandit/hmm_bandit/gittins.hpp"
#include "tests/bandit/scene.hpp"

namespace dwell::testing {
namespace {

TargetClasses two_classes(double first, double second) {
  TargetClasses classes;
  classes.names = {"a", "b"};
  classes.prior = Eigen::Vector2d(0.5, 0.5);
  classes.weight = Eigen::Vector2d(first, second);
  classes.transition = Eigen::Matrix2d::Identity();
  return classes;
}

std::shared_ptr<LinearSensor> sensor_of(double right, double p_d) {
  auto sensor = std::make_shared<LinearSensor>(position_selector(), Matrix2::Identity(), p_d);
  sensor->set_declaration({(Eigen::Matrix2d() << right, 1.0 - right, 1.0 - right, right).finished()});
  return sensor;
}

Scene scene_of(const std::vector<double>& beliefs_in_second, double right, double p_d) {
  Scene scene;
  scene.add_sensor(sensor_of(right, p_d));
  for (std::size_t i = 0; i < beliefs_in_second.size(); ++i) {
    scene.add_track(static_cast<std::uint32_t>(i + 1),
                    make_estimate({State::Zero(), StateMatrix::Identity()}, Eigen::VectorXd::Ones(1)));
    scene.tracks.back().class_belief = Eigen::Vector2d(1.0 - beliefs_in_second[i], beliefs_in_second[i]);
  }
  return scene;
}

std::vector<double> scores(double discount, Scene& scene, const TargetClasses& classes) {
  GittinsHmm policy({discount});
  Situation situation = scene.situation();
  situation.classes = &classes;
  Decision decision;
  policy.decide(situation, decision);
  std::vector<double> all;
  for (const Candidate& candidate : decision.candidates) all.push_back(candidate.score);
  return all;
}

/// What is known is worth its weight; what may be more is worth more than its mean, and less than the most it may be.
TEST(GittinsHmmPolicy, IndexIsBetweenTheMeanAndTheLargestWeight) {
  const TargetClasses classes = two_classes(1.0, 5.0);
  Scene scene = scene_of({0.0, 1.0, 0.2, 0.5}, 0.8, 1.0);
  scene.tracks[3].target_weight = 3.0;
  const auto score = scores(0.9, scene, classes);
  EXPECT_NEAR(score[0], 1.0, 1e-12);
  EXPECT_NEAR(score[1], 5.0, 1e-12);
  EXPECT_GT(score[2], 1.8);
  EXPECT_LT(score[2], 5.0);
  EXPECT_GT(score[3], 3.0 * 3.0) << "times the target's own weight";
}

/// A play that shows nothing, with probability 1 - P_d, leaves an arm that stands still as it is: by the retirement
/// form the index is that of P_d = 1 at discount b P_d / (1 - b + b P_d).
TEST(GittinsHmmPolicy, MissedPlotsAreALowerDiscount) {
  const TargetClasses classes = two_classes(1.0, 5.0);
  for (const double p_d : {0.2, 0.5, 0.9}) {
    Scene missed = scene_of({0.1, 0.3, 0.6}, 0.8, p_d);
    Scene seen = scene_of({0.1, 0.3, 0.6}, 0.8, 1.0);
    const double b = 0.9;
    const auto left = scores(b, missed, classes);
    const auto right = scores(b * p_d / (1.0 - b + b * p_d), seen, classes);
    // The hundred likeliest beliefs are not the same ones: each leaves out some 1e-7.
    for (std::size_t i = 0; i < left.size(); ++i) EXPECT_NEAR(left[i], right[i], 1e-6) << p_d;
  }
}

/// Points from the likeliest on: three times as many add little that a choice depends on. A value from below.
TEST(GittinsHmmPolicy, HasPointsEnough) {
  RandomStream random(1);
  for (const int n : {2, 3}) {
    TargetClasses classes;
    classes.weight = Eigen::VectorXd::LinSpaced(n, 1.0, 10.0);
    classes.transition.setIdentity(n, n);
    LinearSensor sensor(position_selector(), Matrix2::Identity(), 0.9);
    Track track;
    track.class_belief = Eigen::VectorXd::Constant(n, 1.0 / n);
    Eigen::MatrixXd emission = 0.5 * Eigen::MatrixXd::Identity(n, n);
    for (int i = 0; i < n; ++i) {
      Eigen::RowVectorXd row(n);
      for (double& p : row) p = random.uniform();
      emission.row(i) += 0.5 * row / row.sum();
    }
    sensor.set_declaration({emission});
    const hmm_bandit::Arm arm = GittinsHmm::arm(classes, sensor, track);
    const double index = hmm_bandit::gittins_index(arm, arm.belief, 0.9, GittinsHmm::kPoints).index;
    const double exact = hmm_bandit::gittins_index(arm, arm.belief, 0.9, 3 * GittinsHmm::kPoints).index;
    EXPECT_LE(index, exact + 1e-12);
    EXPECT_NEAR(index, exact, (n == 2 ? 1e-6 : 1e-3) * exact) << n << " classes";
  }
}

/// Two tracks that may be a or b, declared right with probability .8, looked at one a scan: the best of all rules, by
/// dynamic programming on both beliefs over 30 looks; later ones are worth .6^30 = 2e-7. Looking at the track of
/// the greater index is as good; looking at the one of the greater mean weight is not.
TEST(GittinsHmmPolicy, IsOptimalForTwoTracks) {
  constexpr double kDiscount = 0.6;
  constexpr double kRight = 0.8;
  constexpr int kLooks = 30;
  const double prior[] = {0.3, 0.45};
  // The second has the greater mean weight, 2.175 against 2.15, and the first more to be learned of it.
  const TargetClasses classes[] = {two_classes(0.5, 6.0), two_classes(1.5, 3.0)};
  // A belief is its prior and by how many more plots declared b than a.
  const auto belief = [&](int track, int more) {
    const double odds = prior[track] / (1.0 - prior[track]) * std::pow(kRight / (1.0 - kRight), more);
    return odds / (1.0 + odds);
  };
  const auto reward = [&](int track, int more) {
    const double p = belief(track, more);
    return (1.0 - p) * classes[track].weight[0] + p * classes[track].weight[1];
  };
  std::map<std::pair<int, int>, double> index;
  for (int track = 0; track < 2; ++track) {
    for (int more = -kLooks; more <= kLooks; ++more) {
      Scene scene = scene_of({belief(track, more)}, kRight, 1.0);
      index[{track, more}] = scores(kDiscount, scene, classes[track])[0];
    }
  }
  enum Rule { kBest, kIndex, kMean };
  const auto value = [&](Rule rule) {
    const int side = 2 * kLooks + 3;
    std::vector<double> later(static_cast<std::size_t>(side * side), 0.0);
    std::vector<double> now = later;
    const auto at = [&](int first, int second) {
      return static_cast<std::size_t>((first + kLooks + 1) * side + second + kLooks + 1);
    };
    for (int look = kLooks - 1; look >= 0; --look) {
      for (int first = -look; first <= look; ++first) {
        for (int second = -look; second <= look; ++second) {
          const auto of = [&](int track) {
            const double p = belief(track, track == 0 ? first : second);
            const double seen = p * kRight + (1.0 - p) * (1.0 - kRight);
            const double up = track == 0 ? later[at(first + 1, second)] : later[at(first, second + 1)];
            const double down = track == 0 ? later[at(first - 1, second)] : later[at(first, second - 1)];
            return reward(track, track == 0 ? first : second) + kDiscount * (seen * up + (1.0 - seen) * down);
          };
          const bool second_first = rule == kBest    ? of(1) > of(0)
                                    : rule == kIndex ? index[{1, second}] > index[{0, first}]
                                                     : reward(1, second) > reward(0, first);
          now[at(first, second)] = of(second_first ? 1 : 0);
        }
      }
      std::swap(now, later);
    }
    return later[at(0, 0)];
  };
  const double best = value(kBest);
  // At most six a look beyond the horizon; and near it the rule of an endless run is not the best.
  EXPECT_NEAR(value(kIndex), best, 2.0 * 6.0 / (1.0 - kDiscount) * std::pow(kDiscount, kLooks));
  EXPECT_LT(value(kMean), best - 0.01);
  RecordProperty("share_of_best_by_mean", std::to_string(value(kMean) / best));
}

TEST(GittinsHmmPolicy, WithoutClassesIsTheWeight) {
  Scene scene = plain_scene(1, {1, 2});
  scene.tracks[1].weight = 2.0;
  EXPECT_EQ(scores(0.9, scene, {}), (std::vector<double>{1.0, 2.0}));
}

}  // namespace
}  // namespace dwell::testing
