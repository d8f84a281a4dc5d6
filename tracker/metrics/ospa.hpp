#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "radar/state.hpp"
#include "tracker/metrics/assignment.hpp"

namespace dwell {

/// Optimal subpattern assignment distance of order 2 with cut-off c, m, between sets of m <= n positions:
///
///   sqrt( (min over assignments of sum min(d, c)^2 + c^2 (n - m)) / n );   0 for two empty sets
///
/// Divided by n it does not grow with the number of false tracks: `gospa` does.
/// Source   Schuhmacher, Vo, Vo (2008), IEEE T-SP 56(8), (3).
inline double ospa(std::span<const Vector2> one_m, std::span<const Vector2> other_m, double c_m) {
  if (one_m.size() > other_m.size()) std::swap(one_m, other_m);
  if (other_m.empty()) return 0.0;
  const auto rows = static_cast<Eigen::Index>(one_m.size());
  const auto columns = static_cast<Eigen::Index>(other_m.size());
  Eigen::MatrixXd cost(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      const double d = (one_m[static_cast<std::size_t>(i)] - other_m[static_cast<std::size_t>(j)]).norm();
      cost(i, j) = std::min(d, c_m) * std::min(d, c_m);
    }
  }
  double sum = c_m * c_m * static_cast<double>(columns - rows);
  const std::vector<Eigen::Index> column = assign(cost);
  for (Eigen::Index i = 0; i < rows; ++i) sum += cost(i, column[static_cast<std::size_t>(i)]);
  return std::sqrt(sum / static_cast<double>(columns));
}

}  // namespace dwell
