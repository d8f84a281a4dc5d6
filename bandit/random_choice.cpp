#include "bandit/random_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dwell {
namespace {

constexpr double kEven = 0.01;
constexpr double kEnough = 1e-3;
constexpr double kShorter = 0.25;
constexpr int kShortenings = 10;

double gumbel(RandomStream stream) {
  constexpr double kHalfUlp = 0x1p-54;  // of a uniform number: never 0
  return -std::log(-std::log(stream.uniform() + kHalfUlp));
}

void normalise(std::vector<double>& q) {
  double sum = 0.0;
  for (const double share : q) sum += share;
  for (double& share : q) share = (1.0 - kEven) * share / sum + kEven / static_cast<double>(q.size());
}

}  // namespace

void RandomChoice::score(const Situation& situation, std::span<Candidate> candidates) {
  q_.assign(candidates.size(), 1.0 / static_cast<double>(candidates.size()));
  if (settings_.q == RandomSettings::Probabilities::kOptimised) optimise(situation);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Pair& pair = candidates[i].pair;
    const RandomStream own = situation.random.fork(situation.tracks[pair.track].id.number).fork(pair.sensor);
    candidates[i].score = std::log(q_[i]) + gumbel(own);  // q is never under a hundredth of the even share
  }
}

/// The shares of the scan before; a pair that was not there gets the mean of the others.
void RandomChoice::recall(const Situation& situation) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < q_.size(); ++i) {
    const Pair& pair = situation.feasible[i];
    for (std::size_t tries = 0; tries < last_.size(); ++tries, at = (at + 1) % last_.size()) {
      if (last_[at].track != situation.tracks[pair.track].id || last_[at].sensor != pair.sensor) continue;
      q_[i] = last_[at].q;
      break;
    }
  }
  normalise(q_);
}

void RandomChoice::optimise(const Situation& situation) {
  recall(situation);
  paths_.lay(situation, settings_.horizon);
  gradient_.resize(q_.size());
  tried_.resize(q_.size());
  tried_gradient_.resize(q_.size());
  bound_ = averaged_.bound(paths_, situation.feasible, q_, gradient_);
  step_ = 0.0;
  for (int i = 0; i < kIterations && descend(situation.feasible); ++i) continue;
  last_.clear();
  for (std::size_t i = 0; i < q_.size(); ++i) {
    const Pair& pair = situation.feasible[i];
    last_.push_back({situation.tracks[pair.track].id, pair.sensor, q_[i]});
  }
}

/// One step; false where it brings no more than kEnough of the bound.
bool RandomChoice::descend(std::span<const Pair> pairs) {
  const double least = *std::min_element(gradient_.begin(), gradient_.end());
  const double largest = *std::max_element(gradient_.begin(), gradient_.end());
  if (!(largest > least) || !std::isfinite(largest - least)) return false;
  if (step_ == 0.0) step_ = 1.0 / (largest - least);
  for (int shorter = 0; shorter < kShortenings; ++shorter, step_ *= kShorter) {
    for (std::size_t i = 0; i < q_.size(); ++i) tried_[i] = q_[i] * std::exp(-step_ * (gradient_[i] - least));
    normalise(tried_);
    const double tried = averaged_.bound(paths_, pairs, tried_, tried_gradient_);
    if (!(tried < bound_)) continue;
    const bool more = tried < bound_ * (1.0 - kEnough);
    bound_ = tried;
    std::swap(q_, tried_);
    std::swap(gradient_, tried_gradient_);
    step_ *= 2.0;
    return more;
  }
  return false;
}

}  // namespace dwell
