#include "bandit/planned_policy.hpp"

#include <cmath>
#include <stdexcept>

namespace dwell {

PlannedPolicy::PlannedPolicy(int scans) : scans_(scans), tree_(dynamics_, kLevelBytes), level_(0, 0, 0) {}

void PlannedPolicy::decide(const Situation& situation, Decision& decision) {
  fell_back_ = false;
  Policy::decide(situation, decision);
  decision.fell_back = fell_back_;
}

void PlannedPolicy::score(const Situation& situation, std::span<Candidate> candidates) {
  paths_.lay(situation, scans_);
  dynamics_.start(situation, paths_);
  nobody_.assign(dynamics_.size(), PredictedPaths::kNobody);
  no_looks_.assign(dynamics_.sensors(), 0);
  tree_.plant(nobody_, no_looks_, 0, 0.0, level_);
  const double without = dynamics_.cost_without_looks(0.0, nobody_.data(), 0);
  value_each_alone(candidates);
  try {
    search(tree_, level_);
  } catch (const std::length_error&) {
    fell_back_ = true;
  }
  for (Candidate& candidate : candidates) {
    const double gain = without - values_[static_cast<std::size_t>(dynamics_.choice_of(candidate.pair))];
    candidate.score = std::isfinite(gain) ? gain : 0.0;  // numbers that fail: a look of no use
  }
}

void PlannedPolicy::found(int first_choice, double cost) {
  double& value = values_[static_cast<std::size_t>(first_choice)];
  value = std::min(value, cost);
}

void PlannedPolicy::found(const Tree& tree, const Level& leaves) {
  for (std::size_t i = 0; i < leaves.size(); ++i) found(tree.first_choice(leaves[i]), leaves[i].cost);
}

/// Every pair with no look after it.
void PlannedPolicy::value_each_alone(std::span<const Candidate> candidates) {
  values_.assign(static_cast<std::size_t>(dynamics_.choices()) + 1, std::numeric_limits<double>::infinity());
  const Node root = level_[0];
  for (const Candidate& candidate : candidates) {
    const int choice = dynamics_.choice_of(candidate.pair);
    state_.resize(dynamics_.size());
    looks_.assign(no_looks_.begin(), no_looks_.end());
    dynamics_.step(root, 1, choice, state_.data(), looks_);
    const double cost = dynamics_.cost_after(root, 1, choice, state_.data());
    values_[static_cast<std::size_t>(choice)] = dynamics_.cost_without_looks(cost, state_.data(), 1);
  }
}

}  // namespace dwell
