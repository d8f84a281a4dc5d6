#include "bandit/fixed.hpp"

#include <algorithm>

namespace dwell {

void Fixed::score(const Situation& situation, std::span<Candidate> candidates) {
  std::size_t length = last_track_.number + 1;
  for (const Track& track : situation.tracks) length = std::max<std::size_t>(length, track.id.number + 1);
  for (Candidate& candidate : candidates) {
    const std::size_t track = situation.tracks[candidate.pair.track].id.number;
    const std::size_t away = (track + length - last_track_.number - 1) % length;
    const bool other_sensor = candidate.pair.sensor + 1 != static_cast<std::size_t>(settings_.sensor);
    candidate.score = -static_cast<double>(away + (other_sensor ? length : 0));
  }
}

void Fixed::chose(const Situation& situation, const Pair& pair) { last_track_ = situation.tracks[pair.track].id; }

}  // namespace dwell
