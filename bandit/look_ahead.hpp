#pragma once

#include <array>

#include "bandit/expected_cost.hpp"
#include "bandit/policy.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

/// Closed loop over the IMM: the pair of the least expected cost over `depth` scans, where the later looks are chosen
/// after the earlier ones have been seen. Mode probabilities and means move with what is measured.
///
///   J_h(S) = min over pairs (t, s) of  sum_tau cost_k(tau) + E_y J_{h-1}(S')     S = the tracks' predicted estimates
///
/// cost = weight tr(W P) of the combined estimate after the scan, W position, and gamma of the sensor. The score is the
/// idle cost of all tracks over the horizon less the value with the pair first. Of one scan that is sa_imm's.
///
/// What is exact and what is not:
/// - the expected cost of every look is that of ExpectedCost, to its error, whatever the scan;
/// - the expectation of what *follows* a look is taken over 4 outcomes a mode, z_j +- sqrt(2) times each column of the
///   root of S_j, weight c_j / 4 (the third-degree cubature rule of each mode's predictive density), and over the
///   outcome without a plot, in which nothing is learnt. That is an approximation: the figures measured in
///   tests/bandit/look_ahead_test.cpp stand in bandit/README.md;
/// - a plan makes one look a scan; where a scan has several the others are taken by their scores.
///
/// Cost     beliefs: tracks x (sensors (4 modes + 1))^(depth - 1), each with the expected cost of every sensor; sums:
///          as many to the power of two, without arithmetic to speak of. No allocation once the store has grown.
///
/// Source   Evans et al. (2005), III-C, for the recursion; Arasaratnam, Haykin (2009), IEEE TAC 54, for the rule.
class LookAhead final : public Policy {
 public:
  explicit LookAhead(const LookAheadSettings& settings);

  std::string_view name() const override { return "lookahead"; }

  static constexpr int kMostDepth = 3;

 private:
  using Place = std::uint32_t;  // of a belief in the store
  static constexpr Place kNobody = 0xffffffff;

  struct Outcome {
    Place belief;
    double weight;
  };
  /// What one track may have come to, predicted to its scan, and what is known of it: made once, when asked for.
  struct Belief {
    std::size_t track;
    int scan;
    ImmEstimate estimate;
    double without;                     // weighted cost without a look
    Place idle;                         // the scan after, without a look
    std::vector<double> gain;           // of each sensor's look alone; NaN: not asked yet, -inf: not covered
    std::vector<std::size_t> outcomes;  // of each sensor: where they begin in the store of outcomes
    std::vector<std::size_t> outcome_count;
  };
  /// A track that was looked at: all others are where no look leads.
  struct Looked {
    std::size_t track = 0;
    Place belief = kNobody;
  };
  struct Joint {
    int scan = 0;
    int count = 0;
    std::array<Looked, kMostDepth> looked{};
    std::vector<LookBudget::Plan>* plan = nullptr;  // of each sensor
  };

  void score(const Situation& situation, std::span<Candidate> candidates) override;

  Place make(std::size_t track, int scan);
  Place idle(Place belief);
  Place idle_of(std::size_t track, int scan);
  double idle_cost(Place belief, int scans);
  double gain(Place belief, std::size_t sensor);
  std::span<const Outcome> outcomes(Place belief, std::size_t sensor);
  void add_outcomes(Place belief, std::size_t sensor);
  bool may_look(const Joint& joint, std::size_t sensor) const;
  bool covered(Place belief, std::size_t sensor) const;

  Place belief_of(const Joint& joint, std::size_t track);
  double value_of_pair(const Joint& joint, std::size_t track, std::size_t sensor, int scans);
  double best_value(const Joint& joint, int scans);
  double best_alone(const Joint& joint);
  void rank_idle_tracks();

  int depth_;
  ExpectedCost expected_cost_;
  const Situation* situation_ = nullptr;
  std::size_t used_ = 0;
  std::vector<Belief> beliefs_;
  std::vector<Outcome> outcomes_;
  std::vector<Place> idle_;  // [scan][track]
  /// The tracks of the largest gains of a look in a scan, never looked at before: one more than may be excluded.
  std::vector<std::array<Looked, kMostDepth>> best_idle_;  // [scan][sensor]
  std::vector<LookBudget::Plan> plan_;
  std::vector<PredictedMeasurement> measurements_;
  std::vector<Vector2> innovations_;
  ImmEstimate prior_;
  ImmEstimate scratch_;
};

}  // namespace dwell
