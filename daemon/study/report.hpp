#pragma once

#include <filesystem>
#include <string>

#include "daemon/study/monte_carlo.hpp"
#include "dwell/v1/config.pb.h"

namespace dwell {

/// A study as text: a table for people, one JSON object, or CSV with one row for each run and policy. Everything but
/// the decision times depends on config, policies and seed alone; `with_times` leaves those in.
std::string study_table(const Study& study);
std::string study_json(const Study& study, bool with_times);
std::string study_csv(const Study& study);

/// Writes results.json, results.csv, config.textproto, times.json and the plots (SVG, by gnuplot) into a directory,
/// which is made where it is missing. Errors: std::runtime_error.
void write_study(const Study& study, const v1::Config& config, const std::filesystem::path& directory);

}  // namespace dwell
