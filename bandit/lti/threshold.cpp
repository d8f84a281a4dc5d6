#include "bandit/lti/threshold.hpp"

namespace dwell::lti {
Solution threshold(const Problem& problem, const ThresholdSettings& settings) {
  Riccati riccati(problem);
  SearchTree tree(problem, riccati);
  search::ThresholdPruning<double> pruning(settings.f);
  const Level last = tree.grow(tree.root(), problem.horizon, pruning);
  return solution_of(tree, last);
}

}  // namespace dwell::lti
