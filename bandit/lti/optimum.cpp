#include "bandit/lti/optimum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "bandit/lti/beam.hpp"
#include "bandit/lti/time_sharing.hpp"
#include "bandit/search/bound_pruning.hpp"

namespace dwell::lti {
namespace {

// Nodes of a level that one is compared with in the Loewner order: more find a few more, and cost their square.
constexpr std::size_t kRivals = 200;

/// Of a sum objective, as the header says.
class SumBounds final : public search::Bounds<double> {
 public:
  SumBounds(SearchTree& tree, TimeSharing& sharing) : tree_(tree), sharing_(sharing) {
    for (const Sensor& sensor : tree.problem().sensors) cheapest_use_ = std::min(cheapest_use_, sensor.cost);
    if (tree.problem().allow_idle) cheapest_use_ = 0.0;
  }

  double bound(const Node& node, int left, double enough) override {
    const double shared = node.cost + sharing_.bound(node, left);
    return shared > enough ? shared : std::max(shared, bound_with_all(node, left, enough));
  }

  bool serves_as_well(const Node& rival, const Node& node) override {
    if (!no_more_looks(tree_.problem(), rival.looks, node.looks)) return false;
    for (int block = 0; block < tree_.riccati().blocks(); ++block) {
      if (!below(rival.state, node.state, block)) return false;
    }
    return true;
  }

 private:
  /// The Riccati-monotone bound: the looks of all sensors in all steps that are left.
  double bound_with_all(const Node& node, int left, double enough) {
    double cost = node.cost + left * cheapest_use_;
    covariance_.assign(node.state, node.state + tree_.riccati().size());
    for (int step = 0; step < left && cost <= enough; ++step) {
      tree_.riccati().step_with_all(covariance_.data(), covariance_.data());
      cost += tree_.trace_weight() * tree_.riccati().trace(covariance_.data());
    }
    return cost;
  }

  /// Loewner order of one block, within rounding relative to its trace.
  bool below(const double* low, const double* high, int block) const {
    const int n = tree_.riccati().states();
    const std::size_t offset = static_cast<std::size_t>(block) * tree_.riccati().block_size();
    const Eigen::Map<const Eigen::MatrixXd> p_low(low + offset, n, n);
    const Eigen::Map<const Eigen::MatrixXd> p_high(high + offset, n, n);
    const double slack = 1e-13 * p_high.trace();
    for (int i = 0; i < n; ++i) {
      if (p_low(i, i) > p_high(i, i) + slack) return false;
    }
    Matrix gap = p_high - p_low;
    gap.diagonal().array() += slack;
    return Eigen::LLT<Matrix>(gap).info() == Eigen::Success;
  }

  SearchTree& tree_;
  TimeSharing& sharing_;
  double cheapest_use_ = std::numeric_limits<double>::infinity();
  std::vector<double> covariance_;
};

std::vector<int> best_of_tree(SearchTree& tree, const Level& root, int steps, Pruning& pruning) {
  const Level last = tree.grow(root, steps, pruning);
  return tree.schedule(last[cheapest(last)]);
}

std::vector<int> best_of_sum(SearchTree& tree, const Level& root, int steps) {
  constexpr double kNothing = std::numeric_limits<double>::max();
  TimeSharing sharing(tree, root[0], steps);
  SumBounds bounds(tree, sharing);
  search::BoundPruning<double> pruning(bounds, kRivals);
  pruning.begin(steps, kNothing, kGuideWidth);
  const Level at_hand = tree.grow(root, steps, pruning);
  const std::vector<int> best = tree.schedule(at_hand[cheapest(at_hand)]);
  pruning.begin(steps, at_hand[cheapest(at_hand)].cost);
  const Level last = tree.grow(root, steps, pruning);
  // None left: rounding of a bound has dropped the schedule at hand, and with it all that cost less by no more.
  return last.size() > 0 ? tree.schedule(last[cheapest(last)]) : best;
}

/// The end of a schedule, in the order of its steps.
struct Suffix {
  std::vector<std::uint8_t> choices;
  std::vector<std::uint16_t> looks;
};

/// Of the final trace, as the header says.
class SuffixSearch {
 public:
  SuffixSearch(SearchTree& tree, const Level& root, int steps)
      : tree_(tree), root_(root[0]), depth_(root.depth()), steps_(steps) {
    BeamPruning beam(kGuideWidth);
    best_ = best_of_tree(tree, root, steps, beam);
    std::vector<double> covariance(root_.state, root_.state + tree.riccati().size());
    std::vector<std::uint16_t> looks(root_.looks.begin(), root_.looks.end());
    lowest_.push_back(covariance);
    at_hand_.push_back(covariance);
    looks_.push_back(looks);
    for (const int choice : best_) {
      tree.riccati().step_with_all(lowest_.back().data(), covariance.data());
      lowest_.push_back(covariance);
      tree.riccati().step(at_hand_.back().data(), choice, covariance.data());
      at_hand_.push_back(covariance);
      if (choice > 0) ++looks[static_cast<std::size_t>(choice - 1)];
      looks_.push_back(looks);
    }
    value_ = tree.riccati().trace(at_hand_.back().data());
  }

