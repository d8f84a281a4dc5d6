#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bandit/policy.hpp"
#include "daemon/engine_config.hpp"
#include "radar/calibration/bias_detector.hpp"
#include "radar/calibration/counting.hpp"
#include "radar/calibration/estimator.hpp"
#include "radar/calibration/fault_detector.hpp"
#include "radar/plot.hpp"
#include "tracker/imm.hpp"

namespace dwell {

/// A window to be solved: everything by value, for another thread.
struct CalibrationTask {
  std::uint64_t scan = 0;  ///< that asked
  CalibrationWindow window;
  CalibrationWindow fresh;           ///< its plots since `applied` took hold
  std::vector<Correction> applied;   ///< in use
  std::vector<Correction> previous;  ///< in use before
  std::shared_ptr<const MotionPrior> motion;
  CorrectionPrior prior;
  bool joint = false;  ///< jointly for trajectories and radars, in the place of maximum likelihood of innovations
};

/// What came of it.
struct CalibrationOutcome {
  CalibrationEstimate estimate;
  bool rolled_back = false;  ///< the fresh plots speak against what is in use
  bool joint = false;        ///< as asked
};

/// Solves a task. Pure: no clock but the estimator's time limit, no thread. The prior is the task's.
CalibrationOutcome solve(const CalibrationTask& task, EstimatorSettings settings);

/// What is known of one radar beyond its config.
struct RadarCalibration {
  DetectionCount detection;
  DetectionCount since_change;  ///< of the looks since the detector suspects that P_d has changed
  double held_scale = 1.0;      ///< detection scale that was sure before that: a loss is not judged by what it taught
  ClutterCount clutter;
  FaultDetector detector;
  Fault fault = Fault::kNone;    ///< of the detector, as it has been acted upon
  Correction applied;            ///< what belief holds, once the ramp has ended
  Correction previous;           ///< before that
  std::uint64_t since_scan = 0;  ///< plots of earlier scans are of a radar that has changed
  std::uint64_t last_look = 0;   ///< scan
};

/// Keeps the plots and counts of the engine's radars; makes tasks and applies their outcomes to the beliefs.
/// Linear sensors are passed over: they have no figures to correct.
class Calibrator {
 public:
  Calibrator(const EngineConfig& config, const std::vector<std::unique_ptr<Sensor>>& beliefs);

  bool on() const { return settings_.mode != CalibrationMode::kOff && !radars_.empty(); }
  bool applies() const { return settings_.mode == CalibrationMode::kApply && !radars_.empty(); }

  /// The sensor that exploration owes the first look of a scan: once in 1 / share scans, while applying, the radar
  /// longest unused, if it has waited for so long. Who is in use is owed nothing. Empty where no pair of it is
  /// feasible.
  std::optional<std::size_t> owed(std::uint64_t scan, std::span<const Pair> feasible) const;

  /// One look: the track's belief before it, the plots, which of them may be of other tracks, and the one that was
  /// used; the target's state where it is known. No allocation.
  void add(std::uint64_t scan, const Dwell& dwell, const ImmEstimate& before, std::span<const Plot> plots,
           std::span<const char> others, std::optional<std::size_t> used, const std::optional<State>& truth);
  /// Before a scan: moves the beliefs on to what is to be applied.
  void move_beliefs(std::uint64_t scan);

  CalibrationTask task(std::uint64_t scan, bool joint = false) const;
  void finish(const CalibrationTask& task, CalibrationOutcome outcome, std::uint64_t scan);
  /// No outcome in time: the old values stay.
  void give_up();

  const CalibrationSettings& settings() const { return settings_; }
  /// Empty of a linear sensor.
  const RadarCalibration* radar(std::size_t sensor) const;
  /// Place of a sensor among the radars, as the estimate counts them.
  int radar_index(std::size_t sensor) const { return radar_of_sensor_[sensor]; }
  /// Of the last solve; empty before the first.
  const std::optional<CalibrationOutcome>& last() const { return last_; }
  std::uint64_t last_scan() const { return last_scan_; }

 private:
  CalibrationWindow empty_window() const;
  void watch_detection(int index, const Dwell& dwell, bool detected);
  void watch_plot(int index, const Dwell& dwell, const ImmEstimate& before, const Plot& plot, bool used,
                  std::uint64_t scan);
  bool is_disturbed(int index, std::uint32_t track);
  void keep(std::uint64_t scan, const Dwell& dwell, const Plot& plot, const std::optional<State>& truth);
  void change_fault(RadarCalibration& radar, std::uint64_t scan);
  void distrust();

  CalibrationSettings settings_;
  std::vector<int> radar_of_sensor_;
  std::vector<CorrectedRadar*> beliefs_;  // of the radars
  std::vector<RadarCalibration> radars_;
  std::vector<CalibrationPlot> plots_;  // a ring
  std::size_t next_ = 0;
  BiasDetector bias_detector_{0, 0};
  std::vector<ExpectedPlot> expected_;
  /// A gross error of a radar, the latest on a track that no other has looked at since.
  struct Disturbance {
    std::uint32_t track;
    int radar;
  };
  std::vector<Disturbance> disturbances_;
  std::uint64_t applied_scan_ = 0;
  std::shared_ptr<const MotionPrior> motion_;
  std::optional<CalibrationOutcome> last_;
  std::uint64_t last_scan_ = 0;
};

}  // namespace dwell
