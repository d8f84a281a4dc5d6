#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "bandit/lti/solution.hpp"

namespace dwell {

/// Draws trace_over_steps.svg (tr P after each step, a line for each policy) and schedule.svg (which sensor in which
/// step) with gnuplot, from the data file that it leaves beside them.
/// Errors   std::runtime_error where gnuplot is missing or fails.
void plot_lti(const std::vector<std::pair<std::string, lti::Solution>>& solutions,
              const std::filesystem::path& directory);

}  // namespace dwell
