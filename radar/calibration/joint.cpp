#include "radar/calibration/joint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <ceres/autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "radar/assert.hpp"
#include "radar/calibration/joint_residuals.hpp"
#include "radar/calibration/trajectories.hpp"

namespace dwell {
namespace {

using namespace calibration;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kMostRounds = 200;
constexpr int kIterationsOfARound = 20;
/// Nothing moves: parts of a standard error.
constexpr double kStill = 0.05;

/// Part of the way that the gaps' factors go in a round. Half at first; then less and less, since mixtures that gain
/// and lose a direction leave the biases going to and fro by some hundredths of a standard error.
double step_of(int round) { return round <= 8 ? 0.5 : 4.0 / round; }

/// Ends a solve when it is asked to.
class Stop final : public ceres::IterationCallback {
 public:
  explicit Stop(const std::function<bool()>& asked) : asked_(asked) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    stopped_ = asked_ && asked_();
    return stopped_ ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }
  bool stopped() const { return stopped_; }

 private:
  const std::function<bool()>& asked_;
  bool stopped_ = false;
};

class JointSolver {
 public:
  JointSolver(const CalibrationWindow& window, const MotionPrior& motion, std::span<const Correction> start,
              const EstimatorSettings& settings)
      : window_(window),
        motion_(motion),
        settings_(settings),
        sigma_(sigmas_of(settings.prior)),
        trajectories_(lay_out(window, motion)),
        chain_(trajectories_.x.size(), std::ssize(start) * kBiasSize) {
    for (const Correction& correction : start) {
      bias_.push_back({correction.range_bias_m, correction.azimuth_bias_rad, correction.time_bias_s});
      log_scale_.push_back({correction.log_range_scale, correction.log_azimuth_scale});
    }
  }

  EstimatorStatus run() {
    while (rounds_ < kMostRounds) {
      ++rounds_;
      const std::vector<Vector3d> bias_before = bias_;
      const std::vector<Vector2> scale_before = log_scale_;
      const EstimatorStatus status = solve_states();
      if (status != EstimatorStatus::kDone) return status;
      if (!linearise()) return EstimatorStatus::kNotPositive;
      update_motion(motion_, chain_, step_of(rounds_), trajectories_);
      estimate_scales();
      if (!in_bounds(theta())) return EstimatorStatus::kNotPositive;  // plots without noise
      if (still(bias_before, scale_before)) return EstimatorStatus::kDone;
    }
    return EstimatorStatus::kNotConverged;
  }

  int rounds() const { return rounds_; }

  VectorXd theta() const {
    std::vector<Correction> corrections;
    for (std::size_t i = 0; i < bias_.size(); ++i) {
      corrections.push_back({log_scale_[i][0], log_scale_[i][1], bias_[i][0], bias_[i][1], bias_[i][2]});
    }
    return stacked(corrections);
  }

 private:
  Vector2 sigma_of(const CalibrationPlot& plot) const {
    return plot.sigma.cwiseProduct(log_scale_[plot.radar].array().exp().matrix());
  }
  PlotResidual residual_of(const CalibrationPlot& plot) const {
    return {plot.z, sigma_of(plot), window_.radar_position_m[plot.radar]};
  }
  OutlierLoss loss_of(const CalibrationPlot& plot) const {
    return OutlierLoss(window_.outlier_density[plot.radar] * sigma_of(plot).prod());
  }
  Vector3d bias_sigma() const { return sigma_.tail<kBiasSize>(); }

  /// Least squares with modes and scales as they are.
  EstimatorStatus solve_states() {
    ceres::Problem problem;
    for (Vector3d& bias : bias_) {
      problem.AddResidualBlock(new PriorResidual<kBiasSize>(Vector3d::Zero(), bias_sigma()), nullptr, bias.data());
    }
    for (std::size_t i = 0; i < window_.plots.size(); ++i) add_plot(i, problem);
    for (std::size_t i = 0; i < trajectories_.heads.size(); ++i) {
      problem.AddResidualBlock(new PriorResidual<kStateSize>(trajectories_.head_mean[i], start_sigma()), nullptr,
                               trajectories_.x[trajectories_.heads[i]].data());
    }
    for (const Gap& gap : trajectories_.gaps) {
      problem.AddResidualBlock(new MotionResidual(gap), nullptr, trajectories_.x[gap.from].data(),
                               trajectories_.x[gap.from + 1].data());
    }
    return minimise(problem);
  }

