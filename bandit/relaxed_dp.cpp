#include "bandit/relaxed_dp.hpp"

#include <stdexcept>

#include <Eigen/Cholesky>

namespace dwell {
namespace {

constexpr double kRounding = 1e-9;  // relative to the trace or the cost, as lti/relaxed_dp

}  // namespace

RelaxedDp::RelaxedDp(const RelaxedDpSettings& settings)
    : PlannedPolicy(settings.horizon),
      lower_paths_(1.0 / settings.alpha),
      lower_tree_(lower_, kLevelBytes),
      cover_(settings.alpha, lower_) {}

void RelaxedDp::search(Tree& tree, Level& root) {
  const Situation& situation = tree.dynamics().situation();
  lower_paths_.lay(situation, scans());
  lower_.start(situation, lower_paths_);
  const Node start = root[0];
  lower_tree_.plant({start.state, lower_.size()}, start.looks, 0, 0.0, kept_);
  lower_tree_.grow(kept_, scans(), cover_);
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    lower_tree_.schedule(kept_[i], schedule_);
    found(schedule_.front(), true_cost(tree));
  }
}

double RelaxedDp::true_cost(Tree& tree) {
  TrackDynamics& dynamics = tree.dynamics();
  state_.assign(dynamics.size(), PredictedPaths::kNobody);
  looks_.assign(dynamics.sensors(), 0);
  double cost = 0.0;
  for (std::size_t k = 0; k < schedule_.size(); ++k) {
    const int step = static_cast<int>(k) + 1;
    before_ = state_;
    const Node node{before_.data(), cost, {}, 0, 0, 0};
    dynamics.step(node, step, schedule_[k], state_.data(), looks_);
    cost = dynamics.cost_after(node, step, schedule_[k], state_.data());
  }
  return cost;
}

void RelaxedDp::Cover::select(const Level& parents, const Level& children, std::vector<std::size_t>& kept) {
  up_.resize(lower_.paths().modes());
  cost_up_.resize(children.size());
  order_.resize(children.size());
  idle_up_ = idle_up(children.depth());
  for (std::size_t i = 0; i < children.size(); ++i) {
    order_[i] = i;
    cost_up_[i] = cost_up(parents[children[i].parent], children[i], children.depth());
  }
  std::sort(order_.begin(), order_.end(), [&](std::size_t i, std::size_t j) {
    return cost_up_[i] != cost_up_[j] ? cost_up_[i] < cost_up_[j] : i < j;
  });
  for (const std::size_t i : order_) {
    const Node parent = parents[children[i].parent];
    const bool covered = std::any_of(kept.begin(), kept.end(), [&](std::size_t lo) {
      return children[lo].cost <= cost_up_[i] * (1.0 + kRounding) &&
             covers(children[lo], parent, children[i], children.depth());
    });
    if (!covered) kept.push_back(i);
    if (kept.size() > kMostKept) throw std::length_error("more than can be compared: take beam");
  }
  std::sort(kept.begin(), kept.end());
}

/// The up of a track: from where its parent's lo left it.
void RelaxedDp::Cover::step_up(const Node& parent, const Node& child, int depth, std::size_t track) {
  const auto from = lower_.belief(parent.state, depth - 1, track, depth - 2);
  int choice = PredictedPaths::kNoLook;
  if (child.choice > 0) {
    const Pair pair = lower_.pair_of(child.choice);
    if (pair.track == track) choice = 1 + static_cast<int>(pair.sensor);
  }
  lower_.paths().step(from, choice, alpha_, up_.data());
}

/// The up of all tracks after the scan where none was ever looked at.
double RelaxedDp::Cover::idle_up(int depth) {
  PredictedPaths& paths = lower_.paths();
  double cost = 0.0;
  for (std::size_t track = 0; track < paths.tracks(); ++track) {
    paths.step(paths.idle(track, depth - 2), PredictedPaths::kNoLook, alpha_, up_.data());
    cost += paths.cost(track, depth - 1, up_.data());
  }
  return cost;
}

/// What the parent's lo has cost so far, and the up of all tracks.
double RelaxedDp::Cover::cost_up(const Node& parent, const Node& child, int depth) {
  PredictedPaths& paths = lower_.paths();
  double cost = parent.cost + idle_up_;
  if (child.choice > 0) cost += lower_.situation().usage_cost[lower_.pair_of(child.choice).sensor];
  for (int look = 0; look < depth; ++look) {
    if (child.state[look] == PredictedPaths::kNobody) continue;
    const std::size_t track = paths.track(child.state[look]);
    if (lower_.touched(child.state + look + 1, depth - look - 1, track)) continue;
    step_up(parent, child, depth, track);
    cost += paths.cost(track, depth - 1, up_.data());
    paths.step(paths.idle(track, depth - 2), PredictedPaths::kNoLook, alpha_, up_.data());
    cost -= paths.cost(track, depth - 1, up_.data());
  }
  return cost;
}

/// Tracks that neither looked at are covered: the lo of a prediction is below its up.
bool RelaxedDp::Cover::covers(const Node& lo, const Node& parent, const Node& child, int depth) {
  const auto& states = lower_.situation().states;
  for (std::size_t s = 0; s < states.size(); ++s) {
    if (states[s].budget.limited() && lo.looks[s] != child.looks[s]) return false;
  }
  for (const auto* state : {lo.state, child.state}) {
    for (int look = 0; look < depth; ++look) {
      if (state[look] == PredictedPaths::kNobody) continue;
      const std::size_t track = lower_.paths().track(state[look]);
      step_up(parent, child, depth, track);
      if (!nowhere_above_up(lower_.belief(lo.state, depth, track, depth - 1))) return false;
    }
  }
  return true;
}

bool RelaxedDp::Cover::nowhere_above_up(PredictedPaths::Belief low) const {
  const StateMatrix* covariances = lower_.paths().covariances(low);
  for (std::size_t mode = 0; mode < up_.size(); ++mode) {
    StateMatrix gap = up_[mode] - covariances[mode];
    gap.diagonal().array() += kRounding * up_[mode].trace();
    if (Eigen::LLT<StateMatrix>(gap).info() != Eigen::Success) return false;
  }
  return true;
}

}  // namespace dwell
