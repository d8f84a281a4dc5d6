#pragma once

#include <optional>
#include <string>
#include <vector>

#include "radar/ids.hpp"
#include "radar/time.hpp"
#include "tracker/particle/particle_filter.hpp"
#include "tracker/track_splitting.hpp"

namespace dwell {

enum class TrackStatus {
  kConfirmed,
  kCoasting,  ///< the last look gave no plot in the gate, or no sensor that is up reaches it
  kLost,      ///< given up; never updated again
};

enum class LossCause {
  kNoPlots,    ///< so many looks without a plot in the gate are not to be believed of a live target, or its
               ///< probability of existence fell below the limit
  kFromTruth,  ///< simulation only: the truth stayed far from the prediction
  kUncertain,  ///< nobody has looked for so long that the position is unknown
  kNumerics,   ///< the filter's numbers failed, and there was no belief to begin anew from
};

/// A plot outside the gate, as a position.
struct Outlier {
  TimePoint time;
  Vector2 place;
  Matrix2 noise;  ///< its covariance
};

/// Belief about one target.
struct Track {
  TrackId id;
  std::string name;
  double target_weight = 1.0;  ///< of its target, whatever that is
  double weight = 1.0;   ///< multiplies its cost in every policy: target_weight times the mean weight of its class
  ImmEstimate estimate;  ///< at the last scan: predicted, and updated where a look gave a plot
  std::optional<ParticleFilter> particles;  ///< what `estimate` is of, where that is no IMM
  std::vector<TrackComponent> components;   ///< what `estimate` is the mixture of, where a look in clutter split it
  Gaussian combined;                        ///< moment-matched estimate
  TrackStatus status = TrackStatus::kConfirmed;
  std::optional<LossCause> loss;
  int age_scans = 0;
  int unseen_scans = 0;  ///< since the last look, or the start
  std::optional<TimePoint> last_look;
  RadarId last_radar;                 ///< meaningful with last_look
  std::optional<double> nis;          ///< of the last plot used, 2 degrees of freedom
  int rejections = 0;                 ///< consecutive looks whose plots were all outside the gate
  std::optional<Outlier> outlier;     ///< of the last of them, the nearest to the track
  double log_miss_probability = 0.0;  ///< of the present run of looks without a plot in the gate
  bool restarted = false;             ///< its numbers failed since the last plot used
  bool tentative = false;             ///< begun by plots and not yet believed: track initiation judges it
  std::optional<double> existence;    ///< probability that the target exists; only where the association computes it
  Eigen::VectorXd class_belief;       ///< probability of each class of target; empty without classes

  bool alive() const { return status != TrackStatus::kLost; }
  void lose(LossCause cause) {
    status = TrackStatus::kLost;
    loss = cause;
  }
};

}  // namespace dwell
