#include "bandit/lti/fixed.hpp"

#include "bandit/lti/search_tree.hpp"

namespace dwell::lti {

Solution fixed(const Problem& problem, const FixedSettings& settings) {
  std::vector<std::uint16_t> looks(problem.sensors.size(), 0);
  std::vector<int> schedule;
  for (int k = 0; k < problem.horizon; ++k) {
    int choice = settings.sensor;
    if (!feasible(problem, looks, choice)) {
      choice = 0;
      while (!feasible(problem, looks, choice)) ++choice;
    }
    if (choice > 0) ++looks[static_cast<std::size_t>(choice - 1)];
    schedule.push_back(choice);
  }
  Solution solution = evaluate(problem, std::move(schedule));
  solution.expanded = static_cast<std::uint64_t>(problem.horizon);
  return solution;
}

}  // namespace dwell::lti
