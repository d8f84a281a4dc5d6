#pragma once

#include <filesystem>

namespace dwell {

/// First lines of a script that draws one SVG. gnuplot's enhanced text would read an underscore as an index.
inline constexpr const char* kSvg =
    "set terminal svg size 900,500 noenhanced background 'white'\nset key outside\nset grid\n";

/// Runs a script in its directory.
/// Errors   std::runtime_error where gnuplot is missing or fails.
void run_gnuplot(const std::filesystem::path& directory, const char* script);

}  // namespace dwell
