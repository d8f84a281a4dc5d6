#pragma once

#include <span>
#include <vector>

#include "radar/plot.hpp"
#include "radar/sensor.hpp"
#include "tracker/association_events.hpp"
#include "tracker/class_belief.hpp"
#include "tracker/existence.hpp"
#include "tracker/measurement.hpp"
#include "tracker/plot_cluster.hpp"
#include "tracker/track.hpp"
#include "tracker/track_splitting.hpp"

namespace dwell {

/// Which plots of a look update its track. Where a sensor has no clutter and no other track shares the plots, all are
/// kNearest: the one target is what can be seen.
enum class Association {
  kNearest,   ///< the plot in the gate of the greatest predicted density
  kPda,       ///< every plot in the gate by its probability; the target is taken to exist
  kIpda,      ///< the same, with the probability that the target exists
  kJpda,      ///< as kIpda, and tracks whose gates share plots are given theirs jointly (JIPDA)
  kJpdaStar,  ///< as kJpda, of pruned joint events (JPDA*)
  kIts,       ///< as kIpda, and what the plots of the last looks may have been is kept apart (track splitting)
};

struct TrackerSettings {
  UpdateForm update = UpdateForm::kEkf;
  Association association = Association::kNearest;
  /// A plot is in the gate when any mode's squared distance is under gate (1 + rejections)^2. Infinite: every plot.
  /// 16: a matched mode rejects 3.4e-4 of its plots (chi-square, 2 degrees of freedom). The widening is what saves
  /// a manoeuvring track: a rejected plot adds no evidence of a manoeuvre. Where all plots of a gate count by their
  /// probabilities it does not widen: what is far outside every mode is far likelier to be false.
  double gate = 16.0;
  /// A track is lost when its run of looks without a plot in the gate has this probability or less, prod (1 - P_d).
  /// 1e-8: 8 looks at P_d = .9, one false loss in 1e8 / (looks per second) seconds of a healthy track. Not of tracks
  /// with a probability of existence, which decides.
  double lost_probability = 1e-8;
  /// A track whose run of looks without a plot in the gate has this probability or less is begun anew from the last two
  /// plots that were outside it, where these agree with the speed of one of its modes: it has jumped, or done what no
  /// mode does. 1e-4: 4 looks at P_d = .9, half of the way to being lost. Of sensors without clutter: there every plot
  /// is some target's.
  double reacquire_probability = 1e-4;
  /// A track is lost when the root of its position variance, x and y, is above this: it says nothing any more, and a
  /// look would not find the target. 20 km: twice the half depth of a footprint. Infinite: never.
  double lost_sigma_m = 20e3;
  ExistenceSettings existence{};
  /// Instead of the IMM; with kNearest, kEkf and a bank without guards and trailing states.
  std::optional<ParticleSettings> particles{};
  /// What targets may be; of size 0 where nothing is said of it.
  TargetClasses classes{};

  bool is_joint() const { return association == Association::kJpda || association == Association::kJpdaStar; }
  bool has_existence() const {
    return association == Association::kIpda || association == Association::kIts || is_joint();
  }
};

/// What a look came to for its track.
struct LookOutcome {
  /// Index into the look's plots: the one that the track was updated with, or the likeliest of all events where every
  /// plot of the gate counts.
  std::optional<std::size_t> used_plot;
};

/// Moves tracks on and updates them with the plots of their looks.
///
/// A track whose numbers fail (an S that is not positive definite, no mode with a likelihood, overflow) begins anew
/// from its last combined estimate, in every mode; where that is no Gaussian, or before the next plot, it is lost.
/// Holds scratch space and no belief: the tracks are the caller's. Not for two threads at once.
class Tracker {
 public:
  /// `bank` is over one scan period. At most kMostModes modes. Particles are drawn from `particles`, forked by the
  /// number of their track.
  Tracker(DiscreteBank bank, Eigen::VectorXd initial_probability, const TrackerSettings& settings,
          const RandomStream& particles = RandomStream(0));

  static constexpr int kMostModes = 16;

  const TrackerSettings& settings() const { return settings_; }
  int modes() const { return bank_.size(); }
  const DiscreteBank& bank() const { return bank_; }
  /// How often a track's numbers have failed.
  std::uint64_t failures() const { return failures_; }
  /// Plots that looks have passed over, since a number of theirs was not finite.
  std::uint64_t refused_plots() const { return refused_plots_; }

