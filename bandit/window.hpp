#pragma once

#include "bandit/best_schedule.hpp"
#include "bandit/planned_policy.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

/// Sliding window: the first look of the best schedule of the next d scans, in every scan. d = 1 is the one-step rule
/// on the modes' covariances. A longer window is not always better (PlannedPolicy says what it leaves out), and d scans
/// of p pairs are p^d schedules, whose number BestSchedule makes less of. Source  Chung et al. (2004), III-B; Gupta et
/// al. (2004), algorithm 1.
class Window final : public PlannedPolicy {
 public:
  explicit Window(const WindowSettings& settings) : PlannedPolicy(settings.d) {}

  std::string_view name() const override { return "window"; }

 private:
  void search(Tree& tree, Level& root) override {
    best_.search(tree, root, scans());
    found(tree, root);
  }

  BestSchedule best_;
};

}  // namespace dwell