  void add_plot(std::size_t i, ceres::Problem& problem) {
    const CalibrationPlot& plot = window_.plots[i];
    auto* loss = new OutlierLoss(loss_of(plot));
    const int state = trajectories_.state_of_plot[i];
    if (state < 0) {
      using Cost = ceres::AutoDiffCostFunction<KnownPlotResidual, 2, kBiasSize>;
      problem.AddResidualBlock(new Cost(new KnownPlotResidual{residual_of(plot), *plot.truth}), loss,
                               bias_[plot.radar].data());
      return;
    }
    using Cost = ceres::AutoDiffCostFunction<PlotResidual, 2, kStateSize, kBiasSize>;
    problem.AddResidualBlock(new Cost(new PlotResidual(residual_of(plot))), loss, trajectories_.x[state].data(),
                             bias_[plot.radar].data());
  }

  EstimatorStatus minimise(ceres::Problem& problem) {
    Stop stop(settings_.stop);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = kIterationsOfARound;
    options.max_solver_time_in_seconds = std::min(settings_.time_limit_s, 1e9);
    options.function_tolerance = 1e-9;
    options.logging_type = ceres::SILENT;
    options.callbacks = {&stop};
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (stop.stopped()) return EstimatorStatus::kStopped;
    if (summary.termination_type == ceres::FAILURE) return EstimatorStatus::kNotFinite;
    const bool converged = summary.termination_type == ceres::CONVERGENCE;
    if (!converged && summary.total_time_in_seconds >= settings_.time_limit_s) return EstimatorStatus::kTimeLimit;
    return EstimatorStatus::kDone;  // or as far as a round goes
  }

  /// Of a plot at the present values: residual, derivatives by state and by the radar's biases, weight.
  struct Linear {
    Vector2 r;
    Eigen::Matrix<double, 2, kStateSize> by_state;
    Eigen::Matrix<double, 2, kBiasSize> by_bias;
    double weight;
  };
  Linear linear(std::size_t i) const {
    const CalibrationPlot& plot = window_.plots[i];
    const int state = trajectories_.state_of_plot[i];
    const State x = state < 0 ? *plot.truth : trajectories_.x[state];
    Linear out;
    using Dual = ceres::Jet<double, kStateSize + kBiasSize>;
    std::array<Dual, kStateSize> dual_x;
    std::array<Dual, kBiasSize> dual_b;
    for (int k = 0; k < kStateSize; ++k) dual_x[k] = Dual(x[k], k);
    for (int k = 0; k < kBiasSize; ++k) dual_b[k] = Dual(bias_[plot.radar][k], kStateSize + k);
    std::array<Dual, 2> r;
    residual_of(plot)(dual_x.data(), dual_b.data(), r.data());
    for (int k = 0; k < 2; ++k) {
      out.r[k] = r[k].a;
      out.by_state.row(k) = r[k].v.head<kStateSize>().transpose();
      out.by_bias.row(k) = r[k].v.tail<kBiasSize>().transpose();
    }
    out.weight = loss_of(plot).weight(out.r.squaredNorm());
    return out;
  }

  /// The normal equations at the present values, factored.
  bool linearise() {
    chain_ = TrajectoryChain(trajectories_.x.size(), std::ssize(bias_) * kBiasSize);
    linear_.clear();
    chain_.bias.diagonal() = bias_sigma().cwiseAbs2().cwiseInverse().replicate(std::ssize(bias_), 1);
    for (std::size_t i = 0; i < window_.plots.size(); ++i) {
      linear_.push_back(linear(i));
      const Linear& at = linear_.back();
      const Eigen::Index first = window_.plots[i].radar * kBiasSize;
      chain_.bias.block<kBiasSize, kBiasSize>(first, first) += at.weight * at.by_bias.transpose() * at.by_bias;
      const int state = trajectories_.state_of_plot[i];
      if (state < 0) continue;
      chain_.own[state] += at.weight * at.by_state.transpose() * at.by_state;
      chain_.coupling[state].middleCols<kBiasSize>(first) += at.weight * at.by_state.transpose() * at.by_bias;
    }
    add_motion(trajectories_, chain_);
    return chain_.factor();
  }

