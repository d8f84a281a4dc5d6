#pragma once

#include "bandit/lti/search_tree.hpp"

namespace dwell::lti {

/// Keeps the `width` cheapest nodes of every level; of equal ones the first.
class BeamPruning final : public Pruning {
 public:
  explicit BeamPruning(std::size_t width) : width_(width) {}
  void select(const Level& parents, const Level& children, std::vector<std::size_t>& kept) override;

 private:
  std::size_t width_;
};

struct BeamSettings {
  int width = 10;  ///< >= 1
};

/// Beam search on the objective, and the one-step rule beside it: a beam alone may lose the path of the one-step rule,
/// so the better of the two is returned.
Solution beam(const Problem& problem, const BeamSettings& settings);

}  // namespace dwell::lti
