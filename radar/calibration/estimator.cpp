#include "radar/calibration/estimator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include "radar/assert.hpp"

namespace dwell {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kIterationsOfARound = 15;
/// Of the log posterior: what a round may gain where the one before had come to the top.
constexpr double kNothing = 1e-3;

/// The posterior in coordinates phi: theta = start + transform phi.
class Posterior final : public ceres::FirstOrderFunction {
 public:
  Posterior(const CalibrationWindow& window, const MotionPrior& motion, VectorXd start, MatrixXd transform,
            VectorXd sigma, const std::function<bool()>& stop)
      : window_(window),
        motion_(motion),
        start_(std::move(start)),
        transform_(std::move(transform)),
        sigma_(std::move(sigma)),
        stop_(stop) {}

  VectorXd theta(const VectorXd& phi) const { return start_ + transform_ * phi; }

  bool Evaluate(const double* phi, double* cost, double* gradient) const override {
    ++evaluations_;
    stopped_ = stopped_ || (stop_ && stop_());
    if (stopped_) return false;
    const VectorXd at = theta(Eigen::Map<const VectorXd>(phi, start_.size()));
    VectorXd slope;
    if (!negative_log_likelihood(window_, motion_, at, *cost, slope)) return false;
    const VectorXd scaled = at.cwiseQuotient(sigma_);
    *cost += 0.5 * scaled.squaredNorm();
    slope += scaled.cwiseQuotient(sigma_);
    if (gradient != nullptr) Eigen::Map<VectorXd>(gradient, start_.size()) = transform_.transpose() * slope;
    return true;
  }
  int NumParameters() const override { return static_cast<int>(start_.size()); }

  int evaluations() const { return evaluations_; }
  bool stopped() const { return stopped_; }

 private:
  const CalibrationWindow& window_;
  const MotionPrior& motion_;
  VectorXd start_;
  MatrixXd transform_;
  VectorXd sigma_;
  std::function<bool()> stop_;
  mutable int evaluations_ = 0;
  mutable bool stopped_ = false;
};

EstimatorStatus solve(const ceres::GradientProblem& problem, const Posterior& posterior, int iterations,
                      double time_limit_s, VectorXd& phi, double& gain) {
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::LBFGS;
  options.max_num_iterations = iterations;
  options.max_solver_time_in_seconds = std::min(time_limit_s, 1e9);
  // In these coordinates a gradient of g is g standard errors from the top: a hundredth of one is nothing.
  options.gradient_tolerance = 1e-2;
  options.function_tolerance = 1e-9;  // of some thousands: the same hundredth
  options.parameter_tolerance = 0.0;
  options.logging_type = ceres::SILENT;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, phi.data(), &summary);
  gain = summary.initial_cost - summary.final_cost;
  if (posterior.stopped()) return EstimatorStatus::kStopped;
  if (summary.termination_type == ceres::CONVERGENCE) return EstimatorStatus::kDone;
  if (summary.termination_type == ceres::FAILURE) return EstimatorStatus::kNotFinite;
  return summary.total_time_in_seconds >= time_limit_s ? EstimatorStatus::kTimeLimit : EstimatorStatus::kNotConverged;
}

}  // namespace

CalibrationEstimate estimate_corrections(const CalibrationWindow& window, const MotionPrior& motion,
                                         std::span<const Correction> start, const EstimatorSettings& settings) {
  const auto radars = std::ssize(window.radar_position_m);
  DWELL_ASSERT(std::ssize(start) == radars && std::ssize(window.outlier_density) == radars);
  CalibrationEstimate result;
  result.plots = plots_of_radars(window);
  const auto failed = [&](EstimatorStatus status) {
    result.status = status;
    return result;
  };
  if (std::ssize(window.plots) < settings.least_plots) return failed(EstimatorStatus::kTooFewPlots);
  const VectorXd begin = stacked(start);
  if (!is_finite(window) || !in_bounds(begin)) return failed(EstimatorStatus::kNotFinite);

  const VectorXd sigma = sigmas_of(settings.prior).replicate(radars, 1);
  // Far from the end the coordinates of the start fit badly, and steps that are too small there look like the top: it
  // is one when a round in coordinates of its own finds nothing higher.
  VectorXd theta = begin;
  EstimatorStatus status = EstimatorStatus::kNotConverged;
  for (int left = settings.most_iterations; left > 0 && status == EstimatorStatus::kNotConverged;) {
    const auto metric = complete_information(window, motion, unstacked(theta));
    if (!metric) return failed(EstimatorStatus::kNotFinite);
    const auto coordinates = whitening(*metric, sigma);
    if (!coordinates) return failed(EstimatorStatus::kNotPositive);
    auto* posterior = new Posterior(window, motion, theta, *coordinates, sigma, settings.stop);
    const ceres::GradientProblem problem(posterior);  // owns it
    VectorXd phi = VectorXd::Zero(theta.size());
    const int iterations = std::min(left, kIterationsOfARound);
    double gain = 0.0;
    status = solve(problem, *posterior, iterations, settings.time_limit_s, phi, gain);
    left -= iterations;
    theta = posterior->theta(phi);
    if (status == EstimatorStatus::kDone && gain > kNothing) status = EstimatorStatus::kNotConverged;
    result.log_likelihood_gain += gain;
    result.evaluations += posterior->evaluations();
  }
  if (status != EstimatorStatus::kDone) return failed(status);

  result.value = theta;
  complete(window, motion, start, settings.prior, result);
  return result;
}

}  // namespace dwell
