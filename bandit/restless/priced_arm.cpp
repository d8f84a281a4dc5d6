#include "bandit/restless/priced_arm.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>

#include "bandit/restless/components.hpp"

namespace dwell::restless {
namespace {

/// What counts as a better action, as a part of the values compared: above the rounding of the evaluation.
constexpr double kBetter = 1e-11;
/// Means of cycles that differ by less, relative, are one gain.
constexpr double kSameGain = 1e-11;
/// How much of a backup goes into a relative value where misses branch.
constexpr double kLazy = 0.5;
/// Spread of the gains of all nodes at which those sweeps end, relative.
constexpr double kSwept = 1e-11;
/// Change of the value at which improvements may end while a hundredth of the points still waver, relative.
constexpr double kSettled = 1e-9;
/// Where there are more points than are kept all actions look changed: as often as this without a gain of this much,
/// relative, and the improvements end.
constexpr int kMostStalled = 2;
constexpr double kStalled = 1e-6;
/// How coarse points get where there are too many: below what PlanPoints bears.
constexpr double kCoarsest = 0.035;
/// A price that is higher than the last by more is far: from its value the search begins with waits that are much too
/// long, which may be more points than there are.
constexpr double kPriceStep = 16.0;
/// Discounted sweeps after which what is left is taken to be a constant.
constexpr int kExtrapolate = 32;
/// Idle lengths of the seeds' periodic looks.
constexpr int kSeedPeriods[] = {1, 2, 3, 4, 6, 8, 12, 16, 24};

}  // namespace

PricedArm::PricedArm(const Arm& arm, double discount, const PricedArmSettings& settings)
    : arm_(arm), discount_(discount), settings_(settings), points_(arm, discount) {
  const bool misses =
      std::any_of(arm.sensors.begin(), arm.sensors.end(), [](const Sensor& s) { return s.p_detect < 1.0; });
  finest_ = misses ? settings.same_point_with_misses : settings.same_point;
  if (arm.states() > 2) finest_ = std::max(finest_, settings.same_point_of_many_states);
  points_.set_same_point(finest_);
  const double forgotten = 1.0 - std::min(discount * all_looks(arm).memory, kMostMemory);
  most_sweeps_ = std::max(3000, static_cast<int>(40.0 / forgotten));
  seed();
}

double PricedArm::p_detect(const Node& node) const {
  return node.sensor < 0 ? 0.0 : arm_.sensors[static_cast<std::size_t>(node.sensor)].p_detect;
}

const PlanPoints::LookMap& PricedArm::look_of(std::size_t k) const {
  return points_[k].looks[static_cast<std::size_t>(nodes_[k].sensor)];
}

double PricedArm::scans(std::size_t k) const { return nodes_[k].sensor < 0 ? points_.pause(k).scans : 1.0; }

double PricedArm::next_discount(std::size_t k) const {
  return nodes_[k].sensor < 0 ? points_.pause(k).discount : discount_;
}

int PricedArm::find_or_add(const Packed& p) {
  const int k = points_.find_or_add(p);
  if (points_.size() == nodes_.size()) return k;
  nodes_.emplace_back();
  const auto count = static_cast<Eigen::Index>(points_.size());
  if (weights_.cols() < count) {
    weights_.conservativeResize(p.size(), 2 * count);
    cost_.conservativeResize(2 * count);
    work_.conservativeResize(2 * count);
  }
  weights_.col(count - 1).setZero();
  cost_[count - 1] = work_[count - 1] = 0.0;
  return k;
}

/// The point of a covariance that a node leads to; once the points are all given, the active one whose plan costs least
/// from there.
int PricedArm::node_at(const Packed& p) {
  const int found = points_.find(p);
  if (found >= 0) return found;
  if (static_cast<int>(points_.size()) < settings_.maximum_points) return find_or_add(p);
  too_many_ = true;
  return points_.nearest(p);
}

/// The first V is that of looks with every sensor in turn, without a pause, and with the gains that are right on
/// average over detections and misses: the fixed gains with a finite cost wherever some have one (Sinopoli et al. 2004,
/// IEEE Trans. AC 49(9), theorem 5). The seeds are the start and what periodic looks with longer and longer pauses
/// pass.
void PricedArm::seed() {
  const std::size_t sensors = arm_.sensors.size();
  const auto expected_after = [&](const Sensor& sensor, const Matrix& before) -> Matrix {
    const Matrix seen = look_update(sensor, before).covariance;
    return restless::predict(arm_, sensor.p_detect * seen + (1.0 - sensor.p_detect) * before);
  };
  Matrix p = all_looks(arm_).covariance;
  for (int turn = 0; turn < 300; ++turn) {
    for (const Sensor& sensor : arm_.sensors) p = expected_after(sensor, p);
  }
  std::vector<int> cycle;
  for (const Sensor& sensor : arm_.sensors) {
    const int k = find_or_add(pack_state(p));
    if (!cycle.empty() && k <= cycle.back()) break;  // sensors that are alike: one stands for them
    cycle.push_back(k);
    p = expected_after(sensor, p);
  }
  for (std::size_t i = 0; i < cycle.size(); ++i) {
    const int next = cycle[(i + 1) % cycle.size()];
    nodes_[static_cast<std::size_t>(cycle[i])] = {true, static_cast<int>(i), next, next};
  }
  if (!evaluate(0.0)) throw std::domain_error("looks in every scan have no finite cost");
  publish(0.0);

  seeds_.push_back(find_or_add(pack_state(arm_.p0)));
  for (std::size_t s = 0; s < sensors; ++s) {
    for (const int period : kSeedPeriods) {
      for (int turn = 0; turn < 2; ++turn) {
        for (int t = 0; t < period; ++t) {
          if (t > 0) p = restless::predict(arm_, p);
          if (turn == 1 && (t + 1 == period || (t & (t - 1)) == 0)) seeds_.push_back(find_or_add(pack_state(p)));
        }
        p = restless::predict(arm_, look_update(arm_.sensors[s], p).covariance);
      }
    }
  }
}

/// One scan's cost, what follows by V and the look's price; `idle` is that of the idle action.
double PricedArm::action_cost(const PlanPoints::Point& point, int sensor, double idle, double price) const {
  const PlanPoints::LookMap& look = point.looks[static_cast<std::size_t>(sensor)];
  const double p_d = arm_.sensors[static_cast<std::size_t>(sensor)].p_detect;
  const double seen = look.cost.dot(point.p) + look.cost_noise + discount_ * value_.value(look.successor);
  return p_d * seen + (1.0 - p_d) * idle + price * arm_.dwell;
}

/// Gives the node its action and finds its successors. Whether the action changed.
bool PricedArm::choose(std::size_t k, double price, Rule rule) {
  const bool was_active = nodes_[k].active;
  const int before = nodes_[k].sensor;
  const double idle = points_.scan_cost().dot(points_[k].p) + discount_ * value_.value(points_[k].idle_successor);
  double least = idle;
  double kept = idle;
  int best = -1;
  for (int s = 0; s < static_cast<int>(arm_.sensors.size()); ++s) {
    const double cost = action_cost(points_[k], s, idle, price);
    if (s == before) kept = cost;
    if (cost < least) {
      least = cost;
      best = s;
    }
  }
  if (was_active && least >= kept - kBetter * std::abs(kept)) best = before;
  if (rule == Rule::kPlanned) best = published_sensor_[static_cast<std::size_t>(value_.best_plan(points_[k].p))];
  Node node{true, best, 0, 0};
  const double p_d = best < 0 ? 0.0 : arm_.sensors[static_cast<std::size_t>(best)].p_detect;
  // Copies: a new point may move the old ones.
  const Packed idle_successor = points_[k].idle_successor;
  const Packed pause_successor = points_[k].pause_successor;
  if (p_d > 0.0) {
    const Packed detected = points_[k].looks[static_cast<std::size_t>(best)].successor;
    node.detected = node_at(detected);
  }
  if (best < 0) {
    node.detected = node.missed = node_at(pause_successor);
  } else {
    node.missed = p_d < 1.0 ? node_at(idle_successor) : node.detected;
  }
  nodes_[k] = node;
  return !was_active || best != before;
}

/// All points but the seeds are forgotten; what is one point from now on.
void PricedArm::restart(double same_point) {
  std::vector<Packed> starts;
  for (const int k : seeds_) starts.push_back(points_[static_cast<std::size_t>(k)].p);
  points_.restart(same_point);
  nodes_.clear();
  for (std::size_t i = 0; i < starts.size(); ++i) seeds_[i] = find_or_add(starts[i]);
}

/// The policy's graph from all seeds; what it does not reach is forgotten. How many actions changed.
std::size_t PricedArm::follow(double price, Rule rule) {
  too_many_ = false;
  std::vector<char> reached(points_.size(), 0);
  std::vector<int> open = seeds_;
  for (const int k : open) reached[static_cast<std::size_t>(k)] = 1;
  std::size_t changed = 0;
  while (!open.empty()) {
    const auto k = static_cast<std::size_t>(open.back());
    open.pop_back();
    if (choose(k, price, rule)) ++changed;
    reached.resize(points_.size(), 0);
    for (const int next : {nodes_[k].detected, nodes_[k].missed}) {
      char& seen = reached[static_cast<std::size_t>(next)];
      if (seen == 0) open.push_back(next);
      seen = 1;
    }
  }
  keep_only(reached);
  return changed;
}

void PricedArm::keep_only(const std::vector<char>& reached) {
  std::vector<int> place(points_.size(), -1);
  int count = 0;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (reached[k] == 0) continue;
    const auto to = static_cast<std::size_t>(count);
    if (to != k) {
      nodes_[to] = nodes_[k];
      weights_.col(count) = weights_.col(static_cast<Eigen::Index>(k));
      cost_[count] = cost_[static_cast<Eigen::Index>(k)];
      work_[count] = work_[static_cast<Eigen::Index>(k)];
    }
    place[k] = count++;
  }
  points_.keep_only(reached);
  nodes_.resize(static_cast<std::size_t>(count));
  for (Node& node : nodes_) {
    node.detected = place[static_cast<std::size_t>(node.detected)];
    node.missed = place[static_cast<std::size_t>(node.missed)];
  }
  for (int& seed : seeds_) seed = place[static_cast<std::size_t>(seed)];
}

