#include "bandit/lti/search_tree.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "radar/assert.hpp"

namespace dwell::lti {

double trace_weight(const Problem& problem) {
  const bool summed = problem.objective == Objective::kSum && problem.communication_noise == 0.0;
  return summed ? problem.sensor_count() : 1.0;
}

bool feasible(const Problem& problem, std::span<const std::uint16_t> looks, int step, int choice) {
  if (choice == 0) return problem.allow_idle;
  return looks[static_cast<std::size_t>(choice - 1)] < looks_by(problem, choice, step);
}

bool no_more_looks(const Problem& problem, std::span<const std::uint16_t> a, std::span<const std::uint16_t> b) {
  for (std::size_t j = 0; j < a.size(); ++j) {
    if (problem.sensors[j].max_looks > 0 && a[j] > b[j]) return false;
  }
  return true;
}

void LinearDynamics::step(const Node& node, int /*step*/, int choice, double* to, std::vector<std::uint16_t>& looks) {
  riccati_.step(node.state, choice, to);
  if (choice > 0) ++looks[static_cast<std::size_t>(choice - 1)];
}

double LinearDynamics::cost_after(double cost, int choice, const double* covariance) const {
  const double now = trace_weight_ * riccati_.trace(covariance);
  if (problem_.objective == Objective::kFinal) return now;
  return cost + now + (choice == 0 ? 0.0 : problem_.sensors[static_cast<std::size_t>(choice - 1)].cost);
}

void LinearDynamics::check() const {
  if (riccati_.steps() > kMaximumSteps) {
    throw std::length_error(
        "the search takes more than 100 million Riccati steps: take a shorter horizon or window, "
        "beam or relaxed_dp");
  }
}

Level SearchTree::root() {
  const Problem& of = problem();
  const std::vector<double> covariance = riccati().initial();
  const bool counts = of.objective == Objective::kSum && of.covariance == CovarianceKind::kPredicted;
  const double cost = counts ? trace_weight() * riccati().trace(covariance.data()) : 0.0;
  const std::vector<std::uint16_t> no_looks(of.sensors.size(), 0);
  Level level(riccati().size(), of.sensors.size(), 0);
  tree_.plant(covariance, no_looks, 0, cost, level);
  return level;
}

Level SearchTree::root(std::span<const double> covariance, std::span<const std::uint16_t> looks, int depth) {
  Level level(riccati().size(), problem().sensors.size(), depth);
  tree_.plant(covariance, looks, depth, 0.0, level);
  return level;
}

Solution solution_of(SearchTree& tree, const Level& last) {
  Solution solution = evaluate(tree.problem(), tree.schedule(last[cheapest(last)]));
  solution.expanded = tree.riccati().steps();
  return solution;
}

}  // namespace dwell::lti
