#include "bandit/hmm_selection/belief.hpp"

namespace dwell::hmm_selection {

std::vector<Outcome> outcomes(const Problem& problem, const Eigen::VectorXd& belief, int sensor) {
  const Eigen::VectorXd predicted = problem.transition.transpose() * belief;
  const Eigen::MatrixXd& emission = problem.sensors[static_cast<std::size_t>(sensor)].emission;
  std::vector<Outcome> outcomes;
  for (Eigen::Index y = 0; y < emission.cols(); ++y) {
    const Eigen::VectorXd joint = emission.col(y).cwiseProduct(predicted);
    const double probability = joint.sum();
    if (probability > 0.0) outcomes.push_back({probability, joint / probability});
  }
  return outcomes;
}

double uncertainty(const Problem& problem, const Eigen::VectorXd& belief) {
  return problem.beta * (1.0 - belief.squaredNorm());
}

double expected_cost(const Problem& problem, const Eigen::VectorXd& belief, int sensor) {
  double cost = problem.sensors[static_cast<std::size_t>(sensor)].cost;
  for (const Outcome& outcome : outcomes(problem, belief, sensor)) {
    cost += outcome.probability * uncertainty(problem, outcome.belief);
  }
  return cost;
}

}  // namespace dwell::hmm_selection