/// The weights that a node's action and successors give it, from theirs.
Packed PricedArm::backed_up_weight(std::size_t k) const {
  const Node& node = nodes_[k];
  if (node.sensor < 0) {
    const PlanPoints::Pause& pause = points_.pause(k);
    return pause.cost + pause.discount * (pause.after.transpose() * weights_.col(node.missed));
  }
  const double p_d = p_detect(node);
  Packed l = Packed::Zero(points_.noise().size());
  if (p_d < 1.0)
    l = (1.0 - p_d) * (points_.scan_cost() + discount_ * (points_.idle_map().transpose() * weights_.col(node.missed)));
  const PlanPoints::LookMap& look = look_of(k);
  l += p_d * (look.cost + discount_ * (look.after.transpose() * weights_.col(node.detected)));
  return l;
}

/// All L of the controller, to rounding, component by component. A loop of plans that never looks at an unstable arm
/// has none: its nodes, and what leads to them, are not kept. Whether any is.
bool PricedArm::solve_weights() {
  constexpr double kConverged = 1e-9;
  constexpr double kEndless = 1e100;
  std::vector<std::array<std::size_t, 2>> successors;
  for (const Node& node : nodes_) {
    successors.push_back({static_cast<std::size_t>(node.detected), static_cast<std::size_t>(node.missed)});
  }
  const Components components = strongly_connected(successors);
  kept_.assign(nodes_.size(), 1);
  std::size_t first = 0;
  for (const std::size_t end : components.ends) {
    const std::span<const std::size_t> component(components.order.data() + first, end - first);
    first = end;
    bool finite = std::all_of(component.begin(), component.end(), [&](std::size_t k) {
      return kept_[static_cast<std::size_t>(nodes_[k].detected)] != 0 &&
             kept_[static_cast<std::size_t>(nodes_[k].missed)] != 0;
    });
    double change = 1.0;
    for (int sweep = 0; finite && sweep < most_sweeps_ && change >= 1e-13; ++sweep) {
      change = 0.0;
      for (const std::size_t k : component) {
        const Packed l = backed_up_weight(k);
        const double scale = l.cwiseAbs().maxCoeff();
        auto column = weights_.col(static_cast<Eigen::Index>(k));
        change = std::max(change, (l - column).cwiseAbs().maxCoeff() / (scale > 0.0 ? scale : 1.0));
        column = l;
        finite = finite && scale < kEndless;
      }
      const bool alone = component.size() == 1 && nodes_[component[0]].detected != static_cast<int>(component[0]) &&
                         nodes_[component[0]].missed != static_cast<int>(component[0]);
      if (alone) change = 0.0;
    }
    for (const std::size_t k : component) kept_[k] = finite && change < kConverged ? 1 : 0;
  }
  return std::find(kept_.begin(), kept_.end(), 1) != kept_.end();
}

