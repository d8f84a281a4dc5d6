#pragma once

#include "bandit/averaged_paths.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

/// Pairs at random, with probabilities of their own. Several looks of a scan are drawn one after the other among what
/// is left, in proportion.
///
///   score = log q + g,  g standard Gumbel: of scores made so, pair i is the largest with probability q_i
///
/// Uniform: q = 1 / pairs. Optimised: descent of AveragedPaths' bound in q, multiplicatively, q_i <- q_i exp(-step g_i)
/// / sum, g the gradient, from the q of the scan before: each step no higher, to 1e-3 of the bound or kIterations. A
/// hundredth of the probability is kept even, so that no pair is ever given up and a new one is found.
///
/// The numbers are those of the situation's stream, forked by track and sensor: a pair that comes or goes does not
/// change what the others draw.
///
/// Source   Gupta et al. (2004), algorithm 3; Kivinen, Warmuth (1997), Information and Computation 132, for the
///          descent; Yellott (1977), J. Mathematical Psychology 15, for the scores.
class RandomChoice final : public Policy {
 public:
  explicit RandomChoice(const RandomSettings& settings) : settings_(settings) {}

  std::string_view name() const override { return "random"; }

  /// Of the last decision, beside its candidates.
  std::span<const double> probabilities() const { return q_; }

 private:
  static constexpr int kIterations = 20;

  void score(const Situation& situation, std::span<Candidate> candidates) override;
  void recall(const Situation& situation);
  void optimise(const Situation& situation);
  bool descend(std::span<const Pair> pairs);

  struct Share {
    TrackId track;
    std::size_t sensor;
    double q;
  };

  RandomSettings settings_;
  PredictedPaths paths_;
  AveragedPaths averaged_;
  std::vector<double> q_;
  std::vector<double> gradient_;
  std::vector<double> tried_;
  std::vector<double> tried_gradient_;
  double bound_ = 0.0;
  double step_ = 0.0;
  std::vector<Share> last_;  // the shares of the scan before
};

}  // namespace dwell
