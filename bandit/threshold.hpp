#pragma once

#include "bandit/planned_policy.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

/// Thresholding: of every scan the schedules stay whose cost so far is at most f times the least. With f = 1 that is
/// the one-step rule, and its ties followed over the horizon. Source  Chung et al. (2004), III-C; Gupta et al. (2004),
/// algorithm 2.
class Threshold final : public PlannedPolicy {
 public:
  explicit Threshold(const ThresholdSettings& settings) : PlannedPolicy(settings.horizon), pruning_(settings.f) {}

  std::string_view name() const override { return "threshold"; }

 private:
  void search(Tree& tree, Level& root) override {
    tree.grow(root, scans(), pruning_);
    found(tree, root);
  }

  search::ThresholdPruning<TrackDynamics::Scalar> pruning_;
};

}  // namespace dwell
