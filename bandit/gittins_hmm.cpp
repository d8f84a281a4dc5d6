#include "bandit/gittins_hmm.hpp"

#include <algorithm>
#include <cmath>

#include "bandit/hmm_bandit/gittins.hpp"

namespace dwell {
namespace {

/// Arms are forgotten, all at once, when there are so many: some hours of a run.
constexpr std::size_t kMostKnown = 20'000;

}  // namespace

hmm_bandit::Arm GittinsHmm::arm(const TargetClasses& classes, const Sensor& sensor, const Track& track) {
  const Eigen::Index n = track.class_belief.size();
  const double p_d = sensor.detection_probability(track.combined.mean);
  const double seen = std::round(p_d / kDetectionStep) * kDetectionStep;
  hmm_bandit::Arm arm;
  arm.transition = classes.transition;
  arm.reward = classes.weight;
  arm.belief = (track.class_belief / kBeliefStep).array().round();
  arm.belief /= arm.belief.sum();
  const Declaration* declaration = sensor.declaration();
  const Eigen::Index symbols = declaration == nullptr ? 1 : n;
  arm.emission.resize(n, symbols + 1);
  arm.emission.leftCols(symbols) = declaration == nullptr ? Eigen::MatrixXd::Ones(n, 1) : declaration->emission;
  arm.emission.leftCols(symbols) *= seen;
  arm.emission.col(symbols).setConstant(1.0 - seen);
  return arm;
}

double GittinsHmm::index(const hmm_bandit::Arm& arm) {
  std::vector<double> key;
  key.reserve(static_cast<std::size_t>(arm.transition.size() + arm.emission.size() + 2 * arm.belief.size()));
  key.insert(key.end(), arm.belief.begin(), arm.belief.end());
  key.insert(key.end(), arm.emission.reshaped().begin(), arm.emission.reshaped().end());
  key.insert(key.end(), arm.reward.begin(), arm.reward.end());
  key.insert(key.end(), arm.transition.reshaped().begin(), arm.transition.reshaped().end());
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  if (known_.size() >= kMostKnown) known_.clear();
  const double index = hmm_bandit::gittins_index(arm, arm.belief, settings_.discount, kPoints).index;
  known_.emplace(std::move(key), index);
  return index;
}

void GittinsHmm::score(const Situation& situation, std::span<Candidate> candidates) {
  for (Candidate& candidate : candidates) {
    const Track& track = situation.tracks[candidate.pair.track];
    if (situation.classes == nullptr || track.class_belief.size() == 0) {
      candidate.score = track.weight;
      continue;
    }
    const Sensor& sensor = *situation.sensors[candidate.pair.sensor];
    candidate.score = track.target_weight * index(arm(*situation.classes, sensor, track));
  }
}

}  // namespace dwell
