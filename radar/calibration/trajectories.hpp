#pragma once

#include <cstddef>
#include <vector>

#include "radar/calibration/trajectory_chain.hpp"
#include "radar/calibration/window.hpp"

namespace dwell::calibration {

using PairVector = Eigen::Matrix<double, 2 * kStateSize, 1>;
using PairMatrix = Eigen::Matrix<double, 2 * kStateSize, 2 * kStateSize>;

/// Between two plots of a trajectory: what is believed of the motion there, as a Gaussian factor of the two states
/// x = [x_i; x_i+1], exp(-x' Lambda x / 2 + eta' x).
struct Gap {
  std::size_t from;  ///< state i
  const MotionStep* step;
  bool first;  ///< of its trajectory
  PairMatrix information = PairMatrix::Zero();
  PairVector pull = PairVector::Zero();
};

/// The window's states and how they are linked.
struct Trajectories {
  std::vector<State> x;
  std::vector<int> state_of_plot;  // -1 where the truth is known
  std::vector<std::size_t> heads;
  std::vector<State> head_mean;
  std::vector<Gap> gaps;
};

/// A state at every plot whose target is not known, at the track's prediction; a gap to the one before where the motion
/// prior reaches so far, else a new start. The gaps begin with the modes' average motion and noise.
Trajectories lay_out(const CalibrationWindow& window, const MotionPrior& motion);

/// Of a trajectory's start: that of InnovationFilter.
State start_sigma();

/// Starts and gaps, in their place in the normal equations.
void add_motion(const Trajectories& trajectories, TrajectoryChain& chain);

/// One round of expectation propagation over the gaps, under the states' posterior `chain`. Without its own factor a
/// gap's states have the Gaussian of information J = C^-1 - Lambda; with mode j in the place of the factor,
///
///   J_j = J + M_j' Q_j^-1 M_j,  M_j = [-F_j I],      e_j = |Q_j|^-1/2 |J_j|^-1/2 exp(..)   the mode's evidence
///
/// the modes' probabilities follow from the evidence forward and backward along the trajectory, and the new factor is
/// what gives the states the mean and covariance of that mixture; it is reached a part `step` of the way. Negative
/// directions are left out.
/// Source  Minka (2001), UAI 17; Heskes, Zoeter (2002), UAI 18, for switching systems; Rabiner (1989), Proc. IEEE 77.
void update_motion(const MotionPrior& motion, const TrajectoryChain& chain, double step, Trajectories& trajectories);

}  // namespace dwell::calibration
