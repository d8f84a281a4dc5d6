#pragma once

#include <filesystem>
#include <string>

#include "dwell/v1/config.pb.h"

namespace dwell {

/// What a study came to, as text. Everything but wall-clock times depends on config, policies and seed alone.
class StudyReport {
 public:
  virtual ~StudyReport() = default;

  virtual std::string table() const = 0;
  virtual std::string json() const = 0;  ///< one object, with the wall-clock times
  virtual std::string csv() const = 0;
  /// Writes results.json, results.csv, times.json, config.textproto and the plots (SVG, by gnuplot) into a directory,
  /// which is made where it is missing. Wall-clock times stand in times.json only.
  /// Errors   std::runtime_error.
  virtual void write(const std::filesystem::path& directory) const = 0;
  /// Whether all that was asked for is there; if not it has been said on stderr.
  virtual bool complete() const = 0;
};

/// Errors   std::runtime_error.
void write_file(const std::filesystem::path& file, const std::string& text);
void write_config(const std::filesystem::path& directory, const v1::Config& config);

}  // namespace dwell
