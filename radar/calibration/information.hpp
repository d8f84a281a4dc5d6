#pragma once

#include <optional>
#include <span>
#include <vector>

#include "radar/calibration/correction.hpp"
#include "radar/calibration/window.hpp"

namespace dwell {

/// What a window's plots would say of all radars' corrections at `theta` if each plot's mode were known, without a
/// prior: 5 R x 5 R, stacked radar by radar in the order of CorrectionKind. Empty where it is not finite. Never
/// indefinite: a metric wherever a solve begins. With one mode it is the Fisher information of the innovations.
///
///   I = sum_i sum_j w_ij (dnu_j' S_j^-1 dnu_j + 1/2 tr(S_j^-1 dS_j S_j^-1 dS_j))
///
/// w_ij the modes' weights given the plot, the outlier component (of no information) among them.
std::optional<Eigen::MatrixXd> complete_information(const CalibrationWindow& window, const MotionPrior& motion,
                                                    std::span<const Correction> theta);

/// Mean NIS of each radar's plots at `theta`: sum_j w_j nu_j' S_j^-1 nu_j averaged, whose expectation is 2 under the
/// model, mixtures included. 0 for a radar without plots.
std::vector<double> mean_nis(const CalibrationWindow& window, const MotionPrior& motion,
                             std::span<const Correction> theta);

/// log p of the window at `theta`, without the prior. Not finite where a number fails.
double log_likelihood(const CalibrationWindow& window, const MotionPrior& motion, std::span<const Correction> theta);

/// Minus the same, and its gradient, at stacked parameters. False where it is not finite.
bool negative_log_likelihood(const CalibrationWindow& window, const MotionPrior& motion, const Eigen::VectorXd& theta,
                             double& cost, Eigen::VectorXd& gradient);

/// The observed information at `theta`, without a prior: the second derivatives of minus log p, by central differences
/// of the exact gradient over a tenth of the standard errors that `complete_information` and the prior's `sigma` leave.
/// Its mean over windows at the true parameters is the Fisher information of the window under the motion prior. Empty
/// where it is not finite.
///
/// Louis (1982) has it without differences: the complete information less the variance of the components' scores. With
/// the components' expected information in the place of their observed one that is off by more than what is left: in
/// one of thirty windows of recorded flights indefinite where the second derivatives are as usual.
std::optional<Eigen::MatrixXd> observed_information(const CalibrationWindow& window, const MotionPrior& motion,
                                                    std::span<const Correction> theta, const Eigen::VectorXd& sigma);

/// Corrections as one vector, 5 R, and back.
Eigen::VectorXd stacked(std::span<const Correction> corrections);
std::vector<Correction> unstacked(const Eigen::VectorXd& theta);

/// Noise scales within a factor of a thousand, and all of it finite.
bool in_bounds(const Eigen::VectorXd& theta);
/// Every number of every plot.
bool is_finite(const CalibrationWindow& window);

}  // namespace dwell
