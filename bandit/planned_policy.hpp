#pragma once

#include "bandit/track_dynamics.hpp"

namespace dwell {

/// What all policies share that search the tree of schedules of the next scans, first scan now, and give the first look
/// of the best. They plan anew in every scan.
///
///   score = cost of the horizon without a look - cost of the best schedule found that begins with the pair
///
/// Schedules found are those that the search kept to the end, and every pair with no look after it: what a pair is
/// worth at the least. The costs are those of TrackDynamics: the tracks' position variances on their predicted paths,
/// an approximation stated in predicted_paths.hpp. A plan makes one look a scan. Where a scan has several the others
/// are taken by their scores. A search that outgrows its memory is given up; then every pair has its own worth alone,
/// and the decision says that it fell back.
class PlannedPolicy : public Policy {
 public:
  void decide(const Situation& situation, Decision& decision) final;

 protected:
  using Tree = search::SearchTree<TrackDynamics>;
  using Level = search::Level<TrackDynamics::Scalar>;
  using Node = TrackDynamics::Node;

  /// Of a level: more are not searched in a second, and a policy of a daemon has no more time.
  static constexpr std::size_t kLevelBytes = std::size_t{1} << 22;

  /// `scans` that are looked ahead, the present one among them: 1 .. PredictedPaths::kMostScans.
  explicit PlannedPolicy(int scans);

  int scans() const { return scans_; }
  /// A schedule that begins with this choice costs so much.
  void found(int first_choice, double cost);
  void found(const Tree& tree, const Level& leaves);

 private:
  /// Finds schedules from the root on. May throw std::length_error.
  virtual void search(Tree& tree, Level& root) = 0;

  void score(const Situation& situation, std::span<Candidate> candidates) final;
  void value_each_alone(std::span<const Candidate> candidates);

  int scans_;
  PredictedPaths paths_;
  TrackDynamics dynamics_;
  Tree tree_;
  Level level_;
  std::vector<double> values_;  // of each choice
  std::vector<TrackDynamics::Scalar> nobody_;
  std::vector<std::uint16_t> no_looks_;
  std::vector<TrackDynamics::Scalar> state_;
  std::vector<std::uint16_t> looks_;
  bool fell_back_ = false;
};

}  // namespace dwell
