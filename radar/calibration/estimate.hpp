#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "radar/calibration/correction.hpp"
#include "radar/calibration/window.hpp"

namespace dwell {

enum class EstimatorStatus {
  kDone,
  kTooFewPlots,
  kNotFinite,    ///< a plot, or the likelihood where the solve began
  kNotPositive,  ///< the information has no Cholesky factor
  kNotConverged,
  kTimeLimit,
  kStopped,
};
/// The reason as people read it; "" of kDone.
std::string to_string(EstimatorStatus status);

/// What a window says of its radars. Parameters are stacked radar by radar, in the order of CorrectionKind, and are
/// what the radars are beyond their configured figures. On any status but kDone only `status` and `plots` stand.
struct CalibrationEstimate {
  static constexpr double kObservableShare = 0.04;

  EstimatorStatus status = EstimatorStatus::kTooFewPlots;
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;      ///< C = (I + Lambda)^-1, I the plots' information, Lambda the prior's
  Eigen::MatrixXd prior_part;      ///< C Lambda C: what of C the prior answers for
  std::vector<int> plots;          ///< of each radar
  std::vector<double> nis_before;  ///< mean per radar, at the start, of no outliers: 2 if it is right; 0: no plots
  std::vector<double> nis_after;
  double log_likelihood_gain = 0.0;  ///< of the posterior, from start to end
  int evaluations = 0;

  int radars() const { return static_cast<int>(plots.size()); }
  Correction correction(int radar) const {
    return to_correction(value.segment<kCorrectionSize>(radar * kCorrectionSize));
  }
  double standard_error(int radar, CorrectionKind kind) const;
  /// Of the posterior variance along `direction` the part that is prior, 0 .. 1: d'C Lambda C d / d'C d. 0 is all
  /// plots; 1 all prior, the plots say nothing.
  double prior_share(const Eigen::VectorXd& direction) const;
  double prior_share(int radar, CorrectionKind kind) const;
  /// The plots fix it to a fifth of what was expected before them, its prior sigma: a share under 1/25.
  bool observable(int radar, CorrectionKind kind) const { return prior_share(radar, kind) < kObservableShare; }
  /// Likewise of the difference of a parameter between two radars.
  bool difference_observable(int radar, int other, CorrectionKind kind) const;

 private:
  static int place(int radar, CorrectionKind kind) { return radar * kCorrectionSize + static_cast<int>(kind); }
};

/// The plots of each radar.
std::vector<int> plots_of_radars(const CalibrationWindow& window);

/// Puts beside `result.value` what belongs to it: covariance and prior part from the window's information there, the
/// NIS at `start` and there. The status says whether that could be done.
void complete(const CalibrationWindow& window, const MotionPrior& motion, std::span<const Correction> start,
              const CorrectionPrior& prior, CalibrationEstimate& result);

/// L L' = I + information in units of the prior's sigmas: sigma L^-T are coordinates in which information and prior
/// together are the identity. Empty where that is not positive definite.
std::optional<Eigen::MatrixXd> whitening(const Eigen::MatrixXd& information, const Eigen::VectorXd& sigma);

}  // namespace dwell
