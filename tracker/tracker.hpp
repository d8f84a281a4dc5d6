#pragma once

#include <span>
#include <vector>

#include "radar/plot.hpp"
#include "radar/sensor.hpp"
#include "tracker/measurement.hpp"
#include "tracker/track.hpp"

namespace dwell {

struct TrackerSettings {
  UpdateForm update = UpdateForm::kEkf;
  /// A plot is in the gate when any mode's squared distance is under gate (1 + rejections)^2. Infinite: every plot.
  /// 16: a matched mode rejects 3.4e-4 of its plots (chi-square, 2 degrees of freedom). The widening is what saves
  /// a manoeuvring track: a rejected plot adds no evidence of a manoeuvre.
  double gate = 16.0;
  /// A track is lost when its run of looks without a plot in the gate has this probability or less, prod (1 - P_d).
  /// 1e-8: 8 looks at P_d = .9, one false loss in 1e8 / (looks per second) seconds of a healthy track.
  double lost_probability = 1e-8;
  /// A track is lost when the root of its position variance, x and y, is above this: it says nothing any more, and a
  /// look would not find the target. 20 km: twice the half depth of a footprint. Infinite: never.
  double lost_sigma_m = 20e3;
};

/// What a look came to for its track.
struct LookOutcome {
  std::optional<std::size_t> used_plot;  ///< index into the look's plots
};

/// Moves tracks on and updates them with the plots of their looks.
///
/// Holds scratch space and no belief: the tracks are the caller's. Not for two threads at once.
class Tracker {
 public:
  /// `bank` is over one scan period. At most kMostModes modes.
  Tracker(DiscreteBank bank, Eigen::VectorXd initial_probability, const TrackerSettings& settings);

  static constexpr int kMostModes = 16;

  const TrackerSettings& settings() const { return settings_; }
  int modes() const { return bank_.size(); }
  const DiscreteBank& bank() const { return bank_; }

  /// A confirmed track from a given belief.
  Track start(TrackId id, std::string name, const Gaussian& belief) const;

  /// The belief that one plot gives: its position with the covariance of the converted measurement, and a zero
  /// velocity with the given 1-sigma on each component. Empty where the sensor's measurement is no position.
  static std::optional<Gaussian> belief_from(const Plot& plot, const Sensor& sensor, double speed_sigma_mps);

  /// One scan period on. A track whose numbers fail is lost.
  void predict(Track& track);

  /// Associates the plots of the look made for this track and updates it with the one in the gate of the greatest
  /// predicted density (nearest neighbour, log-determinants included). Plots that are not finite are passed over.
  /// Only this track is touched; one whose numbers fail is lost.
  LookOutcome look(Track& track, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots);

 private:
  bool gated_innovations(const Track& track, const Sensor& sensor, const Plot& plot);
  double log_density(const Track& track) const;
  void miss(Track& track, const Sensor& sensor, bool had_plots) const;

  DiscreteBank bank_;
  Eigen::VectorXd initial_probability_;
  TrackerSettings settings_;
  ImmEstimate scratch_;
  std::vector<PredictedMeasurement> measurements_;
  std::vector<Vector2> innovations_;
  std::vector<Vector2> best_innovations_;
};

}  // namespace dwell
