#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "bandit/hmm_selection/problem.hpp"
#include "radar/random.hpp"

namespace dwell::hmm_selection {

struct FixedSettings {
  int sensor = 1;  ///< 1 .. m
};
/// Sensor 1 in the first step, then in turn.
struct RoundRobinSettings {};
/// The least expected cost of the next step; of equal ones (1e-12) the first. Source: Evans et al. (2005), IV-A.
struct OneStepSettings {};
/// The least expected cost of all that is left, by the tree of all sensors and symbols. The cost is no linear function
/// of the belief, so the value function is not one of finitely many pieces: the tree is the exact method.
struct OptimumSettings {};

using PolicySettings = std::variant<OneStepSettings, RoundRobinSettings, FixedSettings, OptimumSettings>;

std::vector<Violation> validate(const PolicySettings& settings, const Problem& problem);

/// Beliefs that a tree may have: about a minute.
inline constexpr double kMaximumBeliefs = 2e7;

struct Solution {
  int first = 1;                ///< the sensor of the first step, 1 .. m
  double cost = 0.0;            ///< expected, over all N steps
  double standard_error = 0.0;  ///< of `cost`; 0: exact
  std::vector<double> looks;    ///< expected, of each sensor
  std::uint64_t expanded = 0;   ///< beliefs in the tree or the runs
};

/// The expected cost of a policy: exact over the tree of what may be seen while that has at most kMaximumBeliefs, else
/// the mean of `runs` >= 2 runs that draw what is seen from `stream` (common numbers: one uniform draw a step).
/// Requires both to be valid.
/// Errors   std::length_error where the tree of `optimum`, (sum of symbols over sensors)^N beliefs, is larger.
Solution solve(const Problem& problem, const PolicySettings& settings, int runs, RandomStream stream);

}  // namespace dwell::hmm_selection
