#include "bandit/lti/fixed.hpp"

#include "bandit/lti/search_tree.hpp"

namespace dwell::lti {
namespace {

/// The schedule of a rule that does not look at covariances: rule(looks, step) is a choice for step 1 .. N.
template <class Rule>
Solution by_rule(const Problem& problem, Rule rule) {
  std::vector<std::uint16_t> looks(problem.sensors.size(), 0);
  std::vector<int> schedule;
  for (int step = 1; step <= problem.horizon; ++step) {
    const int choice = rule(looks, step);
    if (choice > 0) ++looks[static_cast<std::size_t>(choice - 1)];
    schedule.push_back(choice);
  }
  Solution solution = evaluate(problem, std::move(schedule));
  solution.expanded = static_cast<std::uint64_t>(problem.horizon);
  return solution;
}

}  // namespace

Solution fixed(const Problem& problem, const FixedSettings& settings) {
  return by_rule(problem, [&](std::span<const std::uint16_t> looks, int step) {
    if (feasible(problem, looks, step, settings.sensor)) return settings.sensor;
    int choice = 0;
    while (!feasible(problem, looks, step, choice)) ++choice;
    return choice;
  });
}

Solution round_robin(const Problem& problem) {
  return by_rule(problem, [&, last = 0](std::span<const std::uint16_t> looks, int step) mutable {
    for (int passed = 0; passed < problem.sensor_count(); ++passed) {
      last = last % problem.sensor_count() + 1;
      if (feasible(problem, looks, step, last)) return last;
    }
    return 0;
  });
}

}  // namespace dwell::lti
