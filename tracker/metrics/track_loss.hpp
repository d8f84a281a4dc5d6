#pragma once

#include <cmath>

#include "radar/sensor.hpp"

namespace dwell {

/// The rule of the benchmark problems by which a track is lost: a look that points at it would no longer have the
/// target. The limits are a beamwidth in azimuth and 1.5 range gates there; here they are given.
/// Source   Blair, Watson, Kirubarajan, Bar-Shalom (1998), "Benchmark for radar allocation and tracking in ECM", IEEE
///          T-AES 34(4).
///
/// Whether the target at `truth` is farther from the track at `mean` than `limit` in either component of the sensor's
/// measurement (range-bearing: metres and radians).
inline bool is_lost(const Sensor& sensor, const State& truth, const State& mean, const Vector2& limit) {
  const Vector2 apart = sensor.residual(sensor.measure(truth), sensor.measure(mean));
  return std::abs(apart[0]) > limit[0] || std::abs(apart[1]) > limit[1];
}

}  // namespace dwell
