#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "radar/state.hpp"

namespace dwell {

/// One plot that a track was updated with, and what the filter expected: all that calibration keeps of a look.
struct CalibrationPlot {
  std::uint64_t scan = 0;
  std::uint32_t track = 0;
  std::uint32_t radar = 0;          ///< index into the window's radars
  Vector2 z = Vector2::Zero();      ///< range_m, azimuth_rad
  Vector2 sigma = Vector2::Ones();  ///< as configured, at the predicted range: m, rad
  State predicted = State::Zero();  ///< the track's mean before the plot
  std::optional<State> truth = {};  ///< where the target was: of a calibration flight; of all plots of a track, or none
};

/// How targets move over a number of scans: modes x' = F_j x + w, w ~ N(0, Q_j), and the chain between them.
/// This is the stated motion prior: what can be said of a radar depends on it.
struct MotionStep {
  std::vector<StateMatrix> f;
  std::vector<StateMatrix> q;
  Eigen::MatrixXd transition;  ///< M x M, rows sum to one
};
struct MotionPrior {
  std::vector<MotionStep> steps;        ///< over 0, 1, .. scans; a longer gap starts the track anew
  Eigen::VectorXd initial_probability;  ///< of the modes
};

/// Plots of a window, by track and then in order of time.
struct CalibrationWindow {
  std::vector<Vector2> radar_position_m;
  std::vector<double> outlier_density;  ///< of each radar: of a plot that is not of the target, per m and rad
  std::vector<CalibrationPlot> plots;
};

/// Puts the plots into the window's order.
void sort_plots(std::vector<CalibrationPlot>& plots);

}  // namespace dwell