  std::vector<int> run() {
    std::vector<Suffix> suffixes{{{}, std::vector<std::uint16_t>(root_.looks.size(), 0)}};
    for (int first = steps_ - 1; first >= 0; --first) {
      std::vector<Suffix> longer;
      for (const Suffix& suffix : suffixes) extend(suffix, static_cast<std::size_t>(first), longer);
      suffixes = std::move(longer);
    }
    return best_;
  }

 private:
  void extend(const Suffix& suffix, std::size_t first, std::vector<Suffix>& longer) {
    Suffix next;
    for (int choice = tree_.problem().allow_idle ? 0 : 1; choice <= tree_.problem().sensor_count(); ++choice) {
      next.choices.assign(1, static_cast<std::uint8_t>(choice));
      next.choices.insert(next.choices.end(), suffix.choices.begin(), suffix.choices.end());
      next.looks = suffix.looks;
      if (choice > 0) ++next.looks[static_cast<std::size_t>(choice - 1)];
      if (!within_budgets(next.looks)) continue;
      if (feasible_after(looks_[first], first, next)) offer(next, first);
      if (trace_after(lowest_[first], next) >= value_ * (1.0 - kTie)) continue;
      tree_.check_steps();
      if (longer.size() * (sizeof(Suffix) + 64) > SearchTree::kMaximumBytes) {
        throw std::length_error("the search keeps more than " + std::to_string(longer.size()) +
                                " ends of schedules: take beam or relaxed_dp");
      }
      longer.push_back(next);
    }
  }

  /// Of a suffix, whatever comes before it.
  bool within_budgets(std::span<const std::uint16_t> looks) const {
    const Problem& problem = tree_.problem();
    for (int j = 1; j <= problem.sensor_count(); ++j) {
      const auto place = static_cast<std::size_t>(j - 1);
      if (root_.looks[place] + looks[place] > looks_by(problem, j, problem.horizon)) return false;
    }
    return true;
  }

  bool feasible_after(std::vector<std::uint16_t> looks, std::size_t first, const Suffix& suffix) const {
    int step = depth_ + static_cast<int>(first);
    for (const std::uint8_t choice : suffix.choices) {
      if (!feasible(tree_.problem(), looks, ++step, choice)) return false;
      if (choice > 0) ++looks[static_cast<std::size_t>(choice - 1)];
    }
    return true;
  }

  double trace_after(const std::vector<double>& start, const Suffix& suffix) {
    covariance_ = start;
    for (const std::uint8_t choice : suffix.choices) {
      tree_.riccati().step(covariance_.data(), choice, covariance_.data());
    }
    return tree_.riccati().trace(covariance_.data());
  }

  /// The suffix after the first steps of the schedule at hand is a schedule: the best so far?
  void offer(const Suffix& suffix, std::size_t first) {
    const double value = trace_after(at_hand_[first], suffix);
    if (!(value < value_ * (1.0 - kTie))) return;
    value_ = value;
    // The covariances at hand are of the first schedule at hand, whose beginning any best one keeps.
    best_.resize(first);
    best_.insert(best_.end(), suffix.choices.begin(), suffix.choices.end());
  }

  SearchTree& tree_;
  Node root_;
  int depth_;
  int steps_;
  std::vector<std::vector<double>> lowest_;        // under all sensors, after each step
  std::vector<std::vector<double>> at_hand_;       // under the schedule at hand
  std::vector<std::vector<std::uint16_t>> looks_;  // of that schedule, and before
  double value_ = 0.0;
  std::vector<int> best_;
  std::vector<double> covariance_;
};

}  // namespace

std::vector<int> best_schedule(SearchTree& tree, const Level& root, int steps) {
  const Problem& problem = tree.problem();
  if (std::pow(problem.sensor_count() + (problem.allow_idle ? 1 : 0), steps) <= kSmallTree) {
    search::Everything<double> everything;
    return best_of_tree(tree, root, steps, everything);
  }
  if (problem.objective == Objective::kSum) return best_of_sum(tree, root, steps);
  return SuffixSearch(tree, root, steps).run();
}

Solution optimum(const Problem& problem) {
  Riccati riccati(problem);
  SearchTree tree(problem, riccati);
  const std::vector<double> initial = riccati.initial();
  const std::vector<std::uint16_t> no_looks(problem.sensors.size(), 0);
  const Level root = tree.root(initial, no_looks, 0);
  Solution solution = evaluate(problem, best_schedule(tree, root, problem.horizon));
  solution.expanded = riccati.steps();
  return solution;
}

}  // namespace dwell::lti