  /// Room for looks of so many plots: they then allocate nothing.
  void reserve(std::size_t plots);

  /// A confirmed track from a given belief, of any class by the prior.
  Track start(TrackId id, std::string name, const Gaussian& belief) const;
  /// How important its target is beside its class.
  void set_target_weight(Track& track, double weight) const;
  /// A plot that is the target's for certain, of which the kinematic belief knows already: what it was begun by.
  void declare(Track& track, const Sensor& sensor, const Plot& plot);

  /// The belief that one plot gives: its position with the covariance of the converted measurement, and a zero
  /// velocity with the given 1-sigma on each component. Empty where the sensor's measurement is no position.
  static std::optional<Gaussian> belief_from(const Plot& plot, const Sensor& sensor, double speed_sigma_mps);

  /// One scan period on.
  void predict(Track& track);

  /// Associates the plots of the look made for this track and updates it. `others` are the tracks that may have plots
  /// in it too: predicted to the time of the look, the track itself may be among them. Plots that
  /// are not finite are passed over and counted. Only this track is touched.
  ///
  /// Its class moves first, then each plot counts by its probability, of which what it declares is a part:
  ///   pi+_k = sum_i beta_i P(k | d_i) + beta_0 pi_k,  beta_i the probability that plot i is the target's
  /// exact where class and state are independent before the look (the moments of tracker/association_events.hpp); with
  /// kNearest the plot chosen counts as certain.
  /// Source   Bar-Shalom, Kirubarajan, Gokberk (2005), IEEE T-AES 41(3): classification-aided association.
  LookOutcome look(Track& track, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots,
                   std::span<const Track> others = {});

  /// The same for the part of a surveillance look that lies about a tentative track: nothing is out of the beam, and
  /// the class does not move.
  LookOutcome survey(Track& track, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots);

  /// Sets `marked` of each plot in the track's gate.
  void mark_gated(const Track& track, const Sensor& sensor, std::span<const Plot> plots, std::span<char> marked);

 private:
  void begin(Track& track, const Gaussian& belief) const;
  LookOutcome observe(Track& track, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots,
                      std::span<const Track> others);
  void weigh(Track& track) const;
  void mix_classes(Track& track, const Sensor& sensor, std::span<const Plot> plots);
  void fail(Track& track);
  Numerics advance(Track& track);
  Numerics take(const Sensor& sensor, const Plot& plot, Track& track);
  bool look_at_all(Track& track, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots,
                   std::span<const Track> others, LookOutcome& outcome);
  void split(Track& track, const Sensor& sensor, const State& pointing, std::span<const Plot> plots,
             LookOutcome& outcome);
  void conclude(Track& track, LookOutcome& outcome, double detection, double likelihood_ratio);
  LookOutcome look_at_nearest(Track& track, const Sensor& sensor, std::span<const Plot> plots,
                              std::span<const Track> others);
  void reacquire(Track& track, const Sensor& sensor, std::span<const Plot> plots, std::span<const Track> others);
  void count_miss(Track& track, double detection) const;
  void judge_existence(Track& track, double likelihood_ratio) const;
  bool gated_innovations(const Track& track, const Sensor& sensor, const Plot& plot);
  double log_density(const Track& track) const;
  void miss(Track& track, const Sensor& sensor, bool had_plots);
  Numerics weigh_modes(std::span<const double> factor, Track& track) const;

  DiscreteBank bank_;
  Eigen::VectorXd initial_probability_;
  TrackerSettings settings_;
  RandomStream particle_stream_;
  std::uint64_t failures_ = 0;
  std::uint64_t refused_plots_ = 0;
  ImmEstimate scratch_;
  std::vector<PredictedMeasurement> measurements_;
  std::vector<Vector2> innovations_;
  std::vector<Vector2> best_innovations_;
  AssociationEvents events_;
  PlotCluster cluster_;
  TrackSplitting splitting_;
  std::vector<TrackComponent> components_;
  std::vector<double> factor_;
  Eigen::VectorXd class_mixture_;
};

}  // namespace dwell