void PricedArm::immediate() {
  const auto count = static_cast<Eigen::Index>(nodes_.size());
  cost_now_.setZero(count);
  work_now_.setZero(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Node& node = nodes_[static_cast<std::size_t>(k)];
    if (kept_[static_cast<std::size_t>(k)] == 0) continue;
    if (node.sensor < 0) {
      const PlanPoints::Pause& pause = points_.pause(static_cast<std::size_t>(k));
      cost_now_[k] = pause.cost_noise + pause.discount * weights_.col(node.missed).dot(pause.noise);
      continue;
    }
    const double p_d = p_detect(node);
    if (p_d < 1.0) cost_now_[k] += (1.0 - p_d) * discount_ * weights_.col(node.missed).dot(points_.noise());
    const PlanPoints::LookMap& look = look_of(static_cast<std::size_t>(k));
    cost_now_[k] += p_d * (look.cost_noise + discount_ * weights_.col(node.detected).dot(look.after_noise));
    work_now_[k] = arm_.dwell;
  }
}

bool PricedArm::deterministic() const {
  return std::all_of(nodes_.begin(), nodes_.end(),
                     [&](const Node& node) { return node.sensor < 0 || p_detect(node) == 1.0; });
}

/// Whether a plan has a finite cost.
bool PricedArm::evaluate(double price) {
  if (!solve_weights()) return false;
  immediate();
  if (deterministic()) {
    solve_constants_by_cycles(price);
  } else {
    solve_constants_by_sweeps(price);
  }
  return true;
}

