#include "bandit/lti/window.hpp"

#include <algorithm>

#include "bandit/lti/optimum.hpp"

namespace dwell::lti {

Solution window(const Problem& problem, const WindowSettings& settings) {
  Riccati riccati(problem);
  SearchTree tree(problem, riccati);
  std::vector<double> covariance = riccati.initial();
  std::vector<std::uint16_t> looks(problem.sensors.size(), 0);
  std::vector<int> schedule;
  for (int k = 0; k < problem.horizon; ++k) {
    const int steps = std::min(settings.d, problem.horizon - k);
    const int choice = best_schedule(tree, tree.root(covariance, looks, k), steps).front();
    riccati.step(covariance.data(), choice, covariance.data());
    if (choice > 0) ++looks[static_cast<std::size_t>(choice - 1)];
    schedule.push_back(choice);
  }
  Solution solution = evaluate(problem, std::move(schedule));
  solution.expanded = riccati.steps();
  return solution;
}

}  // namespace dwell::lti
