#include "bandit/lti/beam.hpp"

#include "bandit/lti/window.hpp"

namespace dwell::lti {

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
