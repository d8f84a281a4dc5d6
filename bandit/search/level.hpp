#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "radar/assert.hpp"

namespace dwell::search {

/// Costs that differ by less than this part of themselves are equal: then what comes first is taken. Rounding in the
/// Riccati steps stays below it.
inline constexpr double kTie = 1e-12;

/// A place in a tree of schedules: what a schedule up to here has led to.
template <class Scalar>
struct Node {
  const Scalar* state;                   ///< as the tree's dynamics lays it out
  double cost;                           ///< the objective so far
  std::span<const std::uint16_t> looks;  ///< what the dynamics notes of each sensor's looks
  std::uint32_t parent;                  ///< place in the level above
  int choice;                            ///< of the last step
  std::uint32_t link;                    ///< into the tree's record of choices
};

/// Nodes of equal depth. As a tree grows them they are in the order of their schedules.
template <class Scalar>
class Level {
 public:
  /// `depth`: steps that are taken.
  Level(std::size_t state_size, std::size_t sensors, int depth) { reset(state_size, sensors, depth); }

  int depth() const { return depth_; }
  std::size_t size() const { return heads_.size(); }
  Node<Scalar> operator[](std::size_t i) const {
    const Head& head = heads_[i];
    return {states_.data() + i * stride_,
            head.cost,
            std::span(looks_).subspan(i * sensors_, sensors_),
            head.parent,
            head.choice,
            head.link};
  }
  void add(const Node<Scalar>& node) {
    heads_.push_back({node.cost, node.parent, node.link, node.choice});
    states_.insert(states_.end(), node.state, node.state + stride_);
    looks_.insert(looks_.end(), node.looks.begin(), node.looks.end());
  }
  std::size_t bytes() const {
    return size() * (sizeof(Head) + stride_ * sizeof(Scalar) + sensors_ * sizeof(std::uint16_t));
  }
  /// Empty, and keeps its memory.
  void reset(std::size_t state_size, std::size_t sensors, int depth) {
    stride_ = state_size;
    sensors_ = sensors;
    depth_ = depth;
    heads_.clear();
    states_.clear();
    looks_.clear();
  }

 private:
  struct Head {
    double cost;
    std::uint32_t parent;
    std::uint32_t link;
    int choice;
  };
  std::size_t stride_ = 0;
  std::size_t sensors_ = 0;
  int depth_ = 0;
  std::vector<Head> heads_;
  std::vector<Scalar> states_;
  std::vector<std::uint16_t> looks_;
};

/// The first node of the least cost, ties as kTie says. Requires a node.
template <class Scalar>
std::size_t cheapest(const Level<Scalar>& level) {
  DWELL_ASSERT(level.size() > 0);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < level.size(); ++i) least = std::min(least, level[i].cost);
  std::size_t first = 0;
  while (first + 1 < level.size() && !(level[first].cost <= least * (1.0 + kTie))) ++first;
  return first;
}

}  // namespace dwell::search