  /// Per radar and component: S e^-2s - n - s / sigma^2 = 0, S = sum w r^2 in configured sigmas, n = sum w (1 - h).
  void estimate_scales() {
    std::vector<Vector2> squares(bias_.size(), Vector2::Zero());
    std::vector<Vector2> redundancy(bias_.size(), Vector2::Zero());
    for (std::size_t i = 0; i < linear_.size(); ++i) {
      const std::uint32_t radar = window_.plots[i].radar;
      const Linear& at = linear_[i];
      squares[radar] += at.weight * at.r.cwiseAbs2();
      redundancy[radar] += at.weight * (Vector2::Ones() - leverage(i));
    }
    for (std::size_t i = 0; i < bias_.size(); ++i) {
      for (int k = 0; k < 2; ++k) {
        const double before = log_scale_[i][k];
        const double pull = 1.0 / (sigma_[k] * sigma_[k]);
        double step = 0.0;
        for (int newton = 0; newton < 30; ++newton) {
          const double s = squares[i][k] * std::exp(-2.0 * step);
          const double slope = 2.0 * s + pull;
          step = std::clamp(step + (s - redundancy[i][k] - pull * (before + step)) / slope, -1.0, 1.0);
        }
        log_scale_[i][k] = before + step;
      }
    }
  }

  /// w diag(J C J') of a plot.
  Vector2 leverage(std::size_t i) const {
    const Linear& at = linear_[i];
    const Eigen::Index first = window_.plots[i].radar * kBiasSize;
    Eigen::Matrix2d covariance =
        at.by_bias * chain_.bias_covariance().block<kBiasSize, kBiasSize>(first, first) * at.by_bias.transpose();
    if (const int state = trajectories_.state_of_plot[i]; state >= 0) {
      const Eigen::Matrix2d both =
          at.by_state * chain_.state_bias_covariance(state).middleCols<kBiasSize>(first) * at.by_bias.transpose();
      covariance += at.by_state * chain_.state_covariance(state) * at.by_state.transpose() + both + both.transpose();
    }
    return at.weight * covariance.diagonal();
  }

  bool still(const std::vector<Vector3d>& bias_before, const std::vector<Vector2>& scale_before) const {
    for (std::size_t i = 0; i < bias_.size(); ++i) {
      const Vector3d variance =
          chain_.bias_covariance().diagonal().segment<kBiasSize>(static_cast<Eigen::Index>(i) * kBiasSize);
      const Vector3d moved = (bias_[i] - bias_before[i]).cwiseAbs().cwiseQuotient(variance.cwiseSqrt());
      // A log scale from n plots has a standard error of sqrt(1 / 2 n) at the least.
      const double scale_sigma = 1.0 / std::sqrt(2.0 * static_cast<double>(window_.plots.size()) + 1.0);
      const double scaled = (log_scale_[i] - scale_before[i]).cwiseAbs().maxCoeff() / scale_sigma;
      if (std::max(moved.maxCoeff(), scaled) > kStill) return false;
    }
    return true;
  }

  const CalibrationWindow& window_;
  const MotionPrior& motion_;
  const EstimatorSettings& settings_;
  CorrectionVector sigma_;
  Trajectories trajectories_;
  std::vector<Vector3d> bias_;
  std::vector<Vector2> log_scale_;
  TrajectoryChain chain_;
  std::vector<Linear> linear_;
  int rounds_ = 0;
};

}  // namespace

CalibrationEstimate estimate_jointly(const CalibrationWindow& window, const MotionPrior& motion,
                                     std::span<const Correction> start, const EstimatorSettings& settings) {
  DWELL_ASSERT(start.size() == window.radar_position_m.size());
  CalibrationEstimate result;
  result.plots = plots_of_radars(window);
  if (std::ssize(window.plots) < settings.least_plots) return result;
  result.status = EstimatorStatus::kNotFinite;
  const VectorXd begin = stacked(start);
  if (!is_finite(window) || !in_bounds(begin)) return result;
  JointSolver solver(window, motion, start, settings);
  result.status = solver.run();
  if (result.status != EstimatorStatus::kDone) return result;
  result.value = solver.theta();
  result.evaluations = solver.rounds();
  const auto end = unstacked(result.value);
  const VectorXd sigma = sigmas_of(settings.prior).replicate(std::ssize(start), 1);
  const auto prior_cost = [&](const VectorXd& theta) { return 0.5 * theta.cwiseQuotient(sigma).squaredNorm(); };
  result.log_likelihood_gain = log_likelihood(window, motion, end) - prior_cost(result.value) -
                               log_likelihood(window, motion, start) + prior_cost(begin);
  complete(window, motion, start, settings.prior, result);
  return result;
}

}  // namespace dwell
