#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <optional>

#include "daemon/engine.hpp"

namespace dwell {

/// Solves beside the scans: asks at defined scans, and at defined scans later has the engine take the outcome.
///
/// A solve runs on a thread of its own. Where the run waits (fast runs, studies, replays) the scan at which it is due
/// waits for it, without a time limit: the same seed gives the same stream. Where it does not (real time), an outcome
/// that is not there when it is due is given up, the old values stay, and the scan is not delayed.
class CalibrationLoop {
 public:
  using Solve = std::function<CalibrationOutcome(const CalibrationTask& task, EstimatorSettings settings)>;

  /// The engine outlives the loop. `solver` is called on the loop's thread.
  explicit CalibrationLoop(Engine& engine, Solve solver = solve) : engine_(engine), solve_(std::move(solver)) {}
  ~CalibrationLoop();
  CalibrationLoop(const CalibrationLoop&) = delete;
  CalibrationLoop& operator=(const CalibrationLoop&) = delete;

  void set_waits(bool waits) { waits_ = waits; }

  enum class Event { kNone, kFinished, kGivenUp };
  /// Before a scan: takes the outcome that is due. `late`: give it up even if it is there (a replay of a run in which
  /// it was not).
  Event before_scan(bool late = false);
  /// After a scan: begins a solve where one is due, every period; in the first also after a quarter and a half.
  void after_scan();
  /// Begins a solve now. Requires a calibrator that is on, and no solve that is due.
  void ask(bool joint);
  /// The scan at which what was asked takes effect; empty where nothing is.
  std::optional<std::uint64_t> due() const;

 private:
  bool ready() const;

  Engine& engine_;
  Solve solve_;
  bool waits_ = true;
  CalibrationTask task_;
  std::atomic<bool> stop_ = false;
  std::future<CalibrationOutcome> running_;
  std::optional<std::uint64_t> asked_scan_;
};

}  // namespace dwell
