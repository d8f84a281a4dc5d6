#include "bandit/policy.hpp"

#include <algorithm>
#include <cmath>

#include "radar/assert.hpp"

namespace dwell {
namespace {

bool conflicts(const Decision& decision, const Pair& pair) {
  return std::any_of(decision.chosen.begin(), decision.chosen.end(), [&](std::size_t taken) {
    const Pair& other = decision.candidates[taken].pair;
    return other.sensor == pair.sensor || other.track == pair.track;
  });
}

/// The place of the best candidate that matches and conflicts with no choice; empty where there is none.
std::optional<std::size_t> best_free(const Decision& decision, const Owed& wanted = {}) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < decision.candidates.size(); ++i) {
    const Candidate& candidate = decision.candidates[i];
    if (!wanted.matches(candidate.pair) || conflicts(decision, candidate.pair)) continue;
    if (!best || candidate.score > decision.candidates[*best].score) best = i;
  }
  return best;
}

std::optional<double> margin(const Decision& decision) {
  std::optional<double> runner_up;
  for (std::size_t i = 0; i < decision.candidates.size(); ++i) {
    if (std::find(decision.chosen.begin(), decision.chosen.end(), i) != decision.chosen.end()) continue;
    runner_up = std::max(runner_up.value_or(decision.candidates[i].score), decision.candidates[i].score);
  }
  if (!runner_up) return std::nullopt;
  return decision.candidates[decision.chosen.front()].score - *runner_up;
}

}  // namespace

void Policy::decide(const Situation& situation, Decision& decision) {
  decision.candidates.clear();
  decision.chosen.clear();
  decision.margin.reset();
  decision.owed = false;
  decision.fell_back = false;
  decision.answered_by = {};
  decision.relaxed.reset();
  for (const Pair& pair : situation.feasible) {
    const Track& track = situation.tracks[pair.track];
    decision.candidates.push_back({pair, 0.0, {}, {}, {}, {}});
    if (track.class_belief.size() > 0) decision.candidates.back().weight = track.weight;
  }
  if (decision.candidates.empty()) return;
  score(situation, decision.candidates);
  for (const Candidate& candidate : decision.candidates) DWELL_ASSERT(std::isfinite(candidate.score));
  const std::size_t best = *best_free(decision);
  for (const Owed& owed : situation.owed) {
    if (std::ssize(decision.chosen) == situation.looks) break;
    if (const auto next = best_free(decision, owed)) decision.chosen.push_back(*next);
  }
  const auto score_of = [&](std::size_t c) { return decision.candidates[c].score; };
  decision.owed = !decision.chosen.empty() && score_of(decision.chosen.front()) < score_of(best);
  choose(situation, decision);
  chose(situation, decision);
  decision.margin = margin(decision);
}

void Policy::choose(const Situation& situation, Decision& decision) {
  while (std::ssize(decision.chosen) < situation.looks) {
    const auto next = best_free(decision);
    if (!next) return;
    decision.chosen.push_back(*next);
  }
}

}  // namespace dwell
