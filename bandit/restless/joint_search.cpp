#include "bandit/restless/joint_search.hpp"

#include <algorithm>
#include <functional>
#include <limits>

namespace dwell::restless {

JointSearch::JointSearch(const Problem& problem, std::vector<Closure> closures, double price, int depth)
    : problem_(problem),
      closures_(std::move(closures)),
      price_(price),
      depth_(depth),
      discount_(problem.discount_or_one()) {}

int JointSearch::add(int arm, const Matrix& p) {
  Node node;
  node.p = p;
  node.arm = arm;
  node.cost = scan_cost(problem_.arms[static_cast<std::size_t>(arm)], p);
  node.detected.assign(problem_.arms[static_cast<std::size_t>(arm)].sensors.size(), -1);
  node.seen_cost.assign(node.detected.size(), 0.0);
  nodes_.push_back(std::move(node));
  return static_cast<int>(nodes_.size()) - 1;
}

void JointSearch::prepare_last(int at) {
  Node& node = nodes_[static_cast<std::size_t>(at)];
  if (node.has_last) return;
  const Arm& arm = problem_.arms[static_cast<std::size_t>(node.arm)];
  const ValueSet* value = closures_[static_cast<std::size_t>(node.arm)].value;
  node.has_last = true;
  node.best_gain = -std::numeric_limits<double>::infinity();
  node.last = value != nullptr ? idle_cost(arm, *value, discount_, node.p) : node.cost;
  for (std::size_t s = 0; s < arm.sensors.size(); ++s) {
    const double look = value != nullptr ? look_cost(arm, s, *value, discount_, price_, node.p, node.last)
                                         : expected_scan_cost(arm, arm.sensors[s], node.p) + price_ * arm.dwell;
    node.look_gain.push_back(node.last - look);
    node.best_gain = std::max(node.best_gain, node.look_gain.back());
  }
}

int JointSearch::idle(int at) {
  if (nodes_[static_cast<std::size_t>(at)].idle < 0) {
    const int arm = nodes_[static_cast<std::size_t>(at)].arm;
    const int next =
        add(arm, predict(problem_.arms[static_cast<std::size_t>(arm)], nodes_[static_cast<std::size_t>(at)].p));
    nodes_[static_cast<std::size_t>(at)].idle = next;
  }
  return nodes_[static_cast<std::size_t>(at)].idle;
}

int JointSearch::detected(int at, std::size_t sensor) {
  if (nodes_[static_cast<std::size_t>(at)].detected[sensor] < 0) {
    const int index = nodes_[static_cast<std::size_t>(at)].arm;
    const Arm& arm = problem_.arms[static_cast<std::size_t>(index)];
    const Matrix after = look_update(arm.sensors[sensor], nodes_[static_cast<std::size_t>(at)].p).covariance;
    const int next = add(index, predict(arm, after));
    nodes_[static_cast<std::size_t>(at)].detected[sensor] = next;
    nodes_[static_cast<std::size_t>(at)].seen_cost[sensor] = scan_cost(arm, after);
  }
  return nodes_[static_cast<std::size_t>(at)].detected[sensor];
}

/// Idle costs of all arms less the largest gains, one an arm.
double JointSearch::last_value(const Joint& joint) {
  double sum = 0.0;
  double best = -std::numeric_limits<double>::infinity();
  std::vector<double> gains;
  for (const int node : joint) {
    prepare_last(node);
    sum += nodes_[static_cast<std::size_t>(node)].last;
    best = std::max(best, nodes_[static_cast<std::size_t>(node)].best_gain);
    if (problem_.looks_per_scan > 1) gains.push_back(nodes_[static_cast<std::size_t>(node)].best_gain);
  }
  if (problem_.looks_per_scan == 1) return sum - best;
  std::partial_sort(gains.begin(), gains.begin() + problem_.looks_per_scan, gains.end(), std::greater<>());
  for (int look = 0; look < problem_.looks_per_scan; ++look) sum -= gains[static_cast<std::size_t>(look)];
  return sum;
}

/// Expected value where these looks are made now, over what each of them from `next` on may see.
double JointSearch::expand(const Joint& joint, const std::vector<Look>& looks, std::size_t next, Joint& after,
                           int depth) {
  if (next == looks.size()) return discount_ * (depth == 1 ? 0.0 : value(after, depth - 1));
  const Look& look = looks[next];
  const int node = joint[look.arm];
  const Arm& arm = problem_.arms[look.arm];
  const double p_d = arm.sensors[look.sensor].p_detect;
  const int missed = idle(node);
  after[look.arm] = detected(node, look.sensor);
  const double gain =
      nodes_[static_cast<std::size_t>(node)].cost - nodes_[static_cast<std::size_t>(node)].seen_cost[look.sensor];
  double sum = p_d * (expand(joint, looks, next + 1, after, depth) - gain);
  after[look.arm] = missed;
  if (p_d < 1.0) sum += (1.0 - p_d) * expand(joint, looks, next + 1, after, depth);
  return sum + price_ * arm.dwell;
}

double JointSearch::value_with(const Joint& joint, const std::vector<Look>& looks, int depth) {
  Joint after(joint.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < joint.size(); ++i) {
    after[i] = idle(joint[i]);
    sum += nodes_[static_cast<std::size_t>(joint[i])].cost;
  }
  return sum + expand(joint, looks, 0, after, depth);
}

double JointSearch::value(const Joint& joint, int depth) {
  if (depth == 1) return last_value(joint);
  std::vector<Look> looks;
  double best = std::numeric_limits<double>::infinity();
  for (int made = 0; made < problem_.looks_per_scan; ++made) {
    best = std::numeric_limits<double>::infinity();
    Look choice;
    looks.emplace_back();
    for (std::size_t i = 0; i < joint.size(); ++i) {
      const auto taken = [&](const Look& look) { return look.arm == i; };
      if (std::any_of(looks.begin(), looks.end() - 1, taken)) continue;
      for (std::size_t s = 0; s < problem_.arms[i].sensors.size(); ++s) {
        looks.back() = {i, s};
        const double with = value_with(joint, looks, depth);
        if (with >= best) continue;
        best = with;
        choice = looks.back();
      }
    }
    looks.back() = choice;
  }
  return best;
}

void JointSearch::gains(const std::vector<Matrix>& predicted, const std::vector<Look>& committed,
                        std::vector<std::vector<double>>& gains) {
  nodes_.clear();
  Joint joint;
  for (std::size_t i = 0; i < predicted.size(); ++i) joint.push_back(add(static_cast<int>(i), predicted[i]));
  const double without = depth_ == 1 ? 0.0 : value_with(joint, committed, depth_);
  std::vector<Look> looks = committed;
  looks.emplace_back();
  gains.resize(predicted.size());
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    if (depth_ == 1) {
      prepare_last(joint[i]);
      gains[i] = nodes_[static_cast<std::size_t>(joint[i])].look_gain;
      continue;
    }
    gains[i].resize(problem_.arms[i].sensors.size());
    for (std::size_t s = 0; s < gains[i].size(); ++s) {
      looks.back() = {i, s};
      gains[i][s] = without - value_with(joint, looks, depth_);
    }
  }
}

}  // namespace dwell::restless
