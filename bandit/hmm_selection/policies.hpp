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
/// The first look of the plan that expects the least cost of the next min(d, steps left) steps; of equal ones (1e-12)
/// the first. d = 1 is the one-step rule. Source: Evans et al. (2005), IV-A.
struct WindowSettings {
  int d = 1;  ///< >= 1
};
/// The plan that expects the least cost of all steps, by the tree of all sensors and symbols. The cost is no linear
/// function of the belief, so the value function is not one of finitely many pieces: the tree is the exact method.
struct OptimumSettings {};

/// The default first.
using PolicySettings = std::variant<WindowSettings, RoundRobinSettings, FixedSettings, OptimumSettings>;

std::vector<Violation> validate(const PolicySettings& settings, const Problem& problem);

/// Beliefs that a tree may have, and all runs together: seconds, and a minute or two.
inline constexpr double kMaximumBeliefs = 2e7;
inline constexpr double kMaximumSampledBeliefs = 1e9;

struct Solution {
  int first = 1;                ///< the sensor of the first step, 1 .. m
  double cost = 0.0;            ///< expected, over all N steps
  double standard_error = 0.0;  ///< of `cost`; 0: exact
  std::vector<double> looks;    ///< expected, of each sensor
  std::uint64_t expanded = 0;   ///< beliefs in the tree or the runs
};

/// The expected cost of a policy by the mean of `runs` >= 2 runs that draw what is seen from `stream`: common numbers,
/// one uniform draw a step. Not of `optimum`.
Solution sample(const Problem& problem, const PolicySettings& settings, int runs, RandomStream stream);

/// The expected cost of a policy: exact over the tree of what may be seen while that has at most kMaximumBeliefs, else
/// by `sample`. Requires both to be valid. With s symbols of all sensors together, t of the one with the most, the tree
/// of `optimum` has s^N beliefs, that of any other policy t^N, with s^d for each where it is a window.
/// Errors   std::length_error where even that is too many.
Solution solve(const Problem& problem, const PolicySettings& settings, int runs, RandomStream stream);

}  // namespace dwell::hmm_selection
