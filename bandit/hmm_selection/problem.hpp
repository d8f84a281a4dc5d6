#pragma once

#include <vector>

#include <Eigen/Core>

#include "radar/violation.hpp"

namespace dwell::hmm_selection {

inline constexpr int kMaximumStates = 1000;
inline constexpr int kMaximumHorizon = 100'000;

struct Sensor {
  Eigen::MatrixXd emission;  ///< states x symbols: P(y | state); rows sum to one
  double cost = 0.0;         ///< of one look, >= 0
};

/// One Markov chain with s states, several sensors, one look a step: which sensor, given what was seen?
///
///   pi_k(y) = Phi_y A' pi_{k-1} / p(y),   p(y) = 1' Phi_y A' pi_{k-1},   Phi_y = diag of column y of the emission
///   cost of step k = beta (1 - pi_k' pi_k) + cost of the look,  k = 1 .. N, summed; expected over what is seen
///
/// A is the transition matrix, rows sum to one; 1 - pi'pi is the chance that a second draw from pi differs from the
/// first: 0 where the state is known.
/// Source  Evans et al. (2005), III-C, IV-A (alpha = 0).
struct Problem {
  Eigen::MatrixXd transition;  ///< s x s
  Eigen::VectorXd belief;      ///< pi_0, before the first transition
  int horizon = 0;             ///< N
  double beta = 1.0;           ///< > 0
  std::vector<Sensor> sensors;

  int states() const { return static_cast<int>(transition.rows()); }
  int sensor_count() const { return static_cast<int>(sensors.size()); }
};

/// Everything that is wrong with the problem; empty: it can be solved. Sensors are counted from 1.
std::vector<Violation> validate(const Problem& problem);

}  // namespace dwell::hmm_selection
