#pragma once

#include "bandit/policy.hpp"
#include "bandit/policy_settings.hpp"
#include "bandit/track_turns.hpp"

namespace dwell {

/// Sensors and tracks in turn. The score is minus the number of turns a pair is away from being next, so that what
/// cannot be looked at is passed over. With several looks a scan, look l, from 0, is of the pair l sensors and l tracks
/// on from the one whose turn it is: every sensor and every track has as many. Source: Evans et al. (2005), V.
class RoundRobin final : public Policy {
 public:
  explicit RoundRobin(const RoundRobinSettings& settings) : settings_(settings) {}

  std::string_view name() const override { return "round_robin"; }

 private:
  void score(const Situation& situation, std::span<Candidate> candidates) override;
  void chose(const Situation& situation, const Decision& decision) override;

  struct Turn {
    std::size_t sensor;
    std::size_t rank;
  };
  Turn next_turn(const Situation& situation) const;
  bool last_track_lives(const Situation& situation) const;

  RoundRobinSettings settings_;
  TrackTurns turns_;
  std::optional<std::size_t> last_sensor_;
  TrackId last_track_;
};

}  // namespace dwell
