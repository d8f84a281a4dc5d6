#include "bandit/hmm_selection/policies.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bandit/hmm_selection/belief.hpp"

namespace dwell::hmm_selection {
namespace {

constexpr double kTie = 1e-12;

/// What is to come from a belief on.
struct Rest {
  double cost = 0.0;
  Eigen::VectorXd looks;
  int choice = 0;  // from 0
};

/// The sensor that a policy without look-ahead chooses, from 0.
struct Choose {
  const Problem& problem;
  const Eigen::VectorXd& belief;
  int step;  // from 0

  int operator()(const FixedSettings& s) const { return s.sensor - 1; }
  int operator()(const RoundRobinSettings&) const { return step % problem.sensor_count(); }
  int operator()(const OneStepSettings&) const {
    int best = 0;
    double least = expected_cost(problem, belief, 0);
    for (int u = 1; u < problem.sensor_count(); ++u) {
      const double cost = expected_cost(problem, belief, u);
      if (cost < least * (1.0 - kTie)) {
        best = u;
        least = cost;
      }
    }
    return best;
  }
  int operator()(const OptimumSettings&) const { return -1; }  // Tree tries all
};

class Tree {
 public:
  Tree(const Problem& problem, const PolicySettings& settings) : problem_(problem), settings_(settings) {}

  Rest rest(const Eigen::VectorXd& belief, int step) {
    if (step == problem_.horizon) return {0.0, Eigen::VectorXd::Zero(problem_.sensor_count()), 0};
    const int choice = std::visit(Choose{problem_, belief, step}, settings_);
    if (choice >= 0) return after(belief, step, choice);
    Rest best = after(belief, step, 0);
    for (int u = 1; u < problem_.sensor_count(); ++u) {
      Rest other = after(belief, step, u);
      if (other.cost < best.cost * (1.0 - kTie)) best = std::move(other);
    }
    return best;
  }

  std::uint64_t expanded() const { return expanded_; }

 private:
  Rest after(const Eigen::VectorXd& belief, int step, int choice) {
    Rest rest_of_all{problem_.sensors[static_cast<std::size_t>(choice)].cost,
                     Eigen::VectorXd::Unit(problem_.sensor_count(), choice), choice};
    for (const Outcome& outcome : outcomes(problem_, belief, choice)) {
      ++expanded_;
      const Rest next = rest(outcome.belief, step + 1);
      rest_of_all.cost += outcome.probability * (uncertainty(problem_, outcome.belief) + next.cost);
      rest_of_all.looks += outcome.probability * next.looks;
    }
    return rest_of_all;
  }

  const Problem& problem_;
  const PolicySettings& settings_;
  std::uint64_t expanded_ = 0;
};

/// Leaves of the tree of what may be seen, at most.
double tree_size(const Problem& problem, const PolicySettings& settings) {
  double all = 0.0;
  double most = 0.0;
  for (const Sensor& sensor : problem.sensors) {
    all += static_cast<double>(sensor.emission.cols());
    most = std::max(most, static_cast<double>(sensor.emission.cols()));
  }
  return std::pow(std::holds_alternative<OptimumSettings>(settings) ? all : most, problem.horizon);
}

Solution sampled(const Problem& problem, const PolicySettings& settings, int runs, RandomStream stream) {
  Solution solution;
  solution.looks.assign(problem.sensors.size(), 0.0);
  double squares = 0.0;
  for (int run = 0; run < runs; ++run) {
    Eigen::VectorXd belief = problem.belief;
    double cost = 0.0;
    for (int step = 0; step < problem.horizon; ++step) {
      const int choice = std::visit(Choose{problem, belief, step}, settings);
      if (step == 0) solution.first = choice + 1;
      solution.looks[static_cast<std::size_t>(choice)] += 1.0 / runs;
      const std::vector<Outcome> possible = outcomes(problem, belief, choice);
      double rest = stream.uniform();
      std::size_t seen = 0;
      while (seen + 1 < possible.size() && rest >= possible[seen].probability) rest -= possible[seen++].probability;
      belief = possible[seen].belief;
      cost += problem.sensors[static_cast<std::size_t>(choice)].cost + uncertainty(problem, belief);
      solution.expanded += possible.size();
    }
    const double before = solution.cost;
    solution.cost += (cost - before) / (run + 1);
    squares += (cost - before) * (cost - solution.cost);
  }
  solution.standard_error = std::sqrt(squares / (runs - 1.0) / runs);
  return solution;
}

}  // namespace

std::vector<Violation> validate(const PolicySettings& settings, const Problem& problem) {
  const auto* fixed = std::get_if<FixedSettings>(&settings);
  if (fixed == nullptr || (fixed->sensor >= 1 && fixed->sensor <= problem.sensor_count())) return {};
  return {{"sensor", std::to_string(fixed->sensor), "must be from 1 to " + std::to_string(problem.sensor_count())}};
}

Solution solve(const Problem& problem, const PolicySettings& settings, int runs, RandomStream stream) {
  if (tree_size(problem, settings) > kMaximumBeliefs) {
    if (std::holds_alternative<OptimumSettings>(settings)) {
      throw std::length_error("the optimum would need more than 2e7 beliefs: shorten the horizon");
    }
    return sampled(problem, settings, runs, std::move(stream));
  }
  Tree tree(problem, settings);
  const Rest rest = tree.rest(problem.belief, 0);
  return {rest.choice + 1, rest.cost, 0.0, {rest.looks.begin(), rest.looks.end()}, tree.expanded()};
}

}  // namespace dwell::hmm_selection
