#pragma once

#include "bandit/planned_policy.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

/// Beam search: of every scan the `width` cheapest schedules stay. Its work grows with the pairs, not with their
/// powers: the one to take with many tracks.
class Beam final : public PlannedPolicy {
 public:
  explicit Beam(const BeamSettings& settings)
      : PlannedPolicy(settings.horizon), pruning_(static_cast<std::size_t>(settings.width)) {}

  std::string_view name() const override { return "beam"; }

 private:
  void search(Tree& tree, Level& root) override {
    tree.grow(root, scans(), pruning_);
    found(tree, root);
  }

  search::BeamPruning<TrackDynamics::Scalar> pruning_;
};

}  // namespace dwell
