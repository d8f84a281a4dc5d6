#pragma once

#include "bandit/policy.hpp"
#include "bandit/policy_settings.hpp"
#include "bandit/track_turns.hpp"

namespace dwell {

/// One sensor, its tracks in turn: minus the turns until a track is next; other sensors only where that one can do
/// nothing, after all its turns. Source: Evans et al. (2005), V, the "single sensor" policies.
class Fixed final : public Policy {
 public:
  explicit Fixed(const FixedSettings& settings) : settings_(settings) {}

  std::string_view name() const override { return "fixed"; }

 private:
  void score(const Situation& situation, std::span<Candidate> candidates) override;
  void chose(const Situation& situation, const Decision& decision) override;

  FixedSettings settings_;
  TrackTurns turns_;
  TrackId last_track_;
};

}  // namespace dwell
