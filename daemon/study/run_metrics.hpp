#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "daemon/engine.hpp"
#include "tracker/metrics/cramer_rao.hpp"

namespace dwell {

/// The scans of a run that count: first_s <= time <= last_s of stream time.
struct TimeWindow {
  double first_s = 0.0;
  double last_s = std::numeric_limits<double>::infinity();
};

/// One scan of a run, summed over its tracks with a living target.
struct ScanSample {
  double tracks = 0.0;
  double squared_x_error_m2 = 0.0;
  double squared_y_error_m2 = 0.0;
  double position_variance_m2 = 0.0;  // what the filter believes
  int sensor = 0;                     // number of the first look's, 0 where there was none
  int track = 0;
};

/// What one run came to: named figures, the same names in every run of a scenario.
struct RunResult {
  std::vector<double> figures;  // in the order of `metric_names`
  std::vector<ScanSample> scans;
  std::vector<double> decision_us;  // of every scan
};

/// Names of the figures, with their units. All are of the scans of the window, and of living tracks: a track that is
/// lost leaves the errors, so `tracks_lost` belongs beside them.
///   x_variance_m2, position_variance_m2   the filter's own, mean over scans and tracks
///   weighted_variance_m2                  sum over tracks of weight x position variance, mean over scans; with classes
///                                         the weight believed, whose mean is that of the true one
///   position_rms_m, x_rms_m, y_rms_m      true error, root mean square over scans and tracks
///   position_mse_m2                       its square, which averages over runs
///   weighted_mse_m2                       sum over tracks of weight x squared position error, mean over scans: what
///                                         weighted_variance_m2 promises
///   nees                                  of the whole state at updates, mean
///   mode_errors                           scans whose likeliest mode is not the true one (jump-Markov targets)
///   tracks_lost, starvation_scans         the longest run of scans of a living track without a look
///   cramer_rao_rms_m                      square root of the mean of the conditional bound's position trace; the
///                                         truth moves as scripted (legs known), by its true mode, or, where it is
///                                         recorded, by the bank's first mode
///   nis_in_band                           share of the plots used whose NIS is in its 95 % band
///   tracks_off_beam                       tracks that had a look whose footprint, pointed by them, was not on their
///                                         target: the benchmarks' rule of loss
///   completeness, track_breaks            share of the targets' scans with a track; how often a track of a living
///                                         target ended
///   confirm_latency_s                     from a target's first scan to its first track, mean over those found
///   false_tracks_per_h
///   answered                              share of the decisions that the policy made itself, not one it fell back to
///   looks.radar.NAME, looks.track.NAME, position_rms_m.track.NAME
std::vector<std::string> metric_names(const EngineConfig& config);

/// Runs the engine over `scans` scans and measures.
RunResult run_and_measure(const EngineConfig& config, std::uint64_t scans, const TimeWindow& window);

/// A policy whose decisions are timed: microseconds are appended to `decision_us`, which outlives it.
std::unique_ptr<Policy> timed(std::unique_ptr<Policy> policy, std::vector<double>& decision_us);

}  // namespace dwell
