#include "bandit/sa_imm.hpp"

namespace dwell {
namespace {

StateMatrix weight_of(SaImmSettings::Cost cost) {
  switch (cost) {
    case SaImmSettings::Cost::kPosition:
      return position_weight();
    case SaImmSettings::Cost::kXOnly:
      return State::Unit(kX) * State::Unit(kX).transpose();
    case SaImmSettings::Cost::kFull:
      return StateMatrix::Identity();
    case SaImmSettings::Cost::kNone:
      break;
  }
  return StateMatrix::Zero();
}

}  // namespace

SaImm::SaImm(const SaImmSettings& settings)
    : expected_cost_({weight_of(settings.cost), settings.beta}, settings.nodes) {}

void SaImm::score(const Situation& situation, std::span<Candidate> candidates) {
  for (Candidate& candidate : candidates) {
    const Track& track = situation.tracks[candidate.pair.track];
    const Sensor& sensor = *situation.sensors[candidate.pair.sensor];
    const double without = expected_cost_.without_look(track.estimate);
    double with = without;
    // On a numerical error `with` stays as it is: the look is taken to be of no use.
    (void)expected_cost_.with_look(track.estimate, sensor, situation.update, with);
    candidate.cost_without_look = track.weight * without;
    candidate.expected_cost = track.weight * with;
    candidate.score = track.weight * (without - with) - situation.usage_cost[candidate.pair.sensor];
  }
}

}  // namespace dwell
