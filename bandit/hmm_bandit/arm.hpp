#pragma once

#include <vector>

#include <Eigen/Core>

#include "radar/violation.hpp"

namespace dwell::hmm_bandit {

inline constexpr int kMaximumStates = 64;

/// An arm whose hidden state moves, and shows a symbol, only when the arm is played.
///
/// Played at belief pi: it earns reward'pi, the state moves, a symbol y is seen, and
///
///   pi+ = B_y A' pi / s,   s = 1' B_y A' pi = P(y),   B_y = diag(emission(., y))
///
/// Not played: pi stays. That is what makes the index rule optimal (Gittins).
struct Arm {
  Eigen::MatrixXd transition;  ///< A, n x n, rows sum to one
  Eigen::MatrixXd emission;    ///< n x symbols: P(y | state after the move), rows sum to one
  Eigen::VectorXd reward;      ///< n; a cost is a negative reward
  Eigen::VectorXd belief;      ///< n, sums to one: before the first play

  int states() const { return static_cast<int>(transition.rows()); }
  int symbols() const { return static_cast<int>(emission.cols()); }
};

struct Problem {
  double discount = 0.9;  ///< (0, 1)
  std::vector<Arm> arms;
};

/// B_y A' for each symbol: unnormalised updates, n x n.
std::vector<Eigen::MatrixXd> update_maps(const Arm& arm);

/// Everything that is wrong with the problem; empty: it can be solved. Counted from 1: "arm[2].belief".
std::vector<Violation> validate(const Problem& problem);

}  // namespace dwell::hmm_bandit
