#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace dwell {

/// Stream time: integer nanoseconds since the start of the run. It has no `now()`; the engine advances it.
struct StreamClock {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = std::chrono::nanoseconds;
  using time_point = std::chrono::time_point<StreamClock>;
  static constexpr bool is_steady = true;
};
using TimePoint = StreamClock::time_point;
using Duration = StreamClock::duration;

inline constexpr TimePoint kStreamStart{};

/// The nearest nanosecond; exact for every period that is a whole number of them. |seconds| < 9e9.
inline Duration from_seconds(double seconds) {
  // Whole seconds apart: a product of 1e9 s and 1e9 would have lost 128 ns.
  const double whole = std::trunc(seconds);
  return std::chrono::seconds{static_cast<std::int64_t>(whole)} + Duration{std::llround((seconds - whole) * 1e9)};
}
/// The nearest double: to_seconds(from_seconds(0.3)) == 0.3.
inline double to_seconds(Duration duration) { return static_cast<double>(duration.count()) / 1e9; }
inline double to_seconds(TimePoint time) { return to_seconds(time.time_since_epoch()); }

}  // namespace dwell
