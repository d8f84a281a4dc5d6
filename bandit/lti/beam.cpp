#include "bandit/lti/beam.hpp"

#include <algorithm>
#include <numeric>

#include "bandit/lti/window.hpp"

namespace dwell::lti {

void BeamPruning::select(const Level& /*parents*/, const Level& children, std::vector<std::size_t>& kept) {
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

Solution beam(const Problem& problem, const BeamSettings& settings) {
  Riccati riccati(problem);
  SearchTree tree(problem, riccati);
  BeamPruning pruning(static_cast<std::size_t>(settings.width));
  const Level last = tree.grow(tree.root(), problem.horizon, pruning);
  Solution wide = evaluate(problem, tree.schedule(last[cheapest(last)]));
  Solution narrow = window(problem, {});
  const std::uint64_t expanded = riccati.steps() + narrow.expanded;
  Solution& best = narrow.cost < wide.cost * (1.0 - kTie) ? narrow : wide;
  best.expanded = expanded;
  return best;
}

}  // namespace dwell::lti
