#include "bandit/round_robin.hpp"

namespace dwell {

/// Sensor and rank of the track whose turn it is.
RoundRobin::Turn RoundRobin::next_turn(const Situation& situation) const {
  if (!last_sensor_) return {0, 0};
  const std::size_t sensors = situation.sensors.size();
  const std::size_t next_sensor = (*last_sensor_ + 1) % sensors;
  switch (settings_.order) {
    case RoundRobinSettings::Order::kRadarFastest: {
      // The last track's rank is the one before the next, if it lives.
      const std::size_t before = (turns_.wrapped() ? turns_.count() : turns_.next()) - 1;
      const bool round_ends = next_sensor == 0 || !last_track_lives(situation);
      return round_ends ? Turn{0, turns_.next()} : Turn{next_sensor, before};
    }
    case RoundRobinSettings::Order::kTrackFastest:
      return {turns_.wrapped() ? next_sensor : *last_sensor_, turns_.next()};
    case RoundRobinSettings::Order::kLocked:
      break;
  }
  return {next_sensor, turns_.next()};
}

bool RoundRobin::last_track_lives(const Situation& situation) const {
  for (const Track& track : situation.tracks) {
    if (track.id == last_track_) return track.alive();
  }
  return false;
}

void RoundRobin::score(const Situation& situation, std::span<Candidate> candidates) {
  turns_.set(situation.tracks, last_track_);
  const std::size_t sensors = situation.sensors.size();
  const std::size_t tracks = turns_.count();
  const std::size_t looks = static_cast<std::size_t>(situation.looks);
  const Turn next = next_turn(situation);
  for (Candidate& candidate : candidates) {
    const std::size_t sensor = candidate.pair.sensor;
    const std::size_t rank = turns_.rank(candidate.pair.track);
    const std::size_t sensor_turns = (sensor + sensors - next.sensor) % sensors;
    const std::size_t track_turns = (rank + tracks - next.rank) % tracks;
    std::size_t away = 0;
    switch (settings_.order) {
      case RoundRobinSettings::Order::kRadarFastest:
        away = (rank * sensors + sensor + tracks * sensors - (next.rank * sensors + next.sensor)) % (tracks * sensors);
        break;
      case RoundRobinSettings::Order::kTrackFastest:
        away = (sensor * tracks + rank + tracks * sensors - (next.sensor * tracks + next.rank)) % (tracks * sensors);
        break;
      case RoundRobinSettings::Order::kLocked:
        away = sensor_turns * tracks + track_turns;
        break;
    }
    const bool beside = sensor_turns == track_turns && sensor_turns < looks;
    candidate.score = 0.0 - static_cast<double>(beside ? sensor_turns : away + looks - 1);
  }
}

void RoundRobin::chose(const Situation& situation, const Decision& decision) {
  if (decision.owed) return;
  last_sensor_ = decision.pair(0).sensor;
  last_track_ = situation.tracks[decision.pair(0).track].id;
}

}  // namespace dwell
