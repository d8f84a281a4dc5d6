#include "bandit/lti/random.hpp"

#include "bandit/lti/averaged_riccati.hpp"
#include "bandit/lti/search_tree.hpp"

namespace dwell::lti {
namespace {

/// `u` in [0, 1) falls into the weights laid end to end; requires a positive weight.
int place_of(double u, const Eigen::VectorXd& weights) {
  double rest = u * weights.sum();
  int last = 0;
  for (int i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0.0) continue;
    last = i;
    if (rest < weights[i]) break;
    rest -= weights[i];
  }
  return last;
}

int draw(const Problem& problem, const Eigen::VectorXd& q, std::span<const std::uint16_t> looks, int step, double u) {
  Eigen::VectorXd available = Eigen::VectorXd::Zero(q.size());
  for (int i = 0; i < q.size(); ++i) available[i] = feasible(problem, looks, step, i + 1) ? 1.0 : 0.0;
  if (available.sum() == 0.0) return 0;
  const Eigen::VectorXd weights = q.cwiseProduct(available);
  return 1 + place_of(u, weights.sum() > 0.0 ? weights : available);
}

}  // namespace

Solution random_choice(const Problem& problem, const RandomSettings& settings, RandomStream stream) {
  const Probabilities probabilities = settings.q == RandomSettings::Probabilities::kUniform
                                          ? uniform_probabilities(problem)
                                          : optimal_probabilities(problem);
  std::vector<std::uint16_t> looks(problem.sensors.size(), 0);
  std::vector<int> schedule;
  for (int k = 0; k < problem.horizon; ++k) {
    const int choice = draw(problem, probabilities.q, looks, k + 1, stream.uniform());
    if (choice > 0) ++looks[static_cast<std::size_t>(choice - 1)];
    schedule.push_back(choice);
  }
  Solution solution = evaluate(problem, std::move(schedule));
  solution.expanded = probabilities.steps;
  solution.probabilities.assign(probabilities.q.begin(), probabilities.q.end());
  if (probabilities.bound) solution.bound = trace_weight(problem) * *probabilities.bound;
  return solution;
}

}  // namespace dwell::lti
