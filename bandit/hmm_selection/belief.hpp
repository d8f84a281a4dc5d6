#pragma once

#include <vector>

#include "bandit/hmm_selection/problem.hpp"

namespace dwell::hmm_selection {

/// One thing that a look may show, and what is then believed.
struct Outcome {
  double probability;  ///< p(y) > 0
  Eigen::VectorXd belief;
};

/// All symbols of positive probability that a look of a sensor (from 0) may show in the next step.
std::vector<Outcome> outcomes(const Problem& problem, const Eigen::VectorXd& belief, int sensor);

/// beta (1 - pi'pi).
double uncertainty(const Problem& problem, const Eigen::VectorXd& belief);

/// Expected cost of the next step with a look of a sensor:
///
///   cost(u) + beta (1 - sum_y |Phi_y A' pi|^2 / (1' Phi_y A' pi))
///
/// Source  Evans et al. (2005), end of IV-A; the printed sum lacks the weight p(y) of each symbol, which takes one
///         power of the normalisation away.
double expected_cost(const Problem& problem, const Eigen::VectorXd& belief, int sensor);

}  // namespace dwell::hmm_selection
