#include "bandit/fixed.hpp"

namespace dwell {

void Fixed::score(const Situation& situation, std::span<Candidate> candidates) {
  turns_.set(situation.tracks, last_track_);
  const std::size_t tracks = turns_.count();
  for (Candidate& candidate : candidates) {
    const std::size_t away = (turns_.rank(candidate.pair.track) + tracks - turns_.next()) % tracks;
    const bool other_sensor = candidate.pair.sensor + 1 != static_cast<std::size_t>(settings_.sensor);
    candidate.score = 0.0 - static_cast<double>(away + (other_sensor ? tracks : 0));
  }
}

void Fixed::chose(const Situation& situation, const Decision& decision) {
  if (decision.owed) return;
  last_track_ = situation.tracks[decision.pair(0).track].id;
}

}  // namespace dwell
