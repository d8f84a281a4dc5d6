#pragma once

#include "bandit/policy.hpp"
#include "bandit/track_turns.hpp"

namespace dwell {

struct RoundRobinSettings {
  enum class Order {
    kRadarFastest,  ///< the sensor changes every scan, the track after all sensors: rr9 of PAPERS scenario 2
    kTrackFastest,  ///< the track changes every scan, the sensor after all tracks: rr9t
    kLocked,        ///< both change every scan: rrlock
  };
  Order order = Order::kRadarFastest;
};

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
