#pragma once

#include <cmath>
#include <span>

#include "radar/state.hpp"
#include "tracker/metrics/assignment.hpp"

namespace dwell {

/// Generalised optimal subpattern assignment of order 2 with alpha = 2, taken apart, m^2.
struct Gospa {
  double localisation = 0.0;  ///< sum of squared distances of the targets and tracks that belong together
  double missed = 0.0;        ///< c^2 / 2 for each target without a track
  double false_tracks = 0.0;  ///< c^2 / 2 for each track without a target

  /// The metric, m.
  double value() const { return std::sqrt(localisation + missed + false_tracks); }
};

/// Distance of a set of tracks from the set of targets, by position.
///
///   min over assignments of  sum d^2 + c^2 / 2 (targets without + tracks without),   pairs with d < c alone
///
/// c is the distance from which on a track is not that target's. A metric: symmetric, zero for equal sets, and the
/// triangle inequality holds.
/// Source   Rahmathullah, Garcia-Fernandez, Svensson (2017), FUSION, Proposition 1.
inline Gospa gospa(std::span<const Vector2> targets_m, std::span<const Vector2> tracks_m, double c_m) {
  const auto targets = static_cast<Eigen::Index>(targets_m.size());
  const auto tracks = static_cast<Eigen::Index>(tracks_m.size());
  const double alone = 0.5 * c_m * c_m;
  // A target may also take one of `targets` columns that stand for no track: then a track is left over besides, and a
  // pair saves c^2 against leaving both alone.
  Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(targets, tracks + targets);
  for (Eigen::Index i = 0; i < targets; ++i) {
    for (Eigen::Index j = 0; j < tracks; ++j) {
      const double d2 = (targets_m[static_cast<std::size_t>(i)] - tracks_m[static_cast<std::size_t>(j)]).squaredNorm();
      cost(i, j) = std::min(d2, c_m * c_m) - c_m * c_m;
    }
  }
  Gospa parts;
  Eigen::Index pairs = 0;
  const std::vector<Eigen::Index> column = assign(cost);
  for (Eigen::Index i = 0; i < targets; ++i) {
    const Eigen::Index j = column[static_cast<std::size_t>(i)];
    if (j >= tracks || cost(i, j) >= 0.0) continue;
    parts.localisation += cost(i, j) + c_m * c_m;
    ++pairs;
  }
  parts.missed = alone * static_cast<double>(targets - pairs);
  parts.false_tracks = alone * static_cast<double>(tracks - pairs);
  return parts;
}

}  // namespace dwell
