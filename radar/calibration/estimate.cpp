#include "radar/calibration/estimate.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "radar/calibration/information.hpp"
#include "radar/calibration/innovations.hpp"

namespace dwell {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The plots that at `theta` are likelier the target's than not.
CalibrationWindow without_outliers(const CalibrationWindow& window, const MotionPrior& motion,
                                   std::span<const Correction> theta) {
  std::vector<calibration::RadarParameters<double>> parameters;
  for (const Correction& c : theta) {
    parameters.push_back({std::exp(c.log_range_scale), std::exp(c.log_azimuth_scale), c.range_bias_m,
                          c.azimuth_bias_rad, c.time_bias_s});
  }
  CalibrationWindow kept = window;
  kept.plots.clear();
  calibration::InnovationFilter<double> filter(window, motion);
  filter.run(parameters, [&](std::size_t plot, auto, double log_outlier, double log_density) {
    if (log_outlier - log_density < std::log(0.5)) kept.plots.push_back(window.plots[plot]);
  });
  return kept;
}

}  // namespace

std::string to_string(EstimatorStatus status) {
  switch (status) {
    case EstimatorStatus::kDone:
      return "";
    case EstimatorStatus::kTooFewPlots:
      return "too few plots";
    case EstimatorStatus::kNotFinite:
      return "a number that is not finite";
    case EstimatorStatus::kNotPositive:
      return "information without rank";
    case EstimatorStatus::kNotConverged:
      return "not converged";
    case EstimatorStatus::kTimeLimit:
      return "time limit";
    case EstimatorStatus::kStopped:
      break;
  }
  return "stopped";
}

double CalibrationEstimate::standard_error(int radar, CorrectionKind kind) const {
  return std::sqrt(covariance(place(radar, kind), place(radar, kind)));
}

double CalibrationEstimate::prior_share(const VectorXd& direction) const {
  return direction.dot(prior_part * direction) / direction.dot(covariance * direction);
}

double CalibrationEstimate::prior_share(int radar, CorrectionKind kind) const {
  return prior_share(VectorXd::Unit(value.size(), place(radar, kind)));
}

bool CalibrationEstimate::difference_observable(int radar, int other, CorrectionKind kind) const {
  VectorXd direction = VectorXd::Zero(value.size());
  direction[place(radar, kind)] = 1.0;
  direction[place(other, kind)] = -1.0;
  return prior_share(direction) < kObservableShare;
}

std::vector<int> plots_of_radars(const CalibrationWindow& window) {
  std::vector<int> plots(window.radar_position_m.size(), 0);
  for (const CalibrationPlot& plot : window.plots) ++plots[plot.radar];
  return plots;
}

void complete(const CalibrationWindow& window, const MotionPrior& motion, std::span<const Correction> start,
              const CorrectionPrior& prior, CalibrationEstimate& result) {
  const std::vector<Correction> end = unstacked(result.value);
  const VectorXd sigma = sigmas_of(prior).replicate(std::ssize(start), 1);
  const auto information = observed_information(window, motion, end, sigma);
  const auto root = information ? whitening(*information, sigma) : std::nullopt;
  if (!root) {
    result.status = EstimatorStatus::kNotPositive;
    return;
  }
  result.covariance = *root * root->transpose();
  const VectorXd lambda = sigma.cwiseAbs2().cwiseInverse();
  result.prior_part = result.covariance * lambda.asDiagonal() * result.covariance;
  const CalibrationWindow of_targets = without_outliers(window, motion, end);
  result.nis_before = mean_nis(of_targets, motion, start);
  result.nis_after = mean_nis(of_targets, motion, end);
  result.status = EstimatorStatus::kDone;
}

std::optional<MatrixXd> whitening(const MatrixXd& information, const VectorXd& sigma) {
  const auto size = sigma.size();
  const MatrixXd scaled = sigma.asDiagonal() * information * sigma.asDiagonal();
  const Eigen::LLT<MatrixXd> root(MatrixXd(0.5 * (scaled + scaled.transpose()) + MatrixXd::Identity(size, size)));
  if (!scaled.allFinite() || root.info() != Eigen::Success) return std::nullopt;
  return sigma.asDiagonal() * MatrixXd(root.matrixU().solve(MatrixXd::Identity(size, size)));
}

}  // namespace dwell
