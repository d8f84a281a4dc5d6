#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "daemon/engine.hpp"

namespace dwell {

/// One parameter of one radar over the runs, in its own unit (radians, log factors).
struct CalibratedParameter {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double truth = 0.0;
  double mean = 0.0;
  double squared_error = 0.0;   ///< mean
  double standard_error = 0.0;  ///< as reported, mean
  double bound = kNone;         ///< Cramer-Rao: of the runs' mean information at the truth, with the prior; NaN: none
  double bound_error = kNone;   ///< its standard error, of so many runs
  /// The root mean square error, to first order, of targets that may not move as the prior says: by the mean square
  /// score at the truth, which is the information where they do. Huber (1967), White (1982).
  double misspecified = kNone;
  int within_two = 0;  ///< runs whose error is within so many reported standard errors
  int within_three = 0;
  int observable = 0;  ///< runs that report it so
};
struct CalibratedRadar {
  std::string name;
  std::array<CalibratedParameter, kCorrectionSize> parameters;
  double plots = 0.0;       ///< mean
  double nis_before = 0.0;  ///< mean over runs of the mean over plots: 2 where it is right
  double nis_after = 0.0;
  int in_band_before = 0;  ///< runs whose NIS is in the band of chi-square that holds 95 % of matched radars
  int in_band_after = 0;
};
struct CalibrationFigures {
  int runs = 0;
  int solved = 0;       ///< the rest have no result
  std::string failure;  ///< of the last without
  std::vector<CalibratedRadar> radars;
};

struct CalibrationStudyOptions {
  int runs = 100;
  std::uint64_t seed = 1;  ///< of the first
  std::uint64_t scans = 600;
  int threads = 1;
  bool joint = true;  ///< else as in the loop: maximum likelihood of innovations
};

/// What calibration would say of a scenario's radars after so many scans under the config's policy, against the truth
/// that the config gives them: nothing that is learned is used, so that each run is one trial.
/// `stop` cuts short, `progress` is told of (runs done, runs in all), from any thread, one at a time. The result does
/// not depend on the number of threads.
CalibrationFigures study_calibration(const EngineConfig& config, const CalibrationStudyOptions& options,
                                     const std::atomic<bool>& stop, const std::function<void(int, int)>& progress);

/// The same of one run as it is, which is over.
CalibrationFigures calibration_of(const Engine& engine, bool joint);

/// The plots that calibration has to keep for so many scans.
int window_of(const EngineConfig& config, std::uint64_t scans);

}  // namespace dwell
