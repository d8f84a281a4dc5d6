#pragma once

#include <concepts>
#include <stdexcept>
#include <string>
#include <utility>

#include "bandit/search/pruning.hpp"

namespace dwell::search {

/// What a tree of schedules moves on.
///
///   Scalar                              a state is `size()` of them
///   choices()                           the largest choice; 0 is idle
///   feasible(node, step, choice)        whether the choice may be taken in the step, from 1, that follows a node
///   step(node, step, choice, to, looks) the state it leads to; `looks` comes as the node's
///   cost_after(node, step, choice, to)  the objective after it
///   check()                             throws std::length_error where the search has taken too much
///
/// Models  lti::LinearDynamics (one system, many sensors), TrackDynamics (many tracks, many sensors).
template <class D>
concept Dynamics = requires(D& dynamics, const Node<typename D::Scalar>& node, typename D::Scalar* to,
                            std::vector<std::uint16_t>& looks) {
  { dynamics.size() } -> std::convertible_to<std::size_t>;
  { dynamics.sensors() } -> std::convertible_to<std::size_t>;
  { dynamics.choices() } -> std::convertible_to<int>;
  { dynamics.feasible(node, 1, 0) } -> std::convertible_to<bool>;
  dynamics.step(node, 1, 0, to, looks);
  { dynamics.cost_after(node, 1, 0, to) } -> std::convertible_to<double>;
  dynamics.check();
};

/// The tree of all schedules, grown level by level: idle first, then the choices in their order, each while it is
/// feasible. All searches are this tree under one pruning or another.
///
/// Errors   std::length_error where a level would take more than its bytes, or where the dynamics has enough: prune
/// more. Cost     no allocation once the levels have grown. Source   Chung et al. (2004), III-A.
template <class D>
class SearchTree {
 public:
  static_assert(Dynamics<D>);
  using Scalar = typename D::Scalar;
  static constexpr std::size_t kMaximumBytes = std::size_t{1} << 28;

  /// `dynamics` outlives the tree.
  explicit SearchTree(D& dynamics, std::size_t maximum_bytes = kMaximumBytes)
      : dynamics_(dynamics), maximum_bytes_(maximum_bytes), children_(0, 0, 0) {}

  /// One node alone at `depth` steps; what was grown before is forgotten.
  void plant(std::span<const Scalar> state, std::span<const std::uint16_t> looks, int depth, double cost,
             Level<Scalar>& root) {
    links_.assign(1, {0, 0});
    root.reset(dynamics_.size(), dynamics_.sensors(), depth);
    root.add({state.data(), cost, looks, 0, 0, 0});
  }

  /// A level becomes its children, those that the pruning lets stay.
  void grow(Level<Scalar>& level, Pruning<Scalar>& pruning) {
    make_children(level, pruning);
    kept_.clear();
    pruning.select(level, children_, kept_);
    const std::size_t first_link = links_.size();
    DWELL_ASSERT(first_link + kept_.size() < std::numeric_limits<std::uint32_t>::max());
    for (const std::size_t place : kept_) {
      links_.push_back({level[children_[place].parent].link, children_[place].choice});
    }
    level.reset(dynamics_.size(), dynamics_.sensors(), children_.depth());
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      Node<Scalar> child = children_[kept_[i]];
      child.link = static_cast<std::uint32_t>(first_link + i);
      level.add(child);
    }
  }
  void grow(Level<Scalar>& level, int steps, Pruning<Scalar>& pruning) {
    for (int step = 0; step < steps; ++step) grow(level, pruning);
  }

  /// From the root to the node.
  void schedule(const Node<Scalar>& node, std::vector<int>& schedule) const {
    schedule.clear();
    for (std::uint32_t link = node.link; link != 0; link = links_[link].parent) schedule.push_back(links_[link].choice);
    std::reverse(schedule.begin(), schedule.end());
  }
  std::vector<int> schedule(const Node<Scalar>& node) const {
    std::vector<int> choices;
    schedule(node, choices);
    return choices;
  }
  /// The first of these choices. Requires a node below the root.
  int first_choice(const Node<Scalar>& node) const {
    std::uint32_t link = node.link;
    while (links_[link].parent != 0) link = links_[link].parent;
    return links_[link].choice;
  }

  D& dynamics() { return dynamics_; }

 private:
  struct Link {
    std::uint32_t parent;
    int choice;
  };

  void make_children(const Level<Scalar>& level, Pruning<Scalar>& pruning) {
    const int step = level.depth() + 1;
    children_.reset(dynamics_.size(), dynamics_.sensors(), step);
    state_.resize(dynamics_.size());
    for (std::size_t i = 0; i < level.size(); ++i) {
      const Node<Scalar> node = level[i];
      for (int choice = 0; choice <= dynamics_.choices(); ++choice) {
        if (!dynamics_.feasible(node, step, choice)) continue;
        looks_.assign(node.looks.begin(), node.looks.end());
        dynamics_.step(node, step, choice, state_.data(), looks_);
        const double cost = dynamics_.cost_after(node, step, choice, state_.data());
        const Node<Scalar> child{state_.data(), cost, looks_, static_cast<std::uint32_t>(i), choice, 0};
        if (pruning.admits(child)) children_.add(child);
      }
      dynamics_.check();
      if (children_.bytes() > maximum_bytes_) {
        throw std::length_error(
            "more than " + std::to_string(children_.size()) +
            " schedules in one step of the search: take a shorter horizon or window, beam or relaxed_dp");
      }
    }
  }

  D& dynamics_;
  std::size_t maximum_bytes_;
  std::vector<Link> links_;
  Level<Scalar> children_;
  std::vector<std::size_t> kept_;
  std::vector<Scalar> state_;
  std::vector<std::uint16_t> looks_;
};

}  // namespace dwell::search
