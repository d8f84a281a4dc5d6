#pragma once

#include <filesystem>

#include "daemon/study/monte_carlo.hpp"

namespace dwell {

/// Draws error_over_time.svg (position RMS of each policy with its 95 % band) and schedule.svg (who looked at whom in
/// the first run) with gnuplot, from the data files that it leaves beside them.
/// Errors   std::runtime_error where gnuplot is missing or fails.
void plot_study(const Study& study, const std::filesystem::path& directory);

}  // namespace dwell
