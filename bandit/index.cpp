#include "bandit/index.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "radar/assert.hpp"

namespace dwell {
namespace {

/// A track's noise is that of the mode mix over so many scans at most.
constexpr int kLongestWait = 16;
/// How a set's rate of looks falls with the price: rate ~ price^-1/4.
constexpr double kRateExponent = 0.25;
/// Most that the price's correction moves in a scan, relative, and in all, either way.
constexpr double kCorrectionStep = 0.03;
constexpr double kMostCorrection = 100.0;
constexpr double kNone = -std::numeric_limits<double>::infinity();

}  // namespace

Index::Index(const IndexSettings& settings) : depth_(settings.depth), orbit_(OrbitSettings{}) {
  DWELL_ASSERT(depth_ >= 1 && depth_ <= kMostDepth);
}

void Index::decide(const Situation& situation, Decision& decision) {
  by_orbit_ = false;
  Policy::decide(situation, decision);
  if (decision.candidates.empty()) return;
  decision.fell_back = by_orbit_;
  if (by_orbit_) {
    decision.answered_by = "orbit";
    return;
  }
  decision.relaxed = Relaxed{mean_price(), reference_};
}

void Index::score(const Situation& situation, std::span<Candidate> candidates) {
  situation_ = &situation;
  ++scan_;
  ValueTable& table = situation.value_table != nullptr ? *situation.value_table : own_table_;
  follow_tracks(situation);
  set_prices(situation);
  take_sets(situation, table);
  find_price(situation);
  by_orbit_ = !all_have_sets(candidates);
  if (by_orbit_) {
    score_by_orbit(orbit_, situation, candidates);
    const auto best = std::max_element(candidates.begin(), candidates.end(),
                                       [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
    if (price_ == 0.0) price_ = std::max(best->score, 0.0);
    return;
  }
  score_advantages(situation, candidates);
  correct_prices(situation, candidates);
  if (depth_ > 1) look_ahead(situation, candidates);
}

/// What is held of each track, in the order of the situation; tracks that are gone are forgotten.
void Index::follow_tracks(const Situation& situation) {
  std::swap(held_, before_);
  held_.clear();
  std::size_t at = 0;
  for (const Track& track : situation.tracks) {
    if (at >= before_.size() || before_[at].track != track.id) {
      const auto found =
          std::find_if(before_.begin(), before_.end(), [&](const Held& h) { return h.track == track.id; });
      at = static_cast<std::size_t>(found - before_.begin());
    }
    if (at < before_.size()) {
      held_.push_back(std::move(before_[at++]));
    } else {
      held_.emplace_back().track = track.id;
    }
  }
}

void Index::take_sets(const Situation& situation, ValueTable& table) {
  const std::size_t tracks = situation.tracks.size();
  const auto wait = static_cast<int>(tracks) / std::max(situation.looks, 1);
  cells_.assign(tracks, nullptr);
  table.begin_scan();
  if (paths_.size() < tracks) paths_.resize(tracks);
  for (std::size_t i = 0; i < tracks; ++i) {
    if (!situation.tracks[i].alive()) continue;
    Held& held = held_[i];
    paths_[i].lay(situation, i, 1 + std::clamp(wait, 2, kLongestWait));
    if (held.due == scan_) take_due(held, table);
    if (const auto place = place_of(situation, i, paths_[i], prices_)) place_track(held, *place, table);
    if (!held.cells.empty()) cells_[i] = &held.cells[held.current];
  }
}

/// All of a cell's sets, or none where one is late: the track asks again.
void Index::take_due(Held& held, ValueTable& table) {
  held.due = 0;
  Cell cell{held.asked, corner_weights(held.asked), {}, scan_};
  for (int corner = 0; corner < kCorners; ++corner) {
    SharedBucket& set = cell.sets[static_cast<std::size_t>(corner)];
    set = table.due(corner_of(cell.place.cell, corner));
    if (!set) return;
  }
  if (held.cells.size() < kCells) {
    held.cells.reserve(kCells);
    held.current = held.cells.size();
    held.cells.emplace_back();
  } else {
    const auto oldest = std::min_element(held.cells.begin(), held.cells.end(),
                                         [](const Cell& a, const Cell& b) { return a.used < b.used; });
    held.current = static_cast<std::size_t>(oldest - held.cells.begin());
  }
  held.cells[held.current] = std::move(cell);
}

/// Into the cell of the place where its sets are held; else they are asked for.
void Index::place_track(Held& held, const BucketPlace& place, ValueTable& table) {
  const auto cell = std::find_if(held.cells.begin(), held.cells.end(),
                                 [&](const Cell& known) { return known.place.cell == place.cell; });
  if (cell != held.cells.end()) {
    cell->place = place;
    cell->weights = corner_weights(place);
    cell->used = scan_;
    held.current = static_cast<std::size_t>(cell - held.cells.begin());
    return;
  }
  if (held.due != 0 || price_ == 0.0) return;
  held.asked = place;
  held.due = scan_ + kDelay;
  for (int corner = 0; corner < kCorners; ++corner) table.ask(corner_of(place.cell, corner));
}

/// The prices, and the relaxation's value at them: of sets interpolated and tracks that stay where they are.
void Index::find_price(const Situation& situation) {
  double roots = 0.0;
  double rates_at_price = 0.0;
  double costs = 0.0;
  for (const Cell* cell : cells_) {
    for (std::size_t corner = 0; cell != nullptr && corner < kCorners; ++corner) {
      const PricedBucket& set = *cell->sets[corner];
      const BucketPlace& place = cell->place;
      const double rate = cell->weights[corner] * set.rate / place.p_detect;
      roots += rate * std::pow(place.unit_cost * place.p_detect * set.price, kRateExponent);
      rates_at_price += rate * correction_[place.leading];
      costs += cell->weights[corner] * place.unit_cost * set.cost;
    }
  }
  if (roots > 0.0) price_ = std::pow(roots / situation.looks, 1.0 / kRateExponent);
  set_prices(situation);
  reference_ = costs + price_ * rates_at_price - mean_price() * situation.looks;
}

void Index::set_prices(const Situation& situation) {
  correction_.resize(situation.sensors.size(), 1.0);
  prices_.clear();
  for (const double correction : correction_) prices_.push_back(correction * price_);
}

double Index::mean_price() const {
  return std::accumulate(prices_.begin(), prices_.end(), 0.0) / static_cast<double>(prices_.size());
}

/// By the advantage of the last look that will be made: of each sensor where all look in every scan, else of any.
void Index::correct_prices(const Situation& situation, std::span<const Candidate> candidates) {
  if (!(price_ > 0.0)) return;
  const auto up = std::count_if(situation.states.begin(), situation.states.end(), [](auto& state) { return state.up; });
  const bool all_look = situation.looks > 1 && situation.looks >= up;
  for (std::size_t s = 0; s < correction_.size(); ++s) {
    ranked_.clear();
    for (const Candidate& candidate : candidates) {
      if (!all_look || candidate.pair.sensor == s) ranked_.push_back(candidate.score);
    }
    const auto looks = all_look ? std::size_t{1} : static_cast<std::size_t>(situation.looks);
    if (ranked_.size() < looks) continue;
    const auto last = ranked_.begin() + static_cast<std::ptrdiff_t>(looks - 1);
    std::nth_element(ranked_.begin(), last, ranked_.end(), std::greater<>());
    correction_[s] *= 1.0 + kCorrectionStep * std::clamp(*last / prices_[s], -1.0, 1.0);
    correction_[s] = std::clamp(correction_[s], 1.0 / kMostCorrection, kMostCorrection);
  }
}

bool Index::all_have_sets(std::span<const Candidate> candidates) const {
  return std::all_of(candidates.begin(), candidates.end(),
                     [&](const Candidate& candidate) { return cells_[candidate.pair.track] != nullptr; });
}

double Index::cost(std::size_t track, const StateMatrix& p) const {
  return situation_->tracks[track].weight * (p(kX, kX) + p(kY, kY));
}

double Index::value(std::size_t track, const StateMatrix& p) const {
  const Cell& cell = *cells_[track];
  const BucketPlace& place = cell.place;
  const StateMatrix turned = place.to_units * p;
  const StateMatrix in_units = turned * place.to_units.transpose();
  restless::Packed packed(restless::packed_size(kStateSize));
  Eigen::Index at = 0;
  for (Eigen::Index column = 0; column < kStateSize; ++column) {
    for (Eigen::Index row = column; row < kStateSize; ++row) packed[at++] = in_units(row, column);
  }
  double sum = 0.0;
  for (std::size_t corner = 0; corner < kCorners; ++corner) {
    if (cell.weights[corner] > 0.0) sum += cell.weights[corner] * cell.sets[corner]->value.value(packed);
  }
  return place.unit_cost * sum;
}

void Index::score_advantages(const Situation& situation, std::span<Candidate> candidates) {
  std::size_t started = situation.tracks.size();
  double value_idle = 0.0;
  for (Candidate& candidate : candidates) {
    const std::size_t i = candidate.pair.track;
    const StateMatrix& now = situation.tracks[i].combined.covariance;
    if (i != started) value_idle = value(started = i, paths_[i].predict(0, now));
    StateMatrix seen;
    const double p = paths_[i].look(0, candidate.pair.sensor, now, seen);
    ScoreParts parts;
    parts.gain_now = p * (cost(i, now) - cost(i, seen));
    if (p > 0.0) parts.value_later = p * (value_idle - value(i, paths_[i].predict(0, seen)));
    parts.price = prices_[candidate.pair.sensor] + situation.usage_cost[candidate.pair.sensor];
    candidate.parts = parts;
    candidate.score = parts.gain_now + parts.value_later - parts.price;
    if (!std::isfinite(candidate.score)) candidate.score = -parts.price;  // numbers that fail: a look of no use
  }
}

/// The best advantage of a look at a track in the next scan.
double Index::best_gain(std::size_t track, TrackPath& path, const StateMatrix& predicted) const {
  const double value_idle = value(track, path.predict(1, predicted));
  double best = kNone;
  for (std::size_t s = 0; s < situation_->sensors.size(); ++s) {
    if (!path.possible(1, s)) continue;
    StateMatrix seen;
    const double p = path.look(1, s, predicted, seen);
    const double later = p > 0.0 ? p * (value_idle - value(track, path.predict(1, seen))) : 0.0;
    const double gain =
        p * (cost(track, predicted) - cost(track, seen)) + later - prices_[s] - situation_->usage_cost[s];
    if (std::isfinite(gain)) best = std::max(best, gain);
  }
  return best;
}

/// Of a look now, the next scan's looks going where they gain most: `best_of_others` is the gain that this track must
/// beat for one of them.
double Index::gain_of_two(const Candidate& candidate, double next_if_idle, double best_of_others) {
  const std::size_t i = candidate.pair.track;
  TrackPath& path = paths_[i];
  const StateMatrix& now = situation_->tracks[i].combined.covariance;
  StateMatrix after;
  const double p = path.look(0, candidate.pair.sensor, now, after);
  const StateMatrix idle = path.predict(0, now);
  const StateMatrix seen = path.predict(0, after);
  const auto without_look = [&](const StateMatrix& predicted) {
    return cost(i, predicted) + value(i, path.predict(1, predicted));
  };
  const auto next = [&](double gain) {
    const double best = std::max(gain, best_of_others);
    return best == kNone ? 0.0 : best;
  };
  const double next_idle = next(next_if_idle);
  const double next_seen = p > 0.0 ? next(best_gain(i, path, seen)) : next_idle;
  const double later = p > 0.0 ? p * (without_look(idle) - without_look(seen) + next_seen - next_idle) : 0.0;
  return candidate.parts->gain_now + later - candidate.parts->price;
}

void Index::look_ahead(const Situation& situation, std::span<Candidate> candidates) {
  finalists_.clear();
  for (std::size_t c = 0; c < candidates.size(); ++c) finalists_.push_back(c);
  const std::size_t count = std::min(kFinalists, finalists_.size());
  std::partial_sort(finalists_.begin(), finalists_.begin() + static_cast<std::ptrdiff_t>(count), finalists_.end(),
                    [&](std::size_t a, std::size_t b) {
                      const double score_a = candidates[a].score;
                      const double score_b = candidates[b].score;
                      return score_a > score_b || (score_a == score_b && a < b);
                    });
  finalists_.resize(count);
  next_gain_.clear();
  for (const std::size_t c : finalists_) {
    const std::size_t i = candidates[c].pair.track;
    next_gain_.push_back(best_gain(i, paths_[i], paths_[i].predict(0, situation.tracks[i].combined.covariance)));
  }
  double lowered = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < count; ++f) {
    const std::size_t c = finalists_[f];
    const std::size_t i = candidates[c].pair.track;
    ranked_.clear();
    for (std::size_t other = 0; other < count; ++other) {
      const std::size_t track = candidates[finalists_[other]].pair.track;
      const auto same = [&](std::size_t earlier) { return candidates[earlier].pair.track == track; };
      const auto end = finalists_.begin() + static_cast<std::ptrdiff_t>(other);
      if (track != i && std::none_of(finalists_.begin(), end, same)) ranked_.push_back(next_gain_[other]);
    }
    const auto looks = static_cast<std::size_t>(situation.looks);
    std::sort(ranked_.begin(), ranked_.end(), std::greater<>());
    const double best_of_others = ranked_.size() >= looks ? ranked_[looks - 1] : kNone;
    Candidate& candidate = candidates[c];
    const double two = gain_of_two(candidate, next_gain_[f], best_of_others);
    if (!std::isfinite(two)) continue;
    lowered = std::min(lowered, two - candidate.score);
    candidate.parts->value_later += two - candidate.score;
    candidate.score = two;
  }
  if (!std::isfinite(lowered)) return;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (std::find(finalists_.begin(), finalists_.end(), c) != finalists_.end()) continue;
    candidates[c].parts->value_later += lowered;
    candidates[c].score += lowered;
  }
}

}  // namespace dwell
