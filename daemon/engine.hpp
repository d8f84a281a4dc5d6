#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bandit/policy.hpp"
#include "daemon/calibrator.hpp"
#include "daemon/engine_config.hpp"
#include "radar/look.hpp"
#include "tracker/tracker.hpp"

namespace dwell {

/// One look of a scan and what came of it. Its plots are `plots[first_plot, first_plot + plots)` of the report.
struct LookReport {
  Dwell dwell;
  std::size_t first_plot = 0;
  std::size_t plots = 0;
  std::optional<std::size_t> used_plot;  ///< index into the report's plots
};

/// Simulation only: a living track and where its target truly is.
struct TruthReport {
  TrackId track;
  std::size_t target = 0;  ///< index into the config's targets
  State state;
  double altitude_m = 0.0;
  std::optional<int> mode;
  TargetId life;                    ///< of the target: a repeated recording has one more each time
  std::optional<int> target_class;  ///< from 0; empty without classes
};

/// What happened in one scan. Valid until the next.
struct ScanReport {
  std::uint64_t scan = 0;  ///< from 1
  TimePoint time;
  std::string policy;  ///< that decided it
  Decision decision;
  std::vector<LookReport> looks;
  std::vector<Plot> plots;
  std::vector<TruthReport> truth;
};

/// Totals since the start.
struct EngineCounts {
  std::uint64_t tracks_lost = 0;          ///< while their target lived
  std::uint64_t tracks_dropped = 0;       ///< after their target had ended, and those that never had one
  std::uint64_t filter_failures = 0;      ///< a track's numbers failed: it began anew, or was lost
  std::uint64_t tracks_initiated = 0;     ///< confirmed from surveillance looks
  std::uint64_t tracks_false = 0;         ///< of these, those that were of no target
  std::vector<std::uint64_t> looks;       ///< of each sensor
  std::vector<std::uint64_t> detections;  ///< of each sensor: looks whose track got a plot
};

/// The simulated world, the tracks and the policy: one scan at a time, without I/O and without a clock. The same
/// config and the same calls between the same scans give the same reports, bit for bit.
class Engine {
 public:
  explicit Engine(const EngineConfig& config);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// The next scan. No allocation once the vectors have grown, but where a track starts.
  const ScanReport& scan();
  const ScanReport& last() const { return report_; }

  /// Take effect at the next scan.
  void set_policy(const PolicySettings& settings);
  void set_policy(std::unique_ptr<Policy> policy) { policy_ = std::move(policy); }
  void set_sensor(std::size_t sensor, bool up) { sensor_states_[sensor].up = up; }

  /// A solve of what the calibrator has; its outcome takes effect at the next scan.
  void finish_calibration(const CalibrationTask& task, CalibrationOutcome outcome) {
    calibrator_.finish(task, std::move(outcome), report_.scan);
  }
  void give_up_calibration() { calibrator_.give_up(); }

  const EngineConfig& config() const { return config_; }
  const Calibrator& calibrator() const { return calibrator_; }
  /// The living tracks, and those lost at the last scan.
  std::span<const Track> tracks() const { return tracks_; }
  /// Simulation only: the targets that are there now.
  std::span<const TargetTruth> living_targets() const { return truth_; }
  /// As they are believed to be.
  std::span<const Sensor* const> sensors() const { return sensor_views_; }
  const SensorState& sensor_state(std::size_t sensor) const { return sensor_states_[sensor]; }
  const EngineCounts& counts() const { return counts_; }
  ValueTable& value_table() { return *config_.value_table; }
  std::string_view policy_name() const { return policy_->name(); }

 private:
  struct Target;
  struct TruthLink;
  struct Surveillance;

  void drop_lost_tracks();
  void advance_truth();
  void predict_tracks();
  void start_tracks();
  void list_feasible_pairs();
  void find_owed();
  void choose();
  void set_faults();
  void execute(const Pair& pair);
  void move_class_of(std::size_t track);
  void compare_with_truth(std::size_t track);
  void survey();
  void hand_over(Track track);
  void mark_others_plots(const Pair& pair, const State& pointing, const LookOutcome& outcome);
  std::optional<State> known_state(std::size_t track) const;
  void count_losses();
  void report_truth();
  void restart(Target& target);
  void begin_life(Target& target, TimePoint start);
  void start_track(std::size_t target);
  struct FirstBelief;
  std::optional<FirstBelief> first_belief(std::size_t target);

  EngineConfig config_;
  RandomStream root_;
  RandomStream policy_stream_;
  Tracker tracker_;
  std::unique_ptr<Policy> policy_;

  std::vector<std::unique_ptr<Sensor>> sensors_;  // as they are
  std::vector<std::unique_ptr<Sensor>> beliefs_;
  std::vector<const Sensor*> sensor_views_;  // of the beliefs
  Calibrator calibrator_;
  ImmEstimate before_look_;
  std::vector<RandomStream> sensor_streams_;
  std::vector<double> usage_cost_;
  std::vector<SensorState> sensor_states_;

  std::vector<Surveillance> surveillance_;  // of the sensors that have it
  std::vector<Track> found_;

  std::vector<Target> targets_;
  std::vector<TargetTruth> truth_;  // of the living targets, in order
  std::vector<Track> tracks_;
  std::vector<TruthLink> links_;  // beside tracks_
  std::vector<Pair> feasible_;
  std::vector<Owed> owed_;
  std::vector<Plot> look_plots_;
  std::vector<char> others_plots_;  // beside look_plots_: in the gate of another track
  std::uint32_t last_track_number_ = 0;
  std::uint32_t last_target_number_ = 0;
  ScanReport report_;
  EngineCounts counts_;
};

}  // namespace dwell
