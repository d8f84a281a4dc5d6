#include "bandit/track_dynamics.hpp"

#include <algorithm>

namespace dwell {

void TrackDynamics::start(const Situation& situation, PredictedPaths& paths) {
  situation_ = &situation;
  paths_ = &paths;
  idle_total_.assign(size(), 0.0);
  for (int scan = 0; scan < paths.scans(); ++scan) {
    for (std::size_t track = 0; track < paths.tracks(); ++track) {
      idle_total_[static_cast<std::size_t>(scan)] += paths.cost(paths.idle(track, scan));
    }
  }
}

bool TrackDynamics::may_look(const Node& node, int scan, const Pair& pair) const {
  if (!paths_->covers(pair.track, pair.sensor, scan)) return false;
  return scan == 0 || situation_->states[pair.sensor].budget.allows(scan, node.looks[pair.sensor]);
}

bool TrackDynamics::feasible(const Node& node, int step, int choice) const {
  if (choice > 0) return may_look(node, step - 1, pair_of(choice));
  for (int other = 1; other <= choices(); ++other) {
    if (may_look(node, step - 1, pair_of(other))) return false;
  }
  return true;
}

void TrackDynamics::step(const Node& node, int step, int choice, Scalar* to, std::vector<std::uint16_t>& looks) {
  const int scan = step - 1;
  std::copy_n(node.state, size(), to);
  to[scan] = PredictedPaths::kNobody;
  if (choice == 0) return;
  const Pair pair = pair_of(choice);
  to[scan] = paths_->after(belief(node.state, scan, pair.track, scan - 1), 1 + static_cast<int>(pair.sensor));
  looks[pair.sensor] = static_cast<std::uint16_t>(looks[pair.sensor] | (1U << scan));
}

double TrackDynamics::cost_after(const Node& node, int step, int choice, const Scalar* to) {
  const int scan = step - 1;
  const double cost = node.cost + all_tracks(node.state, scan, scan);
  if (choice == 0) return cost;
  const Pair pair = pair_of(choice);
  const double gain = paths_->cost(belief(node.state, scan, pair.track, scan)) - paths_->cost(to[scan]);
  return cost - gain + situation_->usage_cost[pair.sensor];
}

double TrackDynamics::cost_without_looks(double cost, const Scalar* state, int depth) {
  const int last = paths_->scans() - 1;
  for (int scan = depth; scan <= last; ++scan) cost += all_tracks(state, depth, scan);
  return cost;
}

TrackDynamics::Scalar TrackDynamics::belief(const Scalar* state, int depth, std::size_t track, int scan) {
  for (int look = depth - 1; look >= 0; --look) {
    Scalar belief = state[look];
    if (belief == PredictedPaths::kNobody || paths_->track(belief) != track) continue;
    while (paths_->scan(belief) < scan) belief = paths_->after(belief, PredictedPaths::kNoLook);
    return belief;
  }
  return paths_->idle(track, scan);
}

bool TrackDynamics::touched(const Scalar* state, int depth, std::size_t track) const {
  return std::any_of(state, state + depth, [&](Scalar belief) {
    return belief != PredictedPaths::kNobody && paths_->track(belief) == track;
  });
}

/// The cost after a scan in which there is no look, of a state of `depth` looks.
double TrackDynamics::all_tracks(const Scalar* state, int depth, int scan) {
  double total = idle_total_[static_cast<std::size_t>(scan)];
  for (int look = 0; look < depth; ++look) {
    if (state[look] == PredictedPaths::kNobody) continue;
    const std::size_t track = paths_->track(state[look]);
    if (touched(state + look + 1, depth - look - 1, track)) continue;  // its last look counts
    total += paths_->cost(belief(state, depth, track, scan)) - paths_->cost(paths_->idle(track, scan));
  }
  return total;
}

}  // namespace dwell
