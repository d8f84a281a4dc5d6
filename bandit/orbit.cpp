#include "bandit/orbit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dwell {
namespace {

/// Least difference of discounted looks that is divided by: near 0 both orbits are in phase and the ratio is noise.
constexpr double kLeastWork = 0.05;

}  // namespace

void OrbitIndex::start(const Situation& situation, std::size_t track) {
  situation_ = &situation;
  weight_ = situation.tracks[track].weight;
  now_ = situation.tracks[track].combined.covariance;
  path_.lay(situation, track, settings_.steps);
  level_ = cost(now_);
  idle_ = follow(now_, {level_, 0.0});
}

double OrbitIndex::gain_now(std::size_t sensor) { return level_ - cost(expected(0, sensor, now_)); }

double OrbitIndex::index(std::size_t sensor) {
  const StateMatrix after = expected(0, sensor, now_);
  const Orbit look = follow(after, {cost(after) + situation_->usage_cost[sensor], 1.0});
  const double index = (idle_.cost - look.cost) / std::max(kLeastWork, look.looks - idle_.looks);
  return std::isfinite(index) ? index : 0.0;  // numbers that fail: a look of no use
}

StateMatrix OrbitIndex::expected(int scan, std::size_t sensor, const StateMatrix& predicted) {
  StateMatrix seen;
  const double p = path_.look(scan, sensor, predicted, seen);
  return p * seen + (1.0 - p) * predicted;
}

/// Of the sensor that leaves the least, its use counted; none where no look is worth its use.
StateMatrix OrbitIndex::best_look(int scan, const StateMatrix& predicted, double& usage) {
  StateMatrix best = predicted;
  double least = cost(predicted);
  usage = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t s = 0; s < situation_->sensors.size(); ++s) {
    if (!path_.possible(scan, s)) continue;
    const StateMatrix after = expected(scan, s, predicted);
    const double with = cost(after) + situation_->usage_cost[s];
    if (!(with < least)) continue;
    least = with;
    best = after;
    usage = situation_->usage_cost[s];
  }
  return best;
}

OrbitIndex::Orbit OrbitIndex::follow(StateMatrix after, Orbit sum) {
  double power = 1.0;
  for (int t = 1; t < settings_.steps; ++t) {
    power *= settings_.discount;
    after = path_.predict(t - 1, after);
    if (cost(after) >= level_) {
      double usage = 0.0;
      after = best_look(t, after, usage);
      if (!std::isnan(usage)) {
        sum.cost += power * usage;
        sum.looks += power;
      }
    }
    sum.cost += power * cost(after);
  }
  return sum;
}

void score_by_orbit(OrbitIndex& orbit, const Situation& situation, std::span<Candidate> candidates) {
  std::size_t started = situation.tracks.size();
  for (Candidate& candidate : candidates) {
    if (candidate.pair.track != started) orbit.start(situation, started = candidate.pair.track);
    const double gain = orbit.gain_now(candidate.pair.sensor);
    candidate.score = orbit.index(candidate.pair.sensor);
    candidate.parts = {gain, candidate.score - gain, 0.0};
  }
}

void OrbitPolicy::score(const Situation& situation, std::span<Candidate> candidates) {
  score_by_orbit(orbit_, situation, candidates);
}

}  // namespace dwell