/// One successor a node: every walk ends in a cycle. Average cost: its mean is the gain of all that lead to it.
/// Discounted: what one turn costs, over 1 - b^length, is the constant of its first node.
void PricedArm::solve_constants_by_cycles(double price) {
  const bool average = discount_ == 1.0;
  std::vector<int> cycle_of(nodes_.size(), -1);
  std::vector<int> walk_of(nodes_.size(), -1);
  std::vector<PricedValue> means;
  std::vector<std::size_t> walk;
  const auto successor = [&](std::size_t k) { return static_cast<std::size_t>(nodes_[k].detected); };
  const auto close = [&](std::size_t k) {
    PricedValue turn;
    double length = 0.0;
    double power = 1.0;
    std::size_t j = k;
    do {
      turn.cost += power * cost_now_[static_cast<Eigen::Index>(j)];
      turn.usage += power * work_now_[static_cast<Eigen::Index>(j)];
      length += scans(j);
      power *= next_discount(j);
      j = successor(j);
    } while (j != k);
    const auto at = static_cast<Eigen::Index>(k);
    cost_[at] = average ? -weights_.col(at).dot(points_[k].p) : turn.cost / (1.0 - power);
    work_[at] = average ? 0.0 : turn.usage / (1.0 - power);
    means.push_back(average ? PricedValue{turn.cost / length, turn.usage / length} : PricedValue{});
  };
  for (std::size_t start = 0; start < nodes_.size(); ++start) {
    if (kept_[start] == 0) continue;
    walk.clear();
    std::size_t k = start;
    while (cycle_of[k] < 0 && walk_of[k] != static_cast<int>(start)) {
      walk_of[k] = static_cast<int>(start);
      walk.push_back(k);
      k = successor(k);
    }
    if (cycle_of[k] < 0) {  // a new cycle, through k
      cycle_of[k] = static_cast<int>(means.size());
      close(k);
    }
    for (auto node = walk.rbegin(); node != walk.rend(); ++node) {
      if (cycle_of[*node] >= 0) continue;
      const std::size_t next = successor(*node);
      cycle_of[*node] = cycle_of[next];
      const PricedValue& mean = means[static_cast<std::size_t>(cycle_of[next])];
      const auto at = static_cast<Eigen::Index>(*node);
      const auto to = static_cast<Eigen::Index>(next);
      cost_[at] = cost_now_[at] - scans(*node) * mean.cost + next_discount(*node) * cost_[to];
      work_[at] = work_now_[at] - scans(*node) * mean.usage + next_discount(*node) * work_[to];
    }
  }
  if (!average) return;
  mean_ = *std::min_element(means.begin(), means.end(), [&](const PricedValue& a, const PricedValue& b) {
    return a.total(price) < b.total(price);
  });
  const double least = mean_.total(price);
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    if (kept_[k] == 0) continue;
    const double mean = means[static_cast<std::size_t>(cycle_of[k])].total(price);
    if (mean - least > kSameGain * std::abs(least)) kept_[k] = 0;
  }
}

