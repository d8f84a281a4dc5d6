#include "bandit/hmm_selection/policies.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bandit/hmm_selection/belief.hpp"
#include "radar/assert.hpp"

namespace dwell::hmm_selection {
namespace {

constexpr double kTie = 1e-12;

/// What is to come from a belief on.
struct Rest {
  double cost = 0.0;
  Eigen::VectorXd looks;
  int choice = 0;  // from 0
};

struct Plan {
  double cost;
  int choice;  // from 0
};

/// The least expected cost of the next `steps` >= 1 steps.
Plan best_plan(const Problem& problem, const Eigen::VectorXd& belief, int steps, std::uint64_t& expanded) {
  Plan best{0.0, -1};
  for (int u = 0; u < problem.sensor_count(); ++u) {
    double cost = problem.sensors[static_cast<std::size_t>(u)].cost;
    for (const Outcome& outcome : outcomes(problem, belief, u)) {
      ++expanded;
      const double after = steps > 1 ? best_plan(problem, outcome.belief, steps - 1, expanded).cost : 0.0;
      cost += outcome.probability * (uncertainty(problem, outcome.belief) + after);
    }
    if (best.choice < 0 || cost < best.cost * (1.0 - kTie)) best = {cost, u};
  }
  return best;
}

/// The sensor that a policy chooses, from 0; -1: the best of all.
struct Choose {
  const Problem& problem;
  const Eigen::VectorXd& belief;
  int step;  // from 0
  std::uint64_t& expanded;

  int operator()(const FixedSettings& s) const { return s.sensor - 1; }
  int operator()(const RoundRobinSettings&) const { return step % problem.sensor_count(); }
  int operator()(const WindowSettings& s) const {
    return best_plan(problem, belief, std::min(s.d, problem.horizon - step), expanded).choice;
  }
  int operator()(const OptimumSettings&) const { return -1; }
};

class Tree {
 public:
  Tree(const Problem& problem, const PolicySettings& settings) : problem_(problem), settings_(settings) {}

  Rest rest(const Eigen::VectorXd& belief, int step) {
    if (step == problem_.horizon) return {0.0, Eigen::VectorXd::Zero(problem_.sensor_count()), 0};
    const int choice = std::visit(Choose{problem_, belief, step, expanded_}, settings_);
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

/// Beliefs that one decision looks at, at most.
double beliefs_a_decision(const Problem& problem, const PolicySettings& settings) {
  double all = 0.0;
  for (const Sensor& sensor : problem.sensors) all += static_cast<double>(sensor.emission.cols());
  const auto* window = std::get_if<WindowSettings>(&settings);
  if (std::holds_alternative<OptimumSettings>(settings)) return std::pow(all, problem.horizon);
  return window == nullptr ? 1.0 : std::pow(all, std::min(window->d, problem.horizon));
}

/// Beliefs that the tree of all that may be seen under a policy has, at most.
double beliefs_of_tree(const Problem& problem, const PolicySettings& settings) {
  if (std::holds_alternative<OptimumSettings>(settings)) return beliefs_a_decision(problem, settings);
  double most = 0.0;
  for (const Sensor& sensor : problem.sensors) most = std::max(most, static_cast<double>(sensor.emission.cols()));
  return std::pow(most, problem.horizon) * beliefs_a_decision(problem, settings);
}

}  // namespace

std::vector<Violation> validate(const PolicySettings& settings, const Problem& problem) {
  if (const auto* fixed = std::get_if<FixedSettings>(&settings)) {
    if (fixed->sensor >= 1 && fixed->sensor <= problem.sensor_count()) return {};
    return {{"sensor", std::to_string(fixed->sensor), "must be from 1 to " + std::to_string(problem.sensor_count())}};
  }
  const auto* window = std::get_if<WindowSettings>(&settings);
  if (window == nullptr || window->d >= 1) return {};
  return {{"d", std::to_string(window->d), "must be >= 1"}};
}

Solution sample(const Problem& problem, const PolicySettings& settings, int runs, RandomStream stream) {
  Solution solution;
  solution.looks.assign(problem.sensors.size(), 0.0);
  double squares = 0.0;
  for (int run = 0; run < runs; ++run) {
    Eigen::VectorXd belief = problem.belief;
    double cost = 0.0;
    for (int step = 0; step < problem.horizon; ++step) {
      const int choice = std::visit(Choose{problem, belief, step, solution.expanded}, settings);
      DWELL_ASSERT(choice >= 0);
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

Solution solve(const Problem& problem, const PolicySettings& settings, int runs, RandomStream stream) {
  if (beliefs_of_tree(problem, settings) <= kMaximumBeliefs) {
    Tree tree(problem, settings);
    const Rest rest = tree.rest(problem.belief, 0);
    return {rest.choice + 1, rest.cost, 0.0, {rest.looks.begin(), rest.looks.end()}, tree.expanded()};
  }
  if (std::holds_alternative<OptimumSettings>(settings)) {
    throw std::length_error("the optimum would look at more than 2e7 beliefs: shorten the horizon, or take window");
  }
  const double beliefs = beliefs_a_decision(problem, settings) * problem.horizon * runs;
  if (beliefs > kMaximumSampledBeliefs) {
    throw std::length_error("the runs would look at more than 1e9 beliefs: take fewer, or a shorter window");
  }
  return sample(problem, settings, runs, std::move(stream));
}

}  // namespace dwell::hmm_selection
