#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "daemon/config/field_reader.hpp"
#include "dwell/v1/config.pb.h"

namespace dwell {

/// A config that is well formed. None of its rules has been checked.
struct ParsedConfig {
  v1::Config message;
  std::unique_ptr<FieldReader::Locations> locations;  ///< null where it did not come from text
  std::string source;                                 ///< what violations name
  std::filesystem::path directory;                    ///< recordings are looked for relative to it
};

/// Parses protobuf text format.
/// Errors   InvalidInput with the first syntax error, line and column, or where the file cannot be read.
ParsedConfig parse_config_file(const std::filesystem::path& file);
ParsedConfig parse_config_text(const std::string& text, const std::string& source,
                               const std::filesystem::path& directory);

/// The name of the scheduling problem that the config is; empty: it is a scenario.
std::string problem_of(const v1::Config& config);

}  // namespace dwell
