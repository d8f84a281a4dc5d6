#pragma once

#include "bandit/best_schedule.hpp"
#include "bandit/planned_policy.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

/// The first look of the best schedule of the horizon, by branch and bound from the first level on: the same as a
/// window of that length, whose small trees are enumerated so that every pair's own best schedule is known. Here a pair
/// that cannot win is given up early and scored by what it is worth alone. Optimal for the plan's model and horizon,
/// which is not to say for the tracks. Source  Chung et al. (2004), III-A.
class Optimum final : public PlannedPolicy {
 public:
  explicit Optimum(const OptimumSettings& settings) : PlannedPolicy(settings.horizon) {}

  std::string_view name() const override { return "optimum"; }

 private:
  void search(Tree& tree, Level& root) override {
    best_.branch_and_bound(tree, root, scans());
    found(tree, root);
  }

  BestSchedule best_;
};

}  // namespace dwell
