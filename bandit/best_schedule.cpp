#include "bandit/best_schedule.hpp"

#include <cmath>

#include <Eigen/Cholesky>

namespace dwell {

void TrackBounds::start(TrackDynamics& dynamics) {
  dynamics_ = &dynamics;
  scans_ = dynamics.paths().scans();
  least_.clear();
  shared_.resize(static_cast<std::size_t>(scans_) + 1);
  next_.resize(shared_.size());
}

double TrackBounds::bound(const Node& node, int left, double /*enough*/) {
  if (left == 0) return node.cost;
  const int depth = scans_ - left;
  const auto looks = static_cast<std::size_t>(left);
  std::fill_n(shared_.begin(), looks + 1, 0.0);
  for (std::size_t track = 0; track < dynamics_->paths().tracks(); ++track) {
    const PredictedPaths::Belief belief = dynamics_->belief(node.state, depth, track, depth - 1);
    for (std::size_t all = 0; all <= looks; ++all) {
      next_[all] = std::numeric_limits<double>::infinity();
      for (std::size_t own = 0; own <= all; ++own) {
        next_[all] = std::min(next_[all], shared_[all - own] + least(belief, static_cast<int>(own)));
      }
    }
    std::swap(shared_, next_);
  }
  return node.cost + shared_[looks];
}

/// The least cost of the scans after a belief with at most so many looks, each of all sensors.
double TrackBounds::least(PredictedPaths::Belief belief, int looks) {
  PredictedPaths& paths = dynamics_->paths();
  if (paths.scan(belief) == scans_ - 1) return 0.0;
  const auto width = static_cast<std::size_t>(scans_) + 1;
  const std::size_t place = belief * width + static_cast<std::size_t>(looks);
  if (place >= least_.size()) least_.resize((belief + 1) * width, std::numeric_limits<double>::quiet_NaN());
  if (!std::isnan(least_[place])) return least_[place];
  const PredictedPaths::Belief idle = paths.after(belief, PredictedPaths::kNoLook);
  double least_cost = paths.cost(idle) + least(idle, looks);
  if (looks > 0) {
    const PredictedPaths::Belief seen = paths.after(belief, paths.every_sensor());
    least_cost = std::min(least_cost, paths.cost(seen) + least(seen, looks - 1));
  }
  return least_[place] = least_cost;
}

bool TrackBounds::serves_as_well(const Node& rival, const Node& node) {
  const auto& states = dynamics_->situation().states;
  for (std::size_t s = 0; s < states.size(); ++s) {
    if (states[s].budget.limited() && rival.looks[s] != node.looks[s]) return false;
  }
  // Nodes of a level: the looks are as many as scans are not idle, in both.
  int depth = static_cast<int>(dynamics_->size());
  const auto nobody = [&](int look) {
    return rival.state[look] == PredictedPaths::kNobody && node.state[look] == PredictedPaths::kNobody;
  };
  while (depth > 0 && nobody(depth - 1)) --depth;
  for (const auto* state : {rival.state, node.state}) {
    for (int look = 0; look < depth; ++look) {
      if (state[look] == PredictedPaths::kNobody) continue;
      const std::size_t track = dynamics_->paths().track(state[look]);
      const auto low = dynamics_->belief(rival.state, depth, track, depth - 1);
      const auto high = dynamics_->belief(node.state, depth, track, depth - 1);
      if (low != high && !nowhere_above(low, high)) return false;
    }
  }
  return true;
}

/// Loewner order, mode by mode, within rounding relative to the trace.
bool TrackBounds::nowhere_above(PredictedPaths::Belief low, PredictedPaths::Belief high) const {
  const PredictedPaths& paths = dynamics_->paths();
  for (std::size_t mode = 0; mode < paths.modes(); ++mode) {
    const StateMatrix& above = paths.covariances(high)[mode];
    StateMatrix gap = above - paths.covariances(low)[mode];
    gap.diagonal().array() += 1e-13 * above.trace();
    if (gap.diagonal().minCoeff() <= 0.0 || Eigen::LLT<StateMatrix>(gap).info() != Eigen::Success) return false;
  }
  return true;
}

void BestSchedule::search(Tree& tree, Level& root, int scans) {
  const auto pairs = static_cast<double>(tree.dynamics().choices());
  if (std::pow(pairs, scans) > kSmallTree && scans > 1) return branch_and_bound(tree, root, scans);
  tree.grow(root, scans, everything_);
}

void BestSchedule::branch_and_bound(Tree& tree, Level& root, int scans) {
  at_hand_ = root;
  tree.grow(at_hand_, scans, guide_);
  const double at_hand = at_hand_[cheapest(at_hand_)].cost;
  bounds_.start(tree.dynamics());
  exact_.begin(scans, at_hand);
  tree.grow(root, scans, exact_);
}

}  // namespace dwell
