#pragma once

#include "bandit/search/bound_pruning.hpp"
#include "bandit/track_dynamics.hpp"

namespace dwell {

/// Lower bounds on what schedules of tracks cost, for branch and bound.
///
/// With r scans to come there are r looks to share out. Of a track that gets n of them, the covariances are nowhere
/// below those under *all* sensors at once in the n scans that suit it best: each step is monotone in P, and no look
/// betters that of every sensor (the Riccati-monotone bound). With A_t(n) the cost of that,
///
///   cost of a schedule >= cost so far + min { sum_t A_t(n_t) : sum_t n_t <= r },
///
/// by a recursion over tracks. It leaves out the use of sensors, budgets, and that two tracks cannot have the same
/// scan. A node serves as well as another one where all covariances of all modes of all tracks are nowhere above the
/// other's (Loewner) and limited sensors looked in the same scans.
class TrackBounds final : public search::Bounds<TrackDynamics::Scalar> {
 public:
  using Node = TrackDynamics::Node;

  /// For the situation and paths that the dynamics has. It outlives the bounds' use.
  void start(TrackDynamics& dynamics);

  double bound(const Node& node, int left, double enough) override;
  bool serves_as_well(const Node& rival, const Node& node) override;

 private:
  double least(PredictedPaths::Belief belief, int looks);
  bool nowhere_above(PredictedPaths::Belief low, PredictedPaths::Belief high) const;

  TrackDynamics* dynamics_ = nullptr;
  int scans_ = 0;
  std::vector<double> least_;   // [belief][looks]: A, NaN where not known yet
  std::vector<double> shared_;  // over the tracks so far, for each number of looks
  std::vector<double> next_;
};

/// A search that ends with a schedule of the least cost in its level.
class BestSchedule {
 public:
  using Tree = search::SearchTree<TrackDynamics>;
  using Level = search::Level<TrackDynamics::Scalar>;

  BestSchedule() : exact_(bounds_, kRivals) {}

  /// Trees of at most kSmallTree leaves are enumerated, larger ones searched as below.
  void search(Tree& tree, Level& root, int scans);
  /// With a beam of kGuideWidth for the schedule at hand.
  void branch_and_bound(Tree& tree, Level& root, int scans);

  static constexpr double kSmallTree = 10'000.0;
  static constexpr std::size_t kGuideWidth = 32;
  static constexpr std::size_t kRivals = 32;  // of many tracks few schedules serve as well as another

 private:
  TrackBounds bounds_;
  search::Everything<TrackDynamics::Scalar> everything_;
  search::BeamPruning<TrackDynamics::Scalar> guide_{kGuideWidth};
  search::BoundPruning<TrackDynamics::Scalar> exact_;
  Level at_hand_{0, 0, 0};
};

}  // namespace dwell
