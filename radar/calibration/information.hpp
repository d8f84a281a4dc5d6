#pragma once

#include <optional>
#include <span>
#include <vector>

#include "radar/calibration/correction.hpp"
#include "radar/calibration/window.hpp"

namespace dwell {

enum class Information {
  kComplete,  ///< as if each plot's mode were known: never indefinite, a metric wherever a solve begins
  kObserved,  ///< of the mixture
};

/// What a window's plots say of all radars' corrections at `theta`, without a prior: 5 R x 5 R, stacked radar by radar
/// in the order of CorrectionKind. Empty where it is not finite. At the true parameters its inverse is the Cramer-Rao
/// bound of the window under the motion prior.
///
/// The information is the observed one of a mixture whose components enter by their expected (Fisher) information:
///
///   I = sum_i sum_j w_ij (dnu_j' S_j^-1 dnu_j + 1/2 tr(S_j^-1 dS_j S_j^-1 dS_j)) - Var_w(d log c_j N_j)
///
/// w_ij the modes' weights given the plot, the outlier component (of no information) among them. With one mode it is
/// the exact Fisher information of the innovations.
///
/// Source   Louis (1982), J. R. Stat. Soc. B 44, (3.1).
std::optional<Eigen::MatrixXd> plot_information(const CalibrationWindow& window, const MotionPrior& motion,
                                                std::span<const Correction> theta,
                                                Information kind = Information::kObserved);

/// Mean NIS of each radar's plots at `theta`: sum_j w_j nu_j' S_j^-1 nu_j averaged, whose expectation is 2 under the
/// model, mixtures included. 0 for a radar without plots.
std::vector<double> mean_nis(const CalibrationWindow& window, const MotionPrior& motion,
                             std::span<const Correction> theta);

/// log p of the window at `theta`, without the prior. Not finite where a number fails.
double log_likelihood(const CalibrationWindow& window, const MotionPrior& motion, std::span<const Correction> theta);

/// Minus the same, and its gradient, at stacked parameters. False where it is not finite.
bool negative_log_likelihood(const CalibrationWindow& window, const MotionPrior& motion, const Eigen::VectorXd& theta,
                             double& cost, Eigen::VectorXd& gradient);

/// The second derivatives of minus log p at `theta`, by central differences of the gradient over +-`step`. Exact where
/// the information above, whose components enter by their expectation, is not definite. Empty where it is not finite.
std::optional<Eigen::MatrixXd> curvature(const CalibrationWindow& window, const MotionPrior& motion,
                                         const Eigen::VectorXd& theta, const Eigen::VectorXd& step);

/// Corrections as one vector, 5 R, and back.
Eigen::VectorXd stacked(std::span<const Correction> corrections);
std::vector<Correction> unstacked(const Eigen::VectorXd& theta);

/// Noise scales within a factor of a thousand, and all of it finite.
bool in_bounds(const Eigen::VectorXd& theta);
/// Every number of every plot.
bool is_finite(const CalibrationWindow& window);

}  // namespace dwell
