#pragma once

#include <compare>
#include <cstdint>

namespace dwell {

/// A number that cannot be mistaken for one of another kind. Numbers start at 1.
template <class Tag>
struct Id {
  std::uint32_t number = 0;
  friend auto operator<=>(Id, Id) = default;
};

using RadarId = Id<struct RadarTag>;
using TargetId = Id<struct TargetTag>;
using TrackId = Id<struct TrackTag>;

}  // namespace dwell
