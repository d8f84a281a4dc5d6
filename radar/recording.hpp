#pragma once

#include <iosfwd>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "radar/trajectory.hpp"

namespace dwell {

/// One aircraft of a recording: WGS-84 degrees and metres at increasing Unix times.
struct RecordedFlight {
  struct Sample {
    Duration unix_time;
    double latitude_deg;
    double longitude_deg;
    double altitude_m;
  };
  std::string id;
  std::vector<Sample> samples;
};

/// Reads CSV with the header `time_s,lat,lon,alt_m,id`; flights in the order in which their ids first appear.
/// Requires finite numbers, |lat| <= 90, |lon| <= 180, |alt_m| <= 1e6, |time_s| <= 4.6e9, times that increase within an
/// id, four rows or more an id.
/// Errors   InvalidInput with every violation and its line; `source` names the input in it.
std::vector<RecordedFlight> read_recording(std::istream& input, std::string_view source);

/// A flight in the local plane: east, north and up of each sample, and the cubic splines through them.
///
/// The plane touches WGS-84 at the middle of the flight's box of latitude and longitude, and that point becomes the
/// origin; GeographicLib's LocalCartesian. Horizontal distances shrink by the cosine of the angle from there:
/// 1.2e-4 at 100 km. Longitudes that cross 180 degrees are unwrapped for the box.
/// The splines are natural (zero second derivative at the ends) and twice differentiable.
class FlightPath {
 public:
  /// Uses the samples from `begin` after the flight's first on, for `length` at most.
  /// Requires begin and length of 0 or more, and four samples in that span (see `samples_in`).
  FlightPath(const RecordedFlight& flight, Duration begin, Duration length);

  Duration length() const { return times_.back(); }
  /// State relative to the origin, and altitude. Requires 0 <= since_begin <= length().
  State state(Duration since_begin) const;
  double altitude_m(Duration since_begin) const;

  static int samples_in(const RecordedFlight& flight, Duration begin, Duration length);

 private:
  struct Interval {
    Eigen::Index index;
    double width_s;
    double a;  // weight of the left knot
    double b;  // weight of the right knot
  };
  Interval locate(Duration since_begin) const;

  std::vector<Duration> times_;  // since begin
  Eigen::Matrix3Xd points_;      // east, north, up of each sample, metres
  Eigen::Matrix3Xd curvature_;   // second derivatives there, m/s^2
};

/// A recorded flight put somewhere in time and place.
class RecordedTrajectory final : public Trajectory {
 public:
  RecordedTrajectory(std::shared_ptr<const FlightPath> path, TimePoint start, TimePoint end, Vector2 offset_m);

  std::optional<State> advance(TimePoint time) override;
  bool ended(TimePoint time) const override { return time > end_; }
  double altitude_m() const override { return altitude_m_; }

 private:
  std::shared_ptr<const FlightPath> path_;
  TimePoint start_;
  TimePoint end_;
  Vector2 offset_m_;
  double altitude_m_ = 0.0;
};

}  // namespace dwell
