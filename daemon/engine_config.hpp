#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bandit/catalogue.hpp"
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

struct SensorConfig {
  std::string name;
  std::variant<RadarFigures, LinearFigures> figures;
  double usage_cost = 0.0;  ///< gamma: cost of one look, in units of the policy's cost
  bool up = true;
  BudgetSettings budget;
  int surveillance_scans = 0;  ///< scans from one surveillance look to the next; 0: none
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
  /// Of priced value sets; runs may share one. Null: the engine makes its own.
  std::shared_ptr<ValueTable> value_table;
};

}  // namespace dwell
