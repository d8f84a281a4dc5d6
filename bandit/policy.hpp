#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "bandit/look_budget.hpp"
#include "radar/random.hpp"
#include "radar/sensor.hpp"
#include "tracker/class_belief.hpp"
#include "tracker/measurement.hpp"
#include "tracker/track.hpp"

namespace dwell {

/// One thing that can be done: a look of one sensor at one track, by their places in the situation.
struct Pair {
  std::size_t sensor = 0;
  std::size_t track = 0;
};

/// What is to be looked at first, whatever the scores say: candidates of that sensor, of that track, or of both.
struct Owed {
  std::optional<std::size_t> sensor;
  std::optional<std::size_t> track;

  bool matches(const Pair& pair) const {
    return (!sensor || *sensor == pair.sensor) && (!track || *track == pair.track);
  }
};
class ValueTable;

/// What a policy may know when it decides: every track is predicted to the time of the scan.
struct Situation {
  TimePoint time;
  int looks = 1;                           ///< at most so many pairs are chosen
  UpdateForm update = UpdateForm::kEkf;    ///< how a plot will meet the state
  const DiscreteBank* bank = nullptr;      ///< how the tracks move from scan to scan; never null
  RandomStream random;                     ///< of this scan's decision: what a policy draws comes from a copy
  std::span<const Sensor* const> sensors;  ///< as they are believed to be
  std::span<const SensorState> states;     ///< of each sensor: up, and its budget
  std::span<const double> usage_cost;      ///< gamma of each sensor, in units of the policy's cost
  std::span<const Track> tracks;
  std::span<const Pair> feasible;   ///< sensor up and within its budget, track alive and covered; tracks in order, then
                                    ///< sensors
  std::span<const Owed> owed = {};  ///< each gets a look, in this order, where one is left
  double scan_period_s = 1.0;
  const TargetClasses* classes = nullptr;  ///< what the tracks' targets may be; null: nothing is said of it
  ValueTable* value_table = nullptr;  ///< where priced value sets come from (bandit/value_table.hpp); null: a policy
                                      ///< that needs one has its own
};

/// What a score of an index policy is made of: score = gain_now + value_later - price.
struct ScoreParts {
  double gain_now = 0.0;     ///< weighted, of this scan's cost
  double value_later = 0.0;  ///< what the look saves in later scans
  double price = 0.0;        ///< what a look costs: what it would be worth elsewhere, and gamma of the sensor
};

/// A feasible pair and what the policy thinks of it.
struct Candidate {
  Pair pair;
  double score = 0.0;                       ///< a gain: larger is better, for every policy; finite
  std::optional<double> cost_without_look;  ///< weighted; only of policies that compute a cost
  std::optional<double> expected_cost;      ///< weighted, after the look; likewise
  std::optional<ScoreParts> parts;          ///< only of index policies
  std::optional<double> weight;             ///< of the track, where that depends on what it is believed to be
};

/// The relaxation that an index policy decides by: so many looks a scan on average, at a price.
struct Relaxed {
  double price = 0.0;      ///< of a look, in units of the cost
  double reference = 0.0;  ///< cost a scan of the best priced policies known, less what the looks cost: no bound
};

/// The choice of one scan and its reason.
struct Decision {
  std::vector<Candidate> candidates;  ///< all feasible pairs, in the situation's order
  std::vector<std::size_t> chosen;    ///< places in `candidates`, best first
  std::optional<double> margin;       ///< score of the first choice minus the best of those not chosen; negative where
                                      ///< the first was owed, or is not the best of a scan of several looks
  bool owed = false;                  ///< the first choice was owed its look: another has a better score
  bool fell_back = false;             ///< the policy could not answer and a cheaper one did
  std::string_view answered_by;       ///< that cheaper policy's name where it is one of the catalogue; else empty
  std::optional<Relaxed> relaxed;     ///< only of `index`, where it answered itself

  const Pair& pair(std::size_t choice) const { return candidates[chosen[choice]].pair; }
};

/// Chooses the next look. Models: one file each in this folder, listed in bandit/catalogue.hpp.
///
/// What is owed a look comes first, with its best score; then the best score, then the best of another sensor and
/// another track, until the looks of the scan are given. Ties go to the candidate that comes first. Where scores are
/// gains in cost, which add up over tracks, the looks of a scan are those of the greatest total
/// (bandit/best_looks.hpp). A look is made even when every score is negative: the link is there to be used.
class Policy {
 public:
  virtual ~Policy() = default;

  virtual std::string_view name() const = 0;
  /// Fills `decision`; no allocation once its vectors have grown.
  virtual void decide(const Situation& situation, Decision& decision);

 private:
  /// Writes the score (and costs) of every candidate; the pairs are there already.
  virtual void score(const Situation& situation, std::span<Candidate> candidates) = 0;
  /// Chooses the looks that are not owed. By default the best one after the other.
  virtual void choose(const Situation& situation, Decision& decision);
  /// Called when the choice is made. What takes turns goes on from the first look alone, and stays where it is when
  /// that one was owed: turns that are taken before their time are not skipped.
  virtual void chose(const Situation& /*situation*/, const Decision& /*decision*/) {}
};

}  // namespace dwell
