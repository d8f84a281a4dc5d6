#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bandit/lti/riccati.hpp"
#include "bandit/lti/solution.hpp"
#include "bandit/search/search_tree.hpp"

namespace dwell::lti {

using search::kTie;
using Node = search::Node<double>;  ///< its state: the blocks of covariances, laid out as in Riccati
using Level = search::Level<double>;
using Pruning = search::Pruning<double>;

/// What tr P counts for in the objective: m; 1 where it is the final trace, or is summed over m blocks already.
double trace_weight(const Problem& problem);

/// Whether `choice` may be taken in a step, from 1, after these looks: a sensor with looks left, or idle (0) where that
/// is allowed.
bool feasible(const Problem& problem, std::span<const std::uint16_t> looks, int step, int choice);

/// Whether all that may follow `b` may follow `a`: of no limited sensor has it taken more looks.
bool no_more_looks(const Problem& problem, std::span<const std::uint16_t> a, std::span<const std::uint16_t> b);

/// One linear system: what the tree of its schedules moves on. Choices are sensors, `looks` counts those taken of each.
class LinearDynamics {
 public:
  using Scalar = double;

  /// Both outlive this.
  LinearDynamics(const Problem& problem, Riccati& riccati)
      : problem_(problem), riccati_(riccati), trace_weight_(lti::trace_weight(problem)) {}

  std::size_t size() const { return riccati_.size(); }
  std::size_t sensors() const { return problem_.sensors.size(); }
  int choices() const { return problem_.sensor_count(); }
  bool feasible(const Node& node, int step, int choice) const {
    return lti::feasible(problem_, node.looks, step, choice);
  }
  void step(const Node& node, int step, int choice, double* to, std::vector<std::uint16_t>& looks);
  double cost_after(const Node& node, int /*step*/, int choice, const double* covariance) const {
    return cost_after(node.cost, choice, covariance);
  }
  /// The objective after a step with `choice` that led to `covariance`.
  double cost_after(double cost, int choice, const double* covariance) const;
  /// Where the search has taken more than kMaximumSteps.
  void check() const;

  static constexpr std::uint64_t kMaximumSteps = 100'000'000;

  const Problem& problem() const { return problem_; }
  Riccati& riccati() const { return riccati_; }
  double trace_weight() const { return trace_weight_; }

 private:
  const Problem& problem_;
  Riccati& riccati_;
  double trace_weight_;
};

/// The tree of all schedules of a problem, level by level: sensors in their order, each while it has looks left, idle
/// first where it is allowed. All searches of this folder are this tree under one pruning or another.
///
/// Errors   std::length_error where a level would take more than its bytes, or the whole search more than its Riccati
///          steps (minutes of them): prune more.
class SearchTree {
 public:
  static constexpr std::size_t kMaximumBytes = search::SearchTree<LinearDynamics>::kMaximumBytes;

  /// Both outlive the tree.
  SearchTree(const Problem& problem, Riccati& riccati, std::size_t maximum_bytes = kMaximumBytes)
      : dynamics_(problem, riccati), tree_(dynamics_, maximum_bytes) {}

  /// The root at P[0].
  Level root();
  /// A root elsewhere: a covariance after `depth` steps, the looks already taken, nothing spent yet.
  Level root(std::span<const double> covariance, std::span<const std::uint16_t> looks, int depth);
  /// What the pruning lets stay after a step, or so many.
  Level grow(Level level, Pruning& pruning) { return grow(std::move(level), 1, pruning); }
  Level grow(Level level, int steps, Pruning& pruning) {
    tree_.grow(level, steps, pruning);
    return level;
  }
  /// From the root to the node.
  std::vector<int> schedule(const Node& node) const { return tree_.schedule(node); }

  double trace_weight() const { return dynamics_.trace_weight(); }
  double cost_after(double cost, int choice, const double* covariance) const {
    return dynamics_.cost_after(cost, choice, covariance);
  }
  /// Where the search has grown too large.
  void check_steps() const { dynamics_.check(); }
  const Problem& problem() const { return dynamics_.problem(); }
  Riccati& riccati() { return dynamics_.riccati(); }

 private:
  LinearDynamics dynamics_;
  search::SearchTree<LinearDynamics> tree_;
};

/// The solution that the cheapest node of the last level is, evaluated anew.
Solution solution_of(SearchTree& tree, const Level& last);

}  // namespace dwell::lti
