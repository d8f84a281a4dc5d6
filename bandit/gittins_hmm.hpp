#pragma once

#include <map>
#include <vector>

#include "bandit/hmm_bandit/arm.hpp"
#include "bandit/policy.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

/// The track whose class belief has the largest Gittins index: identification alone.
///
/// A track is an arm (bandit/hmm_bandit/arm.hpp) that moves, and shows itself, only when it is looked at:
///   states      its classes, with their transition; belief: the track's
///   symbols     the class that a plot declares, P_d emission(k, d); and no plot, 1 - P_d
///   reward      of a look: the weight of its class
/// The score is its target's own weight times the index. A look at a track that may be important is worth what it may
/// be found to be, not the mean of it. Where a target is, is not asked: the looks that keep its track alive are those
/// of the engine's max_wait_turns.
///
/// Optimal, for the discounted weight of what is looked at, with one look a scan, one sensor of constant P_d and no
/// clutter (Gittins). With several sensors a pair has the index of the arm as if that sensor made all its looks, which
/// is at most that of the best mixture. Without classes the weight is certain, and is the index.
///
/// P_d is rounded to kDetectionStep and beliefs to kBeliefStep: an index is computed once for all that are alike.
/// An index of kPoints points is below that of 1000 by 1e-7, 3e-4 and 2e-3 of it with two, three and four classes.
/// Cost     a map's look-up; of a new belief its index, 20 to 60 ms, which allocates: one for each sensor a look.
/// Source   Krishnamurthy, Evans (2001), IEEE T-SP 49(12); Gittins (1989).
class GittinsHmm final : public Policy {
 public:
  static constexpr double kDetectionStep = 0.02;
  static constexpr double kBeliefStep = 1e-7;
  static constexpr int kPoints = 100;

  explicit GittinsHmm(const GittinsHmmSettings& settings) : settings_(settings) {}

  std::string_view name() const override { return "gittins_hmm"; }

  /// The arm of looks by one sensor at a track.
  static hmm_bandit::Arm arm(const TargetClasses& classes, const Sensor& sensor, const Track& track);

 private:
  void score(const Situation& situation, std::span<Candidate> candidates) override;
  double index(const hmm_bandit::Arm& arm);

  GittinsHmmSettings settings_;
  std::map<std::vector<double>, double> known_;  // index by all that the arm is
};

}  // namespace dwell
