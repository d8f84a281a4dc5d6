#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "bandit/lti/problem.hpp"

namespace dwell::lti {

/// A schedule and what it costs: its true covariance, whatever the policy reckoned with.
struct Solution {
  std::vector<int> schedule;          ///< N entries: 1 .. m, 0: idle
  double cost = 0.0;                  ///< the problem's objective
  double final_trace = 0.0;           ///< tr P[N]
  std::vector<double> traces;         ///< tr P[k], k = 1 .. N; with communication noise summed over nodes
  std::uint64_t expanded = 0;         ///< Riccati steps of single n x n covariances that the policy took
  std::vector<double> probabilities;  ///< `random`: of each sensor
  std::optional<double> bound;        ///< `random`: of what a steady step costs in the mean; absent where there is none
  std::vector<std::size_t> set_sizes;  ///< `relaxed_dp`: covariances kept after each step
};

/// Cost and final trace of a schedule of N entries. The other fields are empty.
/// Errors   std::overflow_error where the covariance is more than a double holds.
Solution evaluate(const Problem& problem, std::vector<int> schedule);

}  // namespace dwell::lti
