#include "bandit/round_robin.hpp"

#include <algorithm>

namespace dwell {
namespace {

/// Turns from `last` on to `place` in a cycle of `length`; a first turn starts at place 0.
std::size_t turns(std::optional<std::size_t> last, std::size_t place, std::size_t length) {
  return last ? (place + length - *last - 1) % length : place;
}

}  // namespace

void RoundRobin::score(const Situation& situation, std::span<Candidate> candidates) {
  // Places by track number, not by rank: a track that comes or goes does not move the others' turns.
  const std::size_t sensors = situation.sensors.size();
  std::size_t tracks = last_track_.number + 1;
  for (const Track& track : situation.tracks) tracks = std::max<std::size_t>(tracks, track.id.number + 1);
  const std::optional<std::size_t> last_track =
      last_sensor_ ? std::optional<std::size_t>(last_track_.number) : std::nullopt;
  for (Candidate& candidate : candidates) {
    const std::size_t sensor = candidate.pair.sensor;
    const std::size_t track = situation.tracks[candidate.pair.track].id.number;
    std::size_t away = 0;
    switch (settings_.order) {
      case RoundRobinSettings::Order::kRadarFastest: {
        const auto last = last_sensor_ ? std::optional(*last_track * sensors + *last_sensor_) : std::nullopt;
        away = turns(last, track * sensors + sensor, tracks * sensors);
        break;
      }
      case RoundRobinSettings::Order::kTrackFastest: {
        const auto last = last_sensor_ ? std::optional(*last_sensor_ * tracks + *last_track) : std::nullopt;
        away = turns(last, sensor * tracks + track, tracks * sensors);
        break;
      }
      case RoundRobinSettings::Order::kLocked:
        away = turns(last_sensor_, sensor, sensors) * tracks + turns(last_track, track, tracks);
        break;
    }
    candidate.score = -static_cast<double>(away);
  }
}

void RoundRobin::chose(const Situation& situation, const Pair& pair) {
  last_sensor_ = pair.sensor;
  last_track_ = situation.tracks[pair.track].id;
}

}  // namespace dwell
