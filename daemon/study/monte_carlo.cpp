#include "daemon/study/monte_carlo.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <thread>

#include <boost/math/distributions/students_t.hpp>

#include "bandit/value_table.hpp"

namespace dwell {
namespace {

/// Results of runs in the order of runs, whoever made them.
using RunsOfPolicy = std::vector<RunResult>;

std::vector<SeriesPoint> series_of(const RunsOfPolicy& runs, double period_s) {
  std::vector<SeriesPoint> series;
  const std::size_t scans = runs.front().scans.size();
  for (std::size_t scan = 0; scan < scans; ++scan) {
    double tracks = 0.0, x = 0.0, y = 0.0, variance = 0.0;
    std::vector<double> squared;
    for (const RunResult& run : runs) {
      const ScanSample& sample = run.scans[scan];
      tracks += sample.tracks;
      x += sample.squared_x_error_m2;
      y += sample.squared_y_error_m2;
      variance += sample.position_variance_m2;
      if (sample.tracks > 0.0) {
        squared.push_back((sample.squared_x_error_m2 + sample.squared_y_error_m2) / sample.tracks);
      }
    }
    SeriesPoint point;
    point.time_s = static_cast<double>(scan + 1) * period_s;
    if (tracks > 0.0) {
      point.x_rms_m = std::sqrt(x / tracks);
      point.y_rms_m = std::sqrt(y / tracks);
      point.position_rms_m = std::sqrt((x + y) / tracks);
      point.filter_sigma_m = std::sqrt(variance / tracks);
      const Estimate mean = estimate(squared);
      const double half = student_975(std::max(1, static_cast<int>(squared.size()) - 1)) * mean.standard_error;
      point.position_rms_low_m = std::sqrt(std::max(0.0, mean.mean - half));
      point.position_rms_high_m = std::sqrt(mean.mean + half);
    }
    series.push_back(point);
  }
  return series;
}

PolicyOutcome outcome_of(const std::string& name, RunsOfPolicy runs, double period_s) {
  PolicyOutcome outcome;
  outcome.name = name;
  if (runs.empty()) return outcome;
  outcome.series = series_of(runs, period_s);
  outcome.first_run = runs.front().scans;
  for (RunResult& run : runs) {
    outcome.decision_us.insert(outcome.decision_us.end(), run.decision_us.begin(), run.decision_us.end());
    outcome.figures.push_back(std::move(run.figures));
  }
  std::sort(outcome.decision_us.begin(), outcome.decision_us.end());
  return outcome;
}

}  // namespace

std::vector<double> PolicyOutcome::of_metric(std::size_t metric) const {
  std::vector<double> values;
  for (const auto& run : figures) values.push_back(run[metric]);
  return values;
}

Estimate estimate(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  if (values.empty()) return {};
  double mean = 0.0;
  for (const double value : values) mean += value;
  mean /= count;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, values.size() > 1 ? std::sqrt(squares / (count - 1.0) / count) : 0.0};
}

double student_975(int degrees) {
  return boost::math::quantile(boost::math::students_t(static_cast<double>(degrees)), 0.975);
}

Study run_study(const EngineConfig& config, const std::vector<NamedPolicy>& policies, const StudyOptions& options,
                const std::atomic<bool>& stop, const std::function<void(int, int)>& progress) {
  const auto runs = static_cast<std::size_t>(options.runs);
  std::vector<RunsOfPolicy> results(policies.size(), RunsOfPolicy(runs));
  std::vector<char> done(runs, 0);
  const auto value_table = std::make_shared<ValueTable>();  // one for all runs
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  int finished = 0;
  const auto work = [&] {
    // A run of all policies is one task, so that what is finished can be compared.
    for (std::size_t run = next++; run < runs && !stop; run = next++) {
      EngineConfig of_run = config;
      of_run.seed = options.seed + run;
      of_run.value_table = value_table;
      for (std::size_t p = 0; p < policies.size(); ++p) {
        of_run.policy = policies[p].settings;
        results[p][run] = run_and_measure(of_run, options.scans, options.window);
      }
      const std::lock_guard lock(mutex);
      done[run] = 1;
      progress(++finished, options.runs);
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < options.threads; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();

  Study study{options, metric_names(config), {}, finished};
  for (std::size_t p = 0; p < policies.size(); ++p) {
    RunsOfPolicy finished_runs;
    for (std::size_t run = 0; run < runs; ++run) {
      if (done[run] != 0) finished_runs.push_back(std::move(results[p][run]));
    }
    study.policies.push_back(outcome_of(policies[p].name, std::move(finished_runs), to_seconds(config.scan_period)));
  }
  return study;
}

std::vector<PairedDifference> paired_differences(const Study& study, std::size_t metric) {
  std::vector<PairedDifference> pairs;
  for (std::size_t a = 0; a < study.policies.size(); ++a) {
    for (std::size_t b = a + 1; b < study.policies.size(); ++b) {
      const auto of_a = study.policies[a].of_metric(metric);
      const auto of_b = study.policies[b].of_metric(metric);
      std::vector<double> differences;
      double better = 0.0;
      for (std::size_t run = 0; run < of_a.size(); ++run) {
        differences.push_back(of_a[run] - of_b[run]);
        better += of_a[run] < of_b[run] ? 1.0 : 0.0;
      }
      if (differences.size() < 2) continue;
      const Estimate mean = estimate(differences);
      const double half = student_975(static_cast<int>(differences.size()) - 1) * mean.standard_error;
      pairs.push_back({a, b, metric, mean.mean, mean.mean - half, mean.mean + half,
                       better / static_cast<double>(differences.size())});
    }
  }
  return pairs;
}

}  // namespace dwell
