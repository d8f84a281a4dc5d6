#pragma once

#include <optional>
#include <vector>

#include "bandit/restless/problem.hpp"

namespace dwell::restless {

/// Whittle's index of a one-state arm and one of its sensors as a table over log p, linear between.
///
/// P_d = 1: exact values at 2000 variances; 1e-3 of the index, which bends where the words of its orbits change. P_d <
/// 1: the threshold variance at 60 prices spread evenly in log, by the mesh; 1e-2. It only ranks.
class IndexTable {
 public:
  /// Covers the variances from the process noise, or p0 if that is less, to that after 200 idle scans from p0 or 1000
  /// times it. Index 0 where a look gains nothing: weight 0, or a sensor that does not see the state.
  IndexTable(const Arm& arm, std::size_t sensor, std::optional<double> discount);

  double operator()(double p) const;

 private:
  std::vector<double> log_p_;
  std::vector<double> index_;
};

/// Exact where P_d = 1, calibrated otherwise: one value, at p. Requires a one-state arm.
double whittle_of(const Arm& arm, std::size_t sensor, std::optional<double> discount, double p);

}  // namespace dwell::restless
