#pragma once

#include <optional>

#include "radar/ids.hpp"
#include "radar/state.hpp"
#include "radar/time.hpp"

namespace dwell {

/// One look: which radar, for which track, when, and where it points (the track's predicted state).
struct Dwell {
  RadarId radar;
  TrackId track;
  TimePoint time;
  State pointing;
};

/// One detection. `z` is (range_m, azimuth_rad) of a range-bearing radar, C x + v of a linear sensor.
struct Plot {
  TimePoint time;
  RadarId radar;
  Vector2 z;
  std::optional<TargetId> source;  ///< simulation only; empty for a false alarm. The tracker never reads it.
  std::optional<int> declared = std::nullopt;  ///< class, from 0; empty where the sensor declares none
};

}  // namespace dwell
