#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bandit/policy.hpp"
#include "bandit/policy_settings.hpp"
#include "radar/calibration/corrected_radar.hpp"
#include "radar/jump_markov_trajectory.hpp"
#include "radar/range_bearing_radar.hpp"
#include "radar/recording.hpp"
#include "radar/scripted_trajectory.hpp"
#include "tracker/initiation.hpp"
#include "tracker/mode_bank.hpp"
#include "tracker/tracker.hpp"

namespace dwell {

/// z = c x + v, v ~ N(0, r).
struct LinearFigures {
  MeasurementJacobian c = MeasurementJacobian::Zero();
  Matrix2 r = Matrix2::Identity();
  double detection_probability = 1.0;
};

/// Simulation only: what a radar really does beyond its configured figures.
struct RadarTruth {
  Correction correction;
  double detection_scale = 1.0;  ///< on the configured P_d; the product is cut at 1
  double clutter_scale = 1.0;    ///< on the configured density of false plots
};
/// The same for a time: a fault, and then its end. Added to what the radar does anyway.
struct RadarFault {
  TimePoint start;
  TimePoint end = TimePoint::max();
  RadarTruth change;
};

struct SensorConfig {
  std::string name;
  std::variant<RadarFigures, LinearFigures> figures;
  double usage_cost = 0.0;  ///< gamma: cost of one look, in units of the policy's cost
  bool up = true;
  BudgetSettings budget;
  int surveillance_scans = 0;  ///< scans from one surveillance look to the next; 0: none
  RadarTruth truth;
  std::vector<RadarFault> faults;
  std::optional<Declaration> declaration;  ///< of the class of a plot's target
};

enum class CalibrationMode {
  kOff,
  kObserve,  ///< estimate and publish; tracker and policy keep the config's figures
  kApply,    ///< and use what is learned
};
struct CalibrationSettings {
  CalibrationMode mode = CalibrationMode::kObserve;
  int period_scans = 100;  ///< a solve begins so often: noise to 17 % and biases to a third of sigma a radar of three
  int delay_scans = 10;    ///< its outcome takes effect so many scans later; in real time that is its time limit
  int window_plots = 600;  ///< noise scales to .05; at 600 plots a solve takes some tenths of a second
  double exploration =
      0.05;  ///< share of the scans whose first look is owed to a radar that waits for longer than its
             ///< inverse, while applying: one believed bad would never get the looks that show it is not
  CorrectionPrior prior;
};

/// Truth of one target, ready to be started at `start`.
struct ScriptedMotion {
  State initial = State::Zero();
  double altitude_m = 0.0;
  std::vector<Leg> legs;
  StateMatrix process_noise_root = StateMatrix::Zero();
};
struct JumpMarkovMotion {
  State initial = State::Zero();
  double altitude_m = 0.0;
  JumpMarkovSystem system;
  std::vector<std::string> mode_names;
  Eigen::VectorXd initial_probability;  ///< of the modes
  std::optional<Area> area;
};
struct RecordedMotion {
  std::shared_ptr<const FlightPath> path;
  Vector2 offset_m = Vector2::Zero();
  bool repeat = false;
};

/// The track's first mean is drawn around the truth, N(0, covariance).
struct CuedStart {
  /// A 100 m, 100 m/s cue: what a search radar some way off hands over.
  StateMatrix covariance = StateMatrix::Identity() * 1e4;
};
/// The first plot that a covering sensor returns.
struct FirstPlotStart {
  double speed_sigma_mps = 150.0;  ///< airliners: nine tenths of them under 250 m/s in any direction
};

/// None: the target is left to track initiation.
struct NoStart {};

struct TargetConfig {
  std::string name;
  TimePoint start;                   ///< a whole number of scan periods
  std::optional<Duration> duration;  ///< empty: unlimited, or the recording's length
  std::variant<ScriptedMotion, JumpMarkovMotion, RecordedMotion> motion;
  double weight = 1.0;  ///< multiplies its cost in every policy and metric
  std::variant<CuedStart, FirstPlotStart, NoStart> track_start;
  bool calibration_flight = false;  ///< where it is, is known to calibration
  std::optional<int> target_class;  ///< at its start, from 0; empty: drawn from the priors
};

inline constexpr const char* kDefaultBank = "cruise_and_turn";

/// Everything that defines a run.
struct EngineConfig {
  Duration scan_period = std::chrono::seconds(1);
  std::uint64_t seed = 1;
  int looks_per_scan = 1;
  int max_wait_turns = 10;  ///< of looks at all living tracks; a track that waits longer is next; 0: never
  std::vector<SensorConfig> sensors;
  std::vector<TargetConfig> targets;
  ModeBank bank = *named_bank(kDefaultBank);
  TrackerSettings tracker;
  InitiationSettings initiation;
  /// Simulation only: the truth farther than this (squared distance, 2 degrees of freedom) from the prediction at 5
  /// consecutive detected looks loses the track. 9: a matched track is there at 1.1 % of its looks.
  double lost_squared_distance = 9.0;
  PolicySettings policy;
  CalibrationSettings calibration;
  /// Of priced value sets; runs may share one. Null: the engine makes its own.
  std::shared_ptr<ValueTable> value_table;
};

}  // namespace dwell
