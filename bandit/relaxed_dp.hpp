#pragma once

#include "bandit/planned_policy.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

/// Relaxed dynamic programming: the cost of the horizon is within alpha^2 of the least that any schedule of the plan's
/// model costs.
///
/// A set of beliefs and costs so far goes forward. Of each and every pair a candidate: `up` and `lo`, the step with
/// process and measurement noise multiplied by alpha and by 1 / alpha. In the order of the cost of up, a candidate is
/// dropped where the lo of one kept before costs no more than its up, is nowhere above it, in every mode of every
/// track, and looked in the same scans with every limited sensor; else its lo is kept. The answer is the kept schedule
/// of the least true cost. That the steps are monotone and homogeneous in P and the noise is what makes the guarantee,
/// for the final cost of Alriksson and Rantzer as for the sum of this plan, which is homogeneous too. Mixtures of what
/// is kept are not tried for the cover, as lti/relaxed_dp does: what might be dropped besides is kept, which is safe.
///
/// Many tracks leave little to drop: their schedules leave different tracks well known. Where more than kMostKept
/// beliefs stay the search is given up (PlannedPolicy); beam is the one to take.
///
/// Source   Alriksson, Rantzer (2005), procedure 1.
class RelaxedDp final : public PlannedPolicy {
 public:
  explicit RelaxedDp(const RelaxedDpSettings& settings);

  std::string_view name() const override { return "relaxed_dp"; }

  static constexpr std::size_t kMostKept = 256;  ///< each is compared with each: 50 ms

 private:
  void search(Tree& tree, Level& root) override;
  /// Of `schedule_`.
  double true_cost(Tree& tree);

  /// Of the search with the smaller noise.
  class Cover final : public search::Pruning<TrackDynamics::Scalar> {
   public:
    Cover(double alpha, TrackDynamics& lower) : alpha_(alpha), lower_(lower) {}
    void select(const Level& parents, const Level& children, std::vector<std::size_t>& kept) override;

   private:
    void step_up(const Node& parent, const Node& child, int depth, std::size_t track);
    double idle_up(int depth);
    double cost_up(const Node& parent, const Node& child, int depth);
    bool covers(const Node& lo, const Node& parent, const Node& child, int depth);
    bool nowhere_above_up(PredictedPaths::Belief low) const;

    double alpha_;
    TrackDynamics& lower_;
    std::vector<StateMatrix> up_;  // of one track's modes
    double idle_up_ = 0.0;
    std::vector<double> cost_up_;
    std::vector<std::size_t> order_;
  };

  PredictedPaths lower_paths_;
  TrackDynamics lower_;
  Tree lower_tree_;
  Cover cover_;
  Level kept_{0, 0, 0};
  std::vector<int> schedule_;
  std::vector<TrackDynamics::Scalar> before_;
  std::vector<TrackDynamics::Scalar> state_;
  std::vector<std::uint16_t> looks_;
};

}  // namespace dwell
