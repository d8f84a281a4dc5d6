#pragma once

#include <stdexcept>

#include "bandit/search/pruning.hpp"

namespace dwell::search {

/// What branch and bound needs to know of a problem.
template <class Scalar>
class Bounds {
 public:
  virtual ~Bounds() = default;
  /// No schedule through the node, with `left` steps to come, costs less. A bound over `enough` need not be made
  /// better.
  virtual double bound(const Node<Scalar>& node, int left, double enough) = 0;
  /// Whatever follows the node may follow the rival, which is of the same level, and leaves covariances nowhere above.
  virtual bool serves_as_well(const Node<Scalar>& rival, const Node<Scalar>& node) = 0;
};

/// Drops a node
/// - whose bound exceeds the cost of a schedule at hand, or
/// - where another one of its level costs no more and serves as well. Of two that tie the first in order stays.
/// What is left at the end holds a schedule of the least cost; with a `width`, that of the least bounds, it may not.
template <class Scalar>
class BoundPruning final : public Pruning<Scalar> {
 public:
  /// `bounds` outlives the pruning. A node is compared with so many others of its level: more find a few more that
  /// serve as well, and cost their square.
  BoundPruning(Bounds<Scalar>& bounds, std::size_t rivals) : bounds_(bounds), rivals_(rivals) {}

  /// `steps` are those from the root to the end.
  void begin(int steps, double at_hand, std::size_t width = std::numeric_limits<std::size_t>::max()) {
    left_ = steps;
    at_hand_ = at_hand;
    width_ = width;
    of_children_.clear();
  }

  bool admits(const Node<Scalar>& child) override {
    const double enough = at_hand_ * (1.0 + kRounding);
    const double bound = bounds_.bound(child, left_ - 1, enough);
    if (bound > enough) return false;
    of_children_.push_back(bound);
    return true;
  }

  void select(const Level<Scalar>& /*parents*/, const Level<Scalar>& children,
              std::vector<std::size_t>& kept) override {
    order_.resize(children.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::sort(order_.begin(), order_.end(), [&](std::size_t i, std::size_t j) {
      return of_children_[i] != of_children_[j] ? of_children_[i] < of_children_[j] : i < j;
    });
    for (const std::size_t i : order_) {
      if (kept.size() == width_) break;
      const auto rivals = kept.begin() + static_cast<std::ptrdiff_t>(std::min(kept.size(), rivals_));
      const bool beaten =
          std::any_of(kept.begin(), rivals, [&](std::size_t rival) { return dominates(children, rival, i); });
      if (!beaten) kept.push_back(i);
      if (kept.size() > kMaximumNodes) {
        throw std::length_error(
            "the search keeps more than 100 thousand schedules in one step: take a shorter horizon or window, beam or "
            "relaxed_dp");
      }
    }
    std::sort(kept.begin(), kept.end());
    of_children_.clear();
    --left_;
  }

 private:
  // A bound must exceed the schedule at hand by more than the rounding of either, relative.
  static constexpr double kRounding = 1e-10;
  // Of a level: each of their children meets its rivals, in seconds a level.
  static constexpr std::size_t kMaximumNodes = 100'000;

  bool dominates(const Level<Scalar>& level, std::size_t rival, std::size_t node) const {
    // A later one must win by more than what ties.
    const double slack = rival < node ? kTie * level[node].cost : -10.0 * kTie * at_hand_;
    return level[rival].cost <= level[node].cost + slack && bounds_.serves_as_well(level[rival], level[node]);
  }

  Bounds<Scalar>& bounds_;
  std::size_t rivals_;
  int left_ = 0;  // steps from the parents' level
  double at_hand_ = 0.0;
  std::size_t width_ = 0;
  std::vector<double> of_children_;  // bounds of those stored so far
  std::vector<std::size_t> order_;
};

}  // namespace dwell::search
