#include "bandit/best_looks.hpp"

#include <algorithm>
#include <limits>

namespace dwell {
namespace {

constexpr double kUnreached = -std::numeric_limits<double>::infinity();

}  // namespace

void BestLooks::add(const Situation& situation, Decision& decision) {
  sensors_ = situation.sensors.size();
  tracks_ = situation.tracks.size();
  candidate_.assign(sensors_ * tracks_, kNone);
  look_.assign(sensors_, kNone);
  looked_at_.assign(tracks_, 0);
  for (std::size_t c = 0; c < decision.candidates.size(); ++c) {
    const Pair& pair = decision.candidates[c].pair;
    const bool taken = std::any_of(decision.chosen.begin(), decision.chosen.end(), [&](std::size_t chosen) {
      const Pair& other = decision.candidates[chosen].pair;
      return other.sensor == pair.sensor || other.track == pair.track;
    });
    if (!taken) candidate(pair.sensor, pair.track) = c;
  }
  const std::ptrdiff_t first = std::ssize(decision.chosen);
  for (std::ptrdiff_t look = first; look < situation.looks && augment(decision); ++look) {
  }
  for (const std::size_t c : look_) {
    if (c != kNone) decision.chosen.push_back(c);
  }
  std::sort(decision.chosen.begin() + first, decision.chosen.end(), [&](std::size_t a, std::size_t b) {
    const double score_a = decision.candidates[a].score;
    const double score_b = decision.candidates[b].score;
    return score_a > score_b || (score_a == score_b && a < b);
  });
}

/// One look more, at the best total; false where there is none.
bool BestLooks::augment(const Decision& decision) {
  const auto score = [&](std::size_t c) { return c == kNone ? kUnreached : decision.candidates[c].score; };
  gain_.assign(sensors_, kUnreached);
  before_.assign(sensors_, kNone);
  for (std::size_t s = 0; s < sensors_; ++s) {
    if (look_[s] == kNone) gain_[s] = 0.0;
  }
  // Bellman and Ford's: the sensor `from` takes over the track of the sensor `to`.
  bool changed = true;
  for (std::size_t round = 0; changed && round < sensors_; ++round) {
    changed = false;
    for (std::size_t to = 0; to < sensors_; ++to) {
      if (look_[to] == kNone) continue;
      for (std::size_t from = 0; from < sensors_; ++from) {
        const std::size_t over = candidate(from, decision.candidates[look_[to]].pair.track);
        if (from == to || gain_[from] == kUnreached || over == kNone) continue;
        const double gain = gain_[from] + score(over) - score(look_[to]);
        if (!(gain > gain_[to])) continue;
        gain_[to] = gain;
        before_[to] = from;
        changed = true;
      }
    }
  }
  double best = kUnreached;
  std::size_t last = kNone;  // the candidate that ends the path
  for (std::size_t s = 0; s < sensors_; ++s) {
    for (std::size_t t = 0; t < tracks_ && gain_[s] != kUnreached; ++t) {
      const std::size_t c = candidate(s, t);
      if (looked_at_[t] != 0 || c == kNone) continue;
      const double gain = gain_[s] + score(c);
      if (gain < best || (gain == best && c > last)) continue;
      best = gain;
      last = c;
    }
  }
  if (last == kNone) return false;
  looked_at_[decision.candidates[last].pair.track] = 1;
  for (std::size_t s = decision.candidates[last].pair.sensor; s != kNone; s = before_[s]) {
    const std::size_t given_up = look_[s];
    look_[s] = last;
    if (before_[s] != kNone) last = candidate(before_[s], decision.candidates[given_up].pair.track);
  }
  return true;
}

}  // namespace dwell
