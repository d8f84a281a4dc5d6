#include "bandit/lti/solution.hpp"

#include <cmath>
#include <stdexcept>

#include "bandit/lti/search_tree.hpp"
#include "radar/assert.hpp"

namespace dwell::lti {

Solution evaluate(const Problem& problem, std::vector<int> schedule) {
  DWELL_ASSERT(schedule.size() == static_cast<std::size_t>(problem.horizon));
  Riccati riccati(problem);
  SearchTree tree(problem, riccati);
  std::vector<double> covariance = riccati.initial();
  Solution solution;
  solution.cost = tree.root()[0].cost;
  for (const int choice : schedule) {
    riccati.step(covariance.data(), choice, covariance.data());
    solution.cost = tree.cost_after(solution.cost, choice, covariance.data());
    solution.traces.push_back(riccati.trace(covariance.data()));
  }
  solution.schedule = std::move(schedule);
  solution.final_trace = solution.traces.back();
  if (!std::isfinite(solution.cost) || !std::isfinite(solution.final_trace)) {
    throw std::overflow_error("the covariance is more than a double holds before the horizon is reached");
  }
  return solution;
}

}  // namespace dwell::lti
