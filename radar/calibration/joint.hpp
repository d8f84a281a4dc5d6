#pragma once

#include <span>

#include "radar/calibration/estimator.hpp"

namespace dwell {

/// Trajectories and radars together: nonlinear least squares over the state at every plot and all radars' biases, with
/// the noise scales by variance components.
///
///   sum_plots  rho(|(z - h(x_i, b)) / (e^s sigma)|^2)  +  sum_gaps |[x_i; x_i+1] - c|^2_Lambda
///     + sum_radars |b / sigma_prior|^2  +  a trajectory's start, as wide as in InnovationFilter
///
/// solved by Ceres with automatic derivatives, h that of `Correction`, rho that of a plot which is an outlier with a
/// small probability. Between the solves, until nothing moves:
///
///   Lambda, c  the mixture of modes over a gap as a Gaussian, by expectation propagation (trajectories.hpp)
///   e^2s       sum of w r^2 / sum of w (1 - h),  r in configured sigmas, h the leverage of the plot, w = rho'
///
/// A second method for what `estimate_corrections` answers, from the same model: smoothed states in the place of
/// innovations. Covariance and observability are of the same information. Plots with a known truth have no state.
/// Shapes, errors   as of estimate_corrections; `log_likelihood_gain` is of the innovations' posterior.
/// Cost     O(plots) a round; some tens of rounds.
/// Source   Triggs et al. (2000), Bundle Adjustment; Foerstner (1979), Z. Vermessungswesen 104, 149, for variance
///          components by redundancy; Heskes, Zoeter (2002), UAI 18, for the modes.
CalibrationEstimate estimate_jointly(const CalibrationWindow& window, const MotionPrior& motion,
                                     std::span<const Correction> start, const EstimatorSettings& settings);

}  // namespace dwell
