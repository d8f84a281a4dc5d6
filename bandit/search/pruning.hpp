#pragma once

#include <algorithm>
#include <numeric>

#include "bandit/search/level.hpp"

namespace dwell::search {

/// What tells one policy from another: which children stay.
template <class Scalar>
class Pruning {
 public:
  virtual ~Pruning() = default;
  /// Whether a child is stored at all; asked as it is made, in the order of the schedules.
  virtual bool admits(const Node<Scalar>& /*child*/) { return true; }
  /// Writes the places of the children that stay, in increasing order; `kept` comes empty.
  virtual void select(const Level<Scalar>& parents, const Level<Scalar>& children, std::vector<std::size_t>& kept) = 0;
};

/// Every schedule.
template <class Scalar>
class Everything final : public Pruning<Scalar> {
 public:
  void select(const Level<Scalar>& /*parents*/, const Level<Scalar>& children,
              std::vector<std::size_t>& kept) override {
    kept.resize(children.size());
    std::iota(kept.begin(), kept.end(), std::size_t{0});
  }
};

/// Keeps the `width` cheapest nodes of every level; of equal ones the first.
template <class Scalar>
class BeamPruning final : public Pruning<Scalar> {
 public:
  explicit BeamPruning(std::size_t width) : width_(width) {}

  void select(const Level<Scalar>& /*parents*/, const Level<Scalar>& children,
              std::vector<std::size_t>& kept) override {
    kept.resize(children.size());
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    if (kept.size() <= width_) return;
    const auto last = kept.begin() + static_cast<std::ptrdiff_t>(width_);
    std::nth_element(kept.begin(), last, kept.end(), [&](std::size_t a, std::size_t b) {
      return children[a].cost != children[b].cost ? children[a].cost < children[b].cost : a < b;
    });
    kept.erase(last, kept.end());
    std::sort(kept.begin(), kept.end());
  }

 private:
  std::size_t width_;
};

/// Keeps the nodes of every level whose cost so far is at most f times the least.
/// Source  Chung et al. (2004), III-C; Gupta et al. (2004), algorithm 2.
template <class Scalar>
class ThresholdPruning final : public Pruning<Scalar> {
 public:
  explicit ThresholdPruning(double f) : f_(f) {}

  void select(const Level<Scalar>& /*parents*/, const Level<Scalar>& children,
              std::vector<std::size_t>& kept) override {
    const std::size_t best = cheapest(children);
    const double limit = f_ * children[best].cost * (1.0 + kTie);
    for (std::size_t i = 0; i < children.size(); ++i) {
      if (i == best || children[i].cost <= limit) kept.push_back(i);  // a cost may be more than a double holds
    }
  }

 private:
  double f_;
};

}  // namespace dwell::search
