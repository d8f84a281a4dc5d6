#pragma once

#include <variant>
#include <vector>

#include "bandit/lti/beam.hpp"
#include "bandit/lti/fixed.hpp"
#include "bandit/lti/optimum.hpp"
#include "bandit/lti/random.hpp"
#include "bandit/lti/relaxed_dp.hpp"
#include "bandit/lti/threshold.hpp"
#include "bandit/lti/window.hpp"

namespace dwell::lti {

struct RoundRobinSettings {};
struct OptimumSettings {};

/// The default first.
using PolicySettings = std::variant<WindowSettings, RoundRobinSettings, FixedSettings, RandomSettings,
                                    ThresholdSettings, BeamSettings, RelaxedDpSettings, OptimumSettings>;

struct Policy {
  PolicySettings settings;
  bool spread = false;  ///< budgets, as Problem::spread
};

/// What is wrong with a policy's settings for a problem that is valid itself.
std::vector<Violation> validate(const PolicySettings& settings, const Problem& problem);

/// The policy's schedule. Requires that both are valid. `stream` is for what a policy draws: give each policy the
/// stream forked for the schedule, so that they draw from common numbers.
/// Errors   std::length_error (SearchTree), std::overflow_error (evaluate).
Solution solve(const Problem& problem, const Policy& policy, const RandomStream& stream);

}  // namespace dwell::lti
