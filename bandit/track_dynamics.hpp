#pragma once

#include "bandit/predicted_paths.hpp"
#include "bandit/search/search_tree.hpp"

namespace dwell {

/// Many tracks, many sensors, one look a scan: what a tree of schedules (bandit/search) moves on.
///
/// A choice is a pair, 1 + track x sensors + sensor; step k is scan k - 1, from now. Idle is a choice only where no
/// pair is feasible: the link is there to be used. The state are the beliefs that the looks have led to, one a step:
/// all other tracks were not looked at. `looks` has a bit for each scan in which a sensor looks, which is what a budget
/// asks for. The cost is the sum over scans and tracks of the cost after the scan (PredictedPaths), and the use of the
/// sensors. That of the last scan alone would not do for plans made anew in every scan: the best time for a look would
/// always be the next one.
class TrackDynamics {
 public:
  using Scalar = PredictedPaths::Belief;
  using Node = search::Node<Scalar>;

  /// The paths are those of the situation; both outlive the tree.
  void start(const Situation& situation, PredictedPaths& paths);

  std::size_t size() const { return static_cast<std::size_t>(paths_->scans()); }
  std::size_t sensors() const { return paths_->sensors(); }
  int choices() const { return static_cast<int>(paths_->tracks() * paths_->sensors()); }
  int choice_of(const Pair& pair) const { return 1 + static_cast<int>(pair.track * sensors() + pair.sensor); }
  Pair pair_of(int choice) const {
    const auto place = static_cast<std::size_t>(choice - 1);
    return {place % sensors(), place / sensors()};
  }

  bool feasible(const Node& node, int step, int choice) const;
  void step(const Node& node, int step, int choice, Scalar* to, std::vector<std::uint16_t>& looks);
  double cost_after(const Node& node, int step, int choice, const Scalar* to);
  void check() const {}  ///< beliefs are counted as they are made (PredictedPaths)

  /// What a node at `depth` costs in the end where no look follows.
  double cost_without_looks(double cost, const Scalar* state, int depth);
  /// The belief of a track at a node after scan `scan`, not looked at since the node's `depth` looks.
  Scalar belief(const Scalar* state, int depth, std::size_t track, int scan);
  /// Whether a track was looked at among the first `depth` looks of a state.
  bool touched(const Scalar* state, int depth, std::size_t track) const;

  PredictedPaths& paths() { return *paths_; }
  const Situation& situation() const { return *situation_; }

 private:
  bool may_look(const Node& node, int scan, const Pair& pair) const;
  double all_tracks(const Scalar* state, int depth, int scan);

  const Situation* situation_ = nullptr;
  PredictedPaths* paths_ = nullptr;
  std::vector<double> idle_total_;  // of all tracks after each scan, without a look
};

}  // namespace dwell
