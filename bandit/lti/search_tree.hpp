#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bandit/lti/riccati.hpp"
#include "bandit/lti/solution.hpp"

namespace dwell::lti {

/// Costs that differ by less than this part of themselves are equal: then the schedule that comes first, sensor by
/// sensor, is taken. Rounding in the Riccati steps stays below it.
inline constexpr double kTie = 1e-12;

/// A place in the tree: what a schedule up to here has led to.
struct Node {
  const double* covariance;              ///< the blocks, laid out as in Riccati
  double cost;                           ///< the objective so far; where it is the final trace, tr P of this level
  std::span<const std::uint16_t> looks;  ///< taken of each sensor
  std::uint32_t parent;                  ///< place in the level above
  int choice;                            ///< of the last step
  std::uint32_t link;                    ///< into the tree's record of choices
};

/// Nodes of equal depth. As a tree grows them they are in the order of their schedules.
class Level {
 public:
  /// `depth`: steps of the problem that are taken.
  Level(std::size_t covariance_size, std::size_t sensors, int depth)
      : stride_(covariance_size), sensors_(sensors), depth_(depth) {}

  int depth() const { return depth_; }
  std::size_t size() const { return heads_.size(); }
  Node operator[](std::size_t i) const;
  void add(const Node& node);
  std::size_t bytes() const;

 private:
  struct Head {
    double cost;
    std::uint32_t parent;
    std::uint32_t link;
    int choice;
  };
  std::size_t stride_;
  std::size_t sensors_;
  int depth_;
  std::vector<Head> heads_;
  std::vector<double> covariances_;
  std::vector<std::uint16_t> looks_;
};

/// What tr P counts for in the objective: m; 1 where it is the final trace, or is summed over m blocks already.
double trace_weight(const Problem& problem);

/// Whether `choice` may be taken in a step, from 1, after these looks: a sensor with looks left, or idle (0) where that
/// is allowed.
bool feasible(const Problem& problem, std::span<const std::uint16_t> looks, int step, int choice);

/// Whether all that may follow `b` may follow `a`: of no limited sensor has it taken more looks.
bool no_more_looks(const Problem& problem, std::span<const std::uint16_t> a, std::span<const std::uint16_t> b);

/// What tells one policy from another: which children stay.
class Pruning {
 public:
  virtual ~Pruning() = default;
  /// Whether a child is stored at all; asked as it is made, in the order of the schedules.
  virtual bool admits(const Node& /*child*/) { return true; }
  /// Writes the places of the children that stay, in increasing order.
  virtual void select(const Level& parents, const Level& children, std::vector<std::size_t>& kept) = 0;
};

/// The tree of all schedules, grown level by level: sensors in their order, each while it has looks left, idle first
/// where it is allowed. All searches of this folder are this tree under one pruning or another.
///
/// Errors   std::length_error where a level would take more than its bytes, or the whole search more than its Riccati
///          steps (minutes of them): prune more.
/// Source   Chung et al. (2004), III-A.
class SearchTree {
 public:
  static constexpr std::size_t kMaximumBytes = std::size_t{1} << 28;
  static constexpr std::uint64_t kMaximumSteps = 100'000'000;

  /// Both outlive the tree.
  SearchTree(const Problem& problem, Riccati& riccati, std::size_t maximum_bytes = kMaximumBytes);

  /// The root at P[0].
  Level root();
  /// A root elsewhere: a covariance after `depth` steps, the looks already taken, nothing spent yet.
  Level root(std::span<const double> covariance, std::span<const std::uint16_t> looks, int depth);
  /// Where the search has grown too large.
  void check_steps() const;
  /// The children of all nodes that the pruning lets stay.
  Level grow(const Level& level, Pruning& pruning);
  Level grow(Level level, int steps, Pruning& pruning);
  /// From the root to the node.
  std::vector<int> schedule(const Node& node) const;

  double trace_weight() const { return trace_weight_; }
  /// The objective after a step with `choice` that led to `covariance`.
  double cost_after(double cost, int choice, const double* covariance) const;

  const Problem& problem() const { return problem_; }
  Riccati& riccati() { return riccati_; }

 private:
  struct Link {
    std::uint32_t parent;
    int choice;
  };

  const Problem& problem_;
  Riccati& riccati_;
  double trace_weight_;
  std::size_t maximum_bytes_;
  std::vector<Link> links_;
};

/// The first node of the least cost, ties as kTie says. Requires a node.
std::size_t cheapest(const Level& level);

/// The solution that the cheapest node of the last level is, evaluated anew.
Solution solution_of(SearchTree& tree, const Level& last);

}  // namespace dwell::lti
