#include "bandit/largest_variance.hpp"

#include <algorithm>

namespace dwell {
namespace {

/// As sa_imm's default: the reduction of position variance by a look.
constexpr int kNodes = 5;

}  // namespace

LargestVariance::LargestVariance(const LargestVarianceSettings& /*settings*/)
    : expected_variance_({position_weight(), 0.0}, kNodes) {}

void LargestVariance::score(const Situation& situation, std::span<Candidate> candidates) {
  for (auto first = candidates.begin(); first != candidates.end();) {
    const Track& track = situation.tracks[first->pair.track];
    const auto last = std::find_if(
        first, candidates.end(), [&](const Candidate& candidate) { return candidate.pair.track != first->pair.track; });
    const double variance = expected_variance_.without_look(track.estimate);
    double best = 0.0;
    for (auto candidate = first; candidate != last; ++candidate) {
      double after = variance;
      // On a numerical error `after` stays: a look of no use.
      (void)expected_variance_.with_look(track.estimate, *situation.sensors[candidate->pair.sensor], situation.update,
                                         after);
      candidate->score = std::max(0.0, variance - after);
      best = std::max(best, candidate->score);
    }
    for (auto candidate = first; candidate != last; ++candidate) {
      const double share = best > 0.0 ? candidate->score / best : 1.0;
      candidate->score = track.weight * variance * share;
    }
    first = last;
  }
}

}  // namespace dwell
