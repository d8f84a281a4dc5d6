#pragma once

#include <filesystem>
#include <string>

#include "daemon/config/parsed_config.hpp"
#include "daemon/engine_config.hpp"

namespace dwell {

/// Everything that dwelld needs to run.
struct DaemonConfig {
  EngineConfig engine;
  std::string stream_bind = "tcp://127.0.0.1:5556";
  int stream_high_water_mark = 100000;  ///< 30 MB of the usual 300 B messages for a subscriber that stalls
  std::string control_bind = "tcp://127.0.0.1:5557";
  int study_scans = 60;  ///< a minute at the default period, as the papers' scenarios
  v1::Config effective;  ///< the config with every default written out
};

/// Reads a scenario from a file in protobuf text format.
/// Errors   InvalidInput with every violation: the first syntax error with line and column, or else all rules broken.
DaemonConfig read_config(ParsedConfig parsed);
DaemonConfig read_config_file(const std::filesystem::path& file);

/// The same from text or from a message; recordings are looked for relative to `directory`.
DaemonConfig read_config_text(const std::string& text, const std::string& source,
                              const std::filesystem::path& directory);
DaemonConfig read_config(const v1::Config& config, const std::string& source, const std::filesystem::path& directory);

}  // namespace dwell
