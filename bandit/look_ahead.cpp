#include "bandit/look_ahead.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "radar/assert.hpp"
#include "tracker/footprint.hpp"

namespace dwell {
namespace {

constexpr int kNodes = 5;  // as sa_imm's default
constexpr double kNone = -std::numeric_limits<double>::infinity();
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
// A mode of less is no outcome of its own: its part of the expectation goes to the others.
constexpr double kLeastMode = 1e-6;

}  // namespace

LookAhead::LookAhead(const LookAheadSettings& settings)
    : depth_(settings.depth), expected_cost_({position_weight(), 0.0}, kNodes) {
  DWELL_ASSERT(depth_ >= 1 && depth_ <= kMostDepth);
}

void LookAhead::score(const Situation& situation, std::span<Candidate> candidates) {
  situation_ = &situation;
  used_ = 0;
  outcomes_.clear();
  plan_.assign(situation.sensors.size(), 0);
  const std::size_t tracks = situation.tracks.size();
  idle_.assign(static_cast<std::size_t>(depth_) * tracks, kNobody);
  for (std::size_t track = 0; track < tracks; ++track) {
    if (!situation.tracks[track].alive()) continue;
    const Place now = make(track, 0);
    beliefs_[now].estimate = situation.tracks[track].estimate;
    idle_[track] = now;
    for (int scan = 1; scan < depth_; ++scan) {
      idle_[static_cast<std::size_t>(scan) * tracks + track] = idle(idle_of(track, scan - 1));
    }
  }
  for (const Pair& pair : situation.feasible) beliefs_[idle_[pair.track]].gain[pair.sensor] = kUnknown;
  rank_idle_tracks();
  Joint now;
  now.plan = &plan_;
  for (Candidate& candidate : candidates) {
    const double value = value_of_pair(now, candidate.pair.track, candidate.pair.sensor, depth_);
    candidate.score = std::isfinite(value) ? value : 0.0;  // numbers that fail: a look of no use
  }
}

LookAhead::Place LookAhead::make(std::size_t track, int scan) {
  if (used_ == beliefs_.size()) beliefs_.emplace_back();
  const auto place = static_cast<Place>(used_++);
  Belief& belief = beliefs_[place];
  belief.track = track;
  belief.scan = scan;
  belief.without = kUnknown;
  belief.idle = kNobody;
  // Of now the feasible pairs are given; later they follow from the prediction.
  belief.gain.assign(situation_->sensors.size(), scan == 0 ? kNone : kUnknown);
  belief.outcomes.assign(situation_->sensors.size(), 0);
  belief.outcome_count.assign(situation_->sensors.size(), 0);
  return place;
}

LookAhead::Place LookAhead::idle(Place from) {
  if (beliefs_[from].idle == kNobody) {
    const Place made = make(beliefs_[from].track, beliefs_[from].scan + 1);
    if (predict(*situation_->bank, beliefs_[from].estimate, beliefs_[made].estimate) != Numerics::kOk) {
      beliefs_[made].estimate = beliefs_[from].estimate;  // its numbers fail: the tracker will lose it
    }
    beliefs_[from].idle = made;
  }
  return beliefs_[from].idle;
}

LookAhead::Place LookAhead::idle_of(std::size_t track, int scan) {
  return idle_[static_cast<std::size_t>(scan) * situation_->tracks.size() + track];
}

/// Of `scans` scans from the belief's own on, without a look.
double LookAhead::idle_cost(Place place, int scans) {
  double cost = 0.0;
  for (; scans > 0; --scans) {
    Belief& belief = beliefs_[place];
    if (std::isnan(belief.without)) {
      belief.without = situation_->tracks[belief.track].weight * expected_cost_.without_look(belief.estimate);
    }
    cost += belief.without;
    if (scans > 1) place = idle(place);
  }
  return cost;
}

bool LookAhead::covered(Place place, std::size_t sensor) const {
  return situation_->states[sensor].up && situation_->sensors[sensor]->covers(combined_mean(beliefs_[place].estimate));
}

/// Weighted, of the one look, its use taken off; -inf where it cannot be made.
double LookAhead::gain(Place place, std::size_t sensor) {
  if (!std::isnan(beliefs_[place].gain[sensor])) return beliefs_[place].gain[sensor];
  double gain = kNone;
  if (beliefs_[place].scan == 0 || covered(place, sensor)) {
    const double weight = situation_->tracks[beliefs_[place].track].weight;
    const double without = idle_cost(place, 1);
    double with = without / weight;
    // On a numerical error `with` stays: a look of no use.
    (void)expected_cost_.with_look(beliefs_[place].estimate, *situation_->sensors[sensor], situation_->update, with);
    gain = without - weight * with - situation_->usage_cost[sensor];
  }
  return beliefs_[place].gain[sensor] = gain;
}

std::span<const LookAhead::Outcome> LookAhead::outcomes(Place place, std::size_t sensor) {
  if (beliefs_[place].outcome_count[sensor] == 0) add_outcomes(place, sensor);
  return std::span(outcomes_).subspan(beliefs_[place].outcomes[sensor], beliefs_[place].outcome_count[sensor]);
}

/// Where the belief may be in the scan after a look. They lie together, so all are made before any of them is asked.
void LookAhead::add_outcomes(Place place, std::size_t sensor) {
  const Sensor& seen_by = *situation_->sensors[sensor];
  const std::size_t first = outcomes_.size();
  prior_ = beliefs_[place].estimate;
  const State pointing = combined_mean(prior_);
  double inside = 0.0;
  for (int j = 0; j < prior_.size(); ++j) {
    inside += prior_.probability[j] * footprint_probability(seen_by, prior_.modes[j], pointing);
  }
  double detected = seen_by.detection_probability(pointing) * inside;
  if (predict_measurements(seen_by, situation_->update, prior_, measurements_) != Numerics::kOk) detected = 0.0;
  double sum = 0.0;
  innovations_.resize(measurements_.size());
  for (std::size_t j = 0; j < measurements_.size() && detected > 0.0; ++j) {
    const double c = prior_.probability[static_cast<Eigen::Index>(j)];
    if (c < kLeastMode) continue;
    const Matrix2 root = std::numbers::sqrt2 * Matrix2(measurements_[j].s_root.matrixL());
    for (const Vector2& away :
         {Vector2(root.col(0)), Vector2(-root.col(0)), Vector2(root.col(1)), Vector2(-root.col(1))}) {
      for (std::size_t i = 0; i < measurements_.size(); ++i) {
        innovations_[i] = away + innovation(seen_by, situation_->update, measurements_[j].z, measurements_[i].z);
      }
      scratch_ = prior_;
      if (update(measurements_, innovations_, scratch_) != Numerics::kOk) continue;
      const Place made = make(beliefs_[place].track, beliefs_[place].scan + 1);
      if (predict(*situation_->bank, scratch_, beliefs_[made].estimate) != Numerics::kOk) {
        --used_;
        continue;
      }
      outcomes_.push_back({made, c / 4.0});
      sum += c / 4.0;
    }
  }
  for (std::size_t i = first; i < outcomes_.size(); ++i) outcomes_[i].weight *= detected / sum;
  if (sum == 0.0) detected = 0.0;
  if (detected < 1.0) outcomes_.push_back({idle(place), 1.0 - detected});
  beliefs_[place].outcomes[sensor] = first;
  beliefs_[place].outcome_count[sensor] = outcomes_.size() - first;
}

bool LookAhead::may_look(const Joint& joint, std::size_t sensor) const {
  return joint.scan == 0 || situation_->states[sensor].budget.allows(joint.scan, (*joint.plan)[sensor]);
}

LookAhead::Place LookAhead::belief_of(const Joint& joint, std::size_t track) {
  for (int i = 0; i < joint.count; ++i) {
    if (joint.looked[static_cast<std::size_t>(i)].track == track)
      return joint.looked[static_cast<std::size_t>(i)].belief;
  }
  return idle_of(track, joint.scan);
}

/// What is gained over `scans` scans, against no look at all, by this look now and the best ones after it:
///   idle_cost_h(t) - cost with the look - E idle_cost_{h-1}(t') + E best_value_{h-1}.
double LookAhead::value_of_pair(const Joint& joint, std::size_t track, std::size_t sensor, int scans) {
  const Place belief = belief_of(joint, track);
  double value = gain(belief, sensor);
  if (scans == 1 || value == kNone) return value;
  value += idle_cost(idle(belief), scans - 1);
  Joint next;
  next.scan = joint.scan + 1;
  next.plan = joint.plan;
  next.looked[0].track = track;
  next.count = 1;
  for (int i = 0; i < joint.count; ++i) {
    const Looked& other = joint.looked[static_cast<std::size_t>(i)];
    if (other.track == track) continue;
    next.looked[static_cast<std::size_t>(next.count++)] = {other.track, idle(other.belief)};
  }
  const LookBudget::Plan before = plan_[sensor];
  plan_[sensor] = static_cast<LookBudget::Plan>(before | (1U << joint.scan));
  const std::size_t count = outcomes(belief, sensor).size();
  for (std::size_t i = 0; i < count; ++i) {
    const Outcome outcome = outcomes(belief, sensor)[i];
    next.looked[0].belief = outcome.belief;
    value += outcome.weight * (best_value(next, scans - 1) - idle_cost(outcome.belief, scans - 1));
  }
  plan_[sensor] = before;
  return value;
}

/// Of the best pair; 0 where no sensor can look.
double LookAhead::best_value(const Joint& joint, int scans) {
  if (scans == 1) return best_alone(joint);
  double best = kNone;
  for (std::size_t track = 0; track < situation_->tracks.size(); ++track) {
    if (!situation_->tracks[track].alive()) continue;
    for (std::size_t sensor = 0; sensor < situation_->sensors.size(); ++sensor) {
      if (may_look(joint, sensor)) best = std::max(best, value_of_pair(joint, track, sensor, scans));
    }
  }
  return best == kNone ? 0.0 : best;
}

double LookAhead::best_alone(const Joint& joint) {
  double best = kNone;
  for (std::size_t sensor = 0; sensor < situation_->sensors.size(); ++sensor) {
    if (!may_look(joint, sensor)) continue;
    for (int i = 0; i < joint.count; ++i) {
      best = std::max(best, gain(joint.looked[static_cast<std::size_t>(i)].belief, sensor));
    }
    const std::size_t place = static_cast<std::size_t>(joint.scan) * situation_->sensors.size() + sensor;
    for (const Looked& idle : best_idle_[place]) {
      if (idle.belief == kNobody) break;
      const bool looked = std::any_of(joint.looked.begin(), joint.looked.begin() + joint.count,
                                      [&](const Looked& other) { return other.track == idle.track; });
      if (looked) continue;
      best = std::max(best, gain(idle.belief, sensor));
      break;
    }
  }
  return best == kNone ? 0.0 : best;
}

void LookAhead::rank_idle_tracks() {
  const std::size_t sensors = situation_->sensors.size();
  best_idle_.assign(static_cast<std::size_t>(depth_) * sensors, {});
  const auto last = static_cast<std::size_t>(depth_ - 1);  // the only scan whose looks are taken alone
  for (std::size_t sensor = 0; sensor < sensors; ++sensor) {
    auto& ranks = best_idle_[last * sensors + sensor];
    for (std::size_t track = 0; track < situation_->tracks.size(); ++track) {
      Looked here{track, idle_[last * situation_->tracks.size() + track]};
      if (here.belief == kNobody) continue;
      for (Looked& rank : ranks) {
        if (rank.belief == kNobody || gain(here.belief, sensor) > gain(rank.belief, sensor)) std::swap(rank, here);
        if (here.belief == kNobody) break;
      }
    }
  }
}

}  // namespace dwell
