#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "daemon/study/run_metrics.hpp"

namespace dwell {

/// A policy of a study under the name that it was given on the command line.
struct NamedPolicy {
  std::string name;
  PolicySettings settings;
};

struct StudyOptions {
  int runs = 100;
  std::uint64_t seed = 1;  ///< run r, from 1, has the seed seed + r - 1: `dwelld --seed` repeats it
  std::uint64_t scans = 60;
  int threads = 1;
  TimeWindow window;
};

struct Estimate {
  double mean = 0.0;
  double standard_error = 0.0;  ///< 0 with one run
};

/// Mean of root mean squares over runs at one scan time, per track.
struct SeriesPoint {
  double time_s = 0.0;
  double x_rms_m = 0.0;
  double y_rms_m = 0.0;
  double position_rms_m = 0.0;
  double position_rms_low_m = 0.0;  ///< 95 % band of the mean square, as root
  double position_rms_high_m = 0.0;
  double filter_sigma_m = 0.0;  ///< root of the filter's mean position variance
};

struct PolicyOutcome {
  std::string name;
  std::vector<std::vector<double>> figures;  ///< [run][metric]
  std::vector<SeriesPoint> series;           ///< of every scan
  std::vector<ScanSample> first_run;         ///< its schedule
  std::vector<double> decision_us;           ///< of every decision of every run, sorted

  std::vector<double> of_metric(std::size_t metric) const;
};

/// The same runs under two policies, run by run.
struct PairedDifference {
  std::size_t a = 0;
  std::size_t b = 0;
  std::size_t metric = 0;
  double mean = 0.0;  ///< of a - b
  double low = 0.0;   ///< 95 % interval, Student's t
  double high = 0.0;
  double a_better_share = 0.0;  ///< of the runs: a below b
};

struct Study {
  StudyOptions options;
  std::vector<std::string> metrics;
  std::vector<PolicyOutcome> policies;
  int runs_done = 0;  ///< fewer than asked where it was cut short
};

/// Every policy over the same seeds: common random numbers. Results do not depend on the number of threads: a run
/// is one task, and sums are taken in the order of the runs. `stop` cuts short: the runs that every policy has
/// finished count. `progress` is called with (runs done, runs in all), from any thread, one at a time.
Study run_study(const EngineConfig& config, const std::vector<NamedPolicy>& policies, const StudyOptions& options,
                const std::atomic<bool>& stop, const std::function<void(int, int)>& progress);

/// All pairs of policies for one metric.
std::vector<PairedDifference> paired_differences(const Study& study, std::size_t metric);

Estimate estimate(const std::vector<double>& values);

/// The quantile of Student's t with `degrees` of freedom that leaves 2.5 % above it.
double student_975(int degrees);

}  // namespace dwell
