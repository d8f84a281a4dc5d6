#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "bandit/restless/value_set.hpp"
#include "bandit/track_path.hpp"

namespace dwell {

/// Coordinates of a priced target on the grid of value sets.
///
/// Lengths are in units of l, the standard deviation of the leading radar across its line of sight (its larger one),
/// time in scans T, the price in units of weight l^2; the plane is turned so that this direction is the x axis, and
/// mirrored so that the other radar's is at 0 .. 90 degrees. In these units a target is
///
///   q       T^2 tr(Q of the velocities) / 2 l^2, Q of the predicted mode mix: the square of the tracking index
///   price   of a look
///   flat    the leading radar's smaller variance over its larger one
///   size    the other radar's larger variance over l^2, its own flatness, and the angle between the two large axes
///
/// q and price are in steps of a factor 2, between which values are interpolated; the others are rounded, to factors 4
/// and to 30 degrees. Variances of less than q 2^-kMostQ l^2 count as that much: what a scan adds is then all that is
/// not known, whatever the radar.
///
/// Looks of a set always detect: one that misses is taken to be repeated at once, so that a detection costs price / P_d
/// of the leading radar. What looks may miss now and in the next scan the policy works out itself.
///
/// The other radar is there where it matters: a look of each leaves at most 80 % of what two of the leading one leave.
/// Third radars are left out of the value of later scans, never out of the choice of this one.
struct BucketKey {
  static constexpr double kStep = 2.0;          ///< of q and price
  static constexpr double kStepVariance = 4.0;  ///< of the others but the angle
  static constexpr int kAngles = 3;             ///< of 30 degrees
  static constexpr int kFlattest = -7;          ///< 4^-7: a thinner ellipse costs as much
  static constexpr int kLeastQ = -30;           ///< a tracking index of 3e-5
  static constexpr int kMostQ = 8;
  static constexpr int kFarthest = 100;  ///< of the price, in steps from 1
  static constexpr std::int8_t kAlone = 127;

  std::int8_t q = 0, price = 0;
  std::int8_t flat = 0;
  std::int8_t size = kAlone, other_flat = 0, angle = 0;

  bool operator==(const BucketKey&) const = default;
  /// A number for each key; never 0.
  std::uint64_t packed() const;
  static BucketKey unpacked(std::uint64_t packed);
};

/// Where a track is on the grid, and how its covariances are brought there.
struct BucketPlace {
  double q = 0.0, price = 0.0;                 ///< in steps
  BucketKey cell;                              ///< its lowest corner
  StateMatrix to_units = StateMatrix::Zero();  ///< A: covariance A P A' in the units above
  double unit_cost = 1.0;                      ///< weight l^2, m^2
  std::size_t leading = 0;                     ///< sensor of the situation
  double p_detect = 1.0;                       ///< of the leading radar
};

/// Of the track that the path is laid for, at the leading radar's price of `prices`, one a sensor; empty where no radar
/// measures its position. The noise is the mean over the path's scans after now: as far as the track waits for its next
/// look.
std::optional<BucketPlace> place_of(const Situation& situation, std::size_t track, TrackPath& path,
                                    std::span<const double> prices);

/// The corners of a cell of the grid, from its lowest: q, then price, a step up.
inline constexpr int kCorners = 4;
BucketKey corner_of(const BucketKey& lowest, int corner);
/// Of bilinear interpolation in the place's cell; they sum to 1.
std::array<double, kCorners> corner_weights(const BucketPlace& place);

/// The target at a point of the grid, and the price there.
restless::Arm arm_of(const BucketKey& key);
double price_of(const BucketKey& key);

}  // namespace dwell