/// The same where a node has two successors, by lazy value iteration of the fixed controller. A pause counts for as
/// many scans as it has (Schweitzer's transformation). Discounted, what is left is close to a constant after some
/// sweeps: it is added at once.
void PricedArm::solve_constants_by_sweeps(double price) {
  const bool average = discount_ == 1.0;
  const int most = average ? 20'000 : std::max(20'000, static_cast<int>(40.0 / (kLazy * (1.0 - discount_))));
  const auto count = static_cast<Eigen::Index>(nodes_.size());
  Eigen::VectorXd more_cost = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd more_work = Eigen::VectorXd::Zero(count);
  // A kept node: those of the first cycle are.
  const Eigen::Index reference = std::find(kept_.begin(), kept_.end(), 1) - kept_.begin();
  for (int step = 0; step < most; ++step) {
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const Node& node = nodes_[at];
      if (kept_[at] == 0) continue;
      const double p_d = p_detect(node);
      const double discount = next_discount(at);
      const double length = scans(at);
      const auto expected = [&](const Eigen::VectorXd& c) {
        return discount * (p_d * c[node.detected] + (1.0 - p_d) * c[node.missed]) - c[k];
      };
      more_cost[k] = (cost_now_[k] + expected(cost_)) / length;
      more_work[k] = (work_now_[k] + expected(work_)) / length;
    }
    cost_.head(count) += kLazy * more_cost;
    work_.head(count) += kLazy * more_work;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    double scale = 0.0;
    for (Eigen::Index k = 0; k < count; ++k) {
      if (kept_[static_cast<std::size_t>(k)] == 0) continue;
      low = std::min(low, more_cost[k] + price * more_work[k]);
      high = std::max(high, more_cost[k] + price * more_work[k]);
      scale = std::max(scale, std::abs(cost_[k] + price * work_[k]));
    }
    if (average) {
      mean_ = {more_cost[reference], more_work[reference]};
      cost_.head(count).array() -= cost_[reference];
      work_.head(count).array() -= work_[reference];
      if (high - low <= kSwept * std::abs(high)) break;
    } else {
      if (std::max(-low, high) <= 1e-15 * scale) break;
      if (step % kExtrapolate == kExtrapolate - 1) {
        cost_.head(count).array() += more_cost[reference] / (1.0 - discount_);
        work_.head(count).array() += more_work[reference] / (1.0 - discount_);
      }
    }
  }
}

