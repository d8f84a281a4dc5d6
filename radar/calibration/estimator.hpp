#pragma once

#include <functional>
#include <limits>
#include <span>

#include "radar/calibration/estimate.hpp"
#include "radar/calibration/information.hpp"

namespace dwell {

struct EstimatorSettings {
  CorrectionPrior prior;
  int least_plots = 10;                                           ///< of a window; twice the parameters of one radar
  int most_iterations = 90;                                       ///< whitened as they are the parameters take 10 to 30
  double time_limit_s = std::numeric_limits<double>::infinity();  ///< of each round of 15 iterations
  std::function<bool()> stop;                                     ///< asked at every evaluation: true ends the solve
};

/// Maximum a posteriori estimate of all radars' corrections from the plots of a window.
///
///   -log p(theta | z) = sum_i -log p(z_i | z_1 .. z_i-1, theta) + 1/2 theta' Lambda theta + const
///
/// with the densities of InnovationFilter, minimised by Ceres (L-BFGS) with automatic derivatives, from `start`, in
/// coordinates in which information plus prior at `start` is the identity.
///
/// Shapes   R radars: `start` R corrections, estimate 5 R.
/// Errors   in `status`; never throws for numbers.
/// Source   Ljung (1999), System Identification, 7.4, 9.4.
CalibrationEstimate estimate_corrections(const CalibrationWindow& window, const MotionPrior& motion,
                                         std::span<const Correction> start, const EstimatorSettings& settings);

}  // namespace dwell
