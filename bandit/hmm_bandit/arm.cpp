#include "bandit/hmm_bandit/arm.hpp"

#include <cmath>
#include <cstdio>
#include <string>

namespace dwell::hmm_bandit {
namespace {

/// How far probabilities may be from summing to one.
constexpr double kSum = 1e-6;

bool are_probabilities(const Eigen::MatrixXd& rows) {
  return rows.allFinite() && (rows.array() >= 0.0).all() && ((rows.rowwise().sum().array() - 1.0).abs() <= kSum).all();
}

/// What is wrong with the first row that is no distribution.
std::string bad_row(const Eigen::MatrixXd& rows) {
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    if (are_probabilities(rows.row(i))) continue;
    char text[64];
    std::snprintf(text, sizeof text, "row %d with sum %.9g", static_cast<int>(i) + 1, rows.row(i).sum());
    return text;
  }
  return std::to_string(rows.rows()) + " x " + std::to_string(rows.cols());
}

}  // namespace

std::vector<Eigen::MatrixXd> update_maps(const Arm& arm) {
  std::vector<Eigen::MatrixXd> maps;
  for (int y = 0; y < arm.symbols(); ++y) {
    maps.push_back(arm.emission.col(y).asDiagonal() * arm.transition.transpose());
  }
  return maps;
}

std::vector<Violation> validate(const Problem& problem) {
  std::vector<Violation> violations;
  const auto refuse = [&](const std::string& field, const std::string& value, const std::string& rule) {
    violations.push_back({field, value, rule});
  };
  if (!(problem.discount > 0.0 && problem.discount < 1.0)) {
    refuse("discount", std::to_string(problem.discount), "must be above 0, below 1");
  }
  if (problem.arms.empty()) refuse("arm", "", "one arm at least is required");
  for (std::size_t i = 0; i < problem.arms.size(); ++i) {
    const Arm& arm = problem.arms[i];
    const std::string at = "arm[" + std::to_string(i + 1) + "].";
    const Eigen::Index n = arm.transition.rows();
    if (n < 1 || n > kMaximumStates || arm.transition.cols() != n || !are_probabilities(arm.transition)) {
      refuse(at + "transition", bad_row(arm.transition),
             "must be 1 to " + std::to_string(kMaximumStates) + " rows of as many probabilities that sum to one");
    }
    if (arm.emission.rows() != n || arm.emission.cols() < 1 || !are_probabilities(arm.emission)) {
      refuse(at + "emission", bad_row(arm.emission), "must be a row for each state, of probabilities that sum to one");
    }
    if (arm.reward.size() != n || !arm.reward.allFinite()) {
      refuse(at + "reward", std::to_string(arm.reward.size()) + " values", "must be one finite number a state");
    }
    if (arm.belief.size() != n || !are_probabilities(arm.belief.transpose())) {
      refuse(at + "belief", bad_row(arm.belief.transpose()), "must be one probability a state; they sum to one");
    }
  }
  return violations;
}

}  // namespace dwell::hmm_bandit