void PricedArm::publish(double price) {
  std::vector<Eigen::Index> kept;
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    if (kept_[k] != 0) kept.push_back(static_cast<Eigen::Index>(k));
  }
  published_cost_ = cost_(kept);
  published_work_ = work_(kept);
  published_sensor_.clear();
  for (const Eigen::Index k : kept) published_sensor_.push_back(nodes_[static_cast<std::size_t>(k)].sensor);
  value_ = ValueSet(weights_(Eigen::all, kept), published_cost_ + price * published_work_);
}

/// Whether V is below the plan made at some point, by more than what a covariance that counts as this one may differ.
bool PricedArm::postpones(double price) const {
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    if (kept_[k] == 0) continue;
    const auto at = static_cast<Eigen::Index>(k);
    const double linear = weights_.col(at).dot(points_[k].p);
    const double planned = linear + cost_[at] + price * work_[at];
    if (planned - value_.value(points_[k].p) > points_.same_point() * linear) return true;
  }
  return false;
}

PricedValue PricedArm::solve(double price) {
  const bool far = !(price <= kPriceStep * price_);
  const double from = price_ > 0.0 ? price_ : gain_of_all_looks();
  const PricedValue value = improve(price_ = price);
  if (!far || !full_ || from <= 0.0) return value;
  // Waits were much too long for the points: from a price that is near.
  const double steps = std::ceil(std::log(price / from) / std::log(kPriceStep));
  for (double step = 1.0; step < steps; ++step) (void)improve(from * std::pow(price / from, step / steps));
  return improve(price);
}

/// Per dwell, in a scan in which every look before was made.
double PricedArm::gain_of_all_looks() const {
  const Matrix settled = all_looks(arm_).covariance;
  double gain = 0.0;
  for (const Sensor& sensor : arm_.sensors) {
    gain = std::max(gain, scan_cost(arm_, settled) - expected_scan_cost(arm_, sensor, settled));
  }
  return gain / arm_.dwell;
}

/// Policy iteration at a price, from the last V. Where points stand for others it is no descent: the best V counts.
PricedValue PricedArm::improve(double price) {
  struct {
    PricedValue total;
    ValueSet value;
    Eigen::VectorXd cost, work;
    std::vector<int> sensor;
  } best;
  PricedValue value;
  Rule rule = Rule::kGreedy;
  int stalled = 0;
  for (int improvement = 0; improvement < settings_.improvements && stalled < kMostStalled; ++improvement) {
    points_.set_same_point(std::max(finest_, 0.5 * points_.same_point()));
    std::size_t changed = follow(price, rule);
    full_ = too_many_;
    if (full_) {  // those of the policy before count as well
      restart(points_.same_point());
      changed = follow(price, rule);
    }
    while (too_many_ && points_.same_point() < kCoarsest) {
      restart(std::min(2.0 * points_.same_point(), kCoarsest));
      changed = follow(price, rule);
    }
    if (evaluate(price)) {
      publish(price);
    } else {
      value_ = ValueSet(value_.weights(), published_cost_ + price * published_work_);
    }
    const double before = value.total(price);
    value = mean_;
    if (discount_ < 1.0) {
      const Packed start = pack_state(arm_.p0);
      const Eigen::Index plan = value_.best_plan(start);
      value = {value_.weights().col(plan).dot(start) + published_cost_[plan], published_work_[plan]};
    }
    const double least = best.total.total(price);
    stalled = full_ && improvement > 0 && value.total(price) > (1.0 - kStalled) * least ? stalled + 1 : 0;
    if (improvement == 0 || value.total(price) <= least)
      best = {value, value_, published_cost_, published_work_, published_sensor_};
    const bool settled = std::abs(value.total(price) - before) <= kSettled * std::abs(before);
    const bool ended = changed == 0 || (settled && 100 * changed < points_.size());
    const bool in_vain = rule == Rule::kPlanned && (ended || value.total(price) > (1.0 - kStalled) * least);
    if (in_vain || (ended && !postpones(price))) break;
    rule = ended ? Rule::kPlanned : Rule::kGreedy;
  }
  value_ = std::move(best.value);
  published_cost_ = std::move(best.cost);
  published_work_ = std::move(best.work);
  published_sensor_ = std::move(best.sensor);
  return best.total;
}

}  // namespace dwell::restless
