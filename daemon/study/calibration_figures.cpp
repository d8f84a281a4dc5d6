#include "daemon/study/calibration_figures.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>

#include <boost/math/distributions/chi_squared.hpp>

namespace dwell {
namespace {

constexpr std::uint64_t kMostPlots = 100'000;  // the latest, as in the config

/// One run: what was estimated, and what could be.
struct Trial {
  CalibrationEstimate estimate;
  Eigen::MatrixXd information;  // of the plots, at the truth; empty where it is not finite
  Eigen::VectorXd score;        // there
};

Trial try_estimate(const Engine& engine, bool joint, std::span<const Correction> truth) {
  const CalibrationTask task = engine.calibrator().task(engine.last().scan, joint);
  Trial trial;
  trial.estimate = solve(task, {}).estimate;
  const Eigen::VectorXd sigma = sigmas_of(task.prior).replicate(std::ssize(truth), 1);
  const auto information = observed_information(task.window, *task.motion, truth, sigma);
  double cost = 0.0;
  if (information && negative_log_likelihood(task.window, *task.motion, stacked(truth), cost, trial.score)) {
    trial.information = *information;
  }
  return trial;
}

/// The radars and what they truly are.
std::vector<Correction> begin_figures(const EngineConfig& config, CalibrationFigures& figures) {
  std::vector<Correction> truth;
  for (const SensorConfig& sensor : config.sensors) {
    if (!std::holds_alternative<RadarFigures>(sensor.figures)) continue;
    truth.push_back(sensor.truth.correction);
    figures.radars.push_back({sensor.name, {}});
    for (int k = 0; k < kCorrectionSize; ++k) figures.radars.back().parameters[k].truth = to_vector(truth.back())[k];
  }
  return truth;
}

/// Of the mean of n NIS, each chi-square with two degrees of freedom.
bool in_band(double nis, int plots) {
  const boost::math::chi_squared distribution(2.0 * plots);
  const double sum = nis * plots;
  return boost::math::quantile(distribution, 0.025) <= sum && sum <= boost::math::quantile(distribution, 0.975);
}

void add(const Trial& trial, std::span<const Correction> truth, CalibrationFigures& figures) {
  const CalibrationEstimate& estimate = trial.estimate;
  if (estimate.status != EstimatorStatus::kDone) {
    figures.failure = to_string(estimate.status);
    return;
  }
  ++figures.solved;
  for (int i = 0; i < estimate.radars(); ++i) {
    CalibratedRadar& radar = figures.radars[i];
    const CorrectionVector value = to_vector(estimate.correction(i));
    for (int k = 0; k < kCorrectionSize; ++k) {
      const auto kind = static_cast<CorrectionKind>(k);
      CalibratedParameter& parameter = radar.parameters[k];
      const double error = value[k] - to_vector(truth[i])[k];
      const double reported = estimate.standard_error(i, kind);
      parameter.mean += value[k];
      parameter.squared_error += error * error;
      parameter.standard_error += reported;
      parameter.within_two += std::abs(error) <= 2.0 * reported;
      parameter.within_three += std::abs(error) <= 3.0 * reported;
      parameter.observable += estimate.observable(i, kind);
    }
    if (estimate.plots[i] == 0) continue;
    radar.plots += estimate.plots[i];
    radar.nis_before += estimate.nis_before[i];
    radar.nis_after += estimate.nis_after[i];
    radar.in_band_before += in_band(estimate.nis_before[i], estimate.plots[i]);
    radar.in_band_after += in_band(estimate.nis_after[i], estimate.plots[i]);
  }
}

void divide(CalibrationFigures& figures) {
  if (figures.solved == 0) return;
  for (CalibratedRadar& radar : figures.radars) {
    for (CalibratedParameter& parameter : radar.parameters) {
      for (double* sum : {&parameter.mean, &parameter.squared_error, &parameter.standard_error}) {
        *sum /= figures.solved;
      }
    }
    for (double* sum : {&radar.plots, &radar.nis_before, &radar.nis_after}) *sum /= figures.solved;
  }
}

/// C = (I + Lambda)^-1 of the runs' mean information, and C (S + Lambda) C of their mean square score S.
void set_bounds(const std::vector<std::optional<Trial>>& trials, const CorrectionPrior& prior,
                CalibrationFigures& figures) {
  const auto size = std::ssize(figures.radars) * kCorrectionSize;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd squared_score = information;
  std::vector<const Trial*> valid;
  for (const auto& trial : trials) {
    if (!trial || trial->information.size() == 0) continue;
    information += trial->information;
    squared_score += trial->score * trial->score.transpose();
    valid.push_back(&*trial);
  }
  const auto count = static_cast<double>(std::max(valid.size(), std::size_t{1}));
  const Eigen::VectorXd sigma = sigmas_of(prior).replicate(std::ssize(figures.radars), 1);
  const auto root = whitening(information / count, sigma);
  if (!root) return;
  const Eigen::MatrixXd c = *root * root->transpose();
  squared_score /= count;
  squared_score.diagonal() += sigma.cwiseAbs2().cwiseInverse();
  for (Eigen::Index i = 0; i < size; ++i) {
    CalibratedParameter& parameter = figures.radars[i / kCorrectionSize].parameters[i % kCorrectionSize];
    parameter.bound = std::sqrt(c(i, i));
    parameter.misspecified = std::sqrt(c.col(i).dot(squared_score * c.col(i)));
    double squared = 0.0;  // d c_ii = -c_i' dI c_i
    for (const Trial* trial : valid) {
      const double off = c.col(i).dot((trial->information - information / count) * c.col(i));
      squared += off * off;
    }
    parameter.bound_error = std::sqrt(squared) / count / (2.0 * parameter.bound);
  }
}

}  // namespace

int window_of(const EngineConfig& config, std::uint64_t scans) {
  return static_cast<int>(std::min(scans * static_cast<std::uint64_t>(config.looks_per_scan), kMostPlots));
}

CalibrationFigures calibration_of(const Engine& engine, bool joint) {
  CalibrationFigures figures;
  const std::vector<Correction> truth = begin_figures(engine.config(), figures);
  const std::vector<std::optional<Trial>> trials{try_estimate(engine, joint, truth)};
  figures.runs = 1;
  add(*trials.front(), truth, figures);
  divide(figures);
  set_bounds(trials, engine.config().calibration.prior, figures);
  return figures;
}

CalibrationFigures study_calibration(const EngineConfig& config, const CalibrationStudyOptions& options,
                                     const std::atomic<bool>& stop, const std::function<void(int, int)>& progress) {
  EngineConfig of_study = config;
  of_study.calibration.mode = CalibrationMode::kObserve;
  of_study.calibration.window_plots = window_of(config, options.scans);
  CalibrationFigures figures;
  const std::vector<Correction> truth = begin_figures(config, figures);
  std::vector<std::optional<Trial>> trials(static_cast<std::size_t>(options.runs));
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  const auto work = [&] {
    for (std::size_t run = next++; run < trials.size() && !stop; run = next++) {
      EngineConfig of_run = of_study;
      of_run.seed = options.seed + run;
      Engine engine(of_run);
      while (engine.last().scan < options.scans) engine.scan();
      Trial trial = try_estimate(engine, options.joint, truth);
      const std::lock_guard lock(mutex);
      trials[run] = std::move(trial);
      progress(++figures.runs, options.runs);
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < options.threads; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  for (const auto& trial : trials) {
    if (trial) add(*trial, truth, figures);
  }
  divide(figures);
  set_bounds(trials, config.calibration.prior, figures);
  return figures;
}

}  // namespace dwell
