#pragma once

#include <deque>
#include <functional>
#include <string>
#include <unordered_map>

#include "daemon/calibration_loop.hpp"
#include "daemon/config/config_reader.hpp"
#include "daemon/engine.hpp"
#include "daemon/journal.hpp"
#include "daemon/stream.hpp"

namespace dwell {

/// A run as its users see it: the engine, what it publishes, and the commands that change it. No sockets, no clock:
/// the same config, the same requests between the same scans and the same calls publish the same bytes.
class Run {
 public:
  /// `journal` may be null. All outlive the run.
  Run(const DaemonConfig& config, Sink& sink, std::uint64_t epoch, JournalWriter* journal);

  /// One scan and its messages: tracks, plots, the report.
  void scan();
  /// Answers a request. Commands take effect at the next scan; a command whose id was seen before is not applied
  /// again and gets the same answer.
  v1::Reply handle(const v1::Request& request);
  /// Applies a request of a journal. False where it is refused.
  bool replay(const v1::Request& request);

  void publish_status(const v1::WallClock* wall_clock);
  void publish_end(const std::string& reason);

  const Engine& engine() const { return engine_; }
  std::uint64_t scans() const { return engine_.last().scan; }
  bool paused() const { return paused_; }
  /// Scans that a step asked for and that are still to run.
  std::uint64_t steps() const { return steps_; }
  bool stop_requested() const { return !stop_reason_.empty(); }
  const std::string& stop_reason() const { return stop_reason_; }
  std::uint64_t requests_refused() const { return requests_refused_; }
  /// From now on requests that would change the run are refused: it repeats a journal, in which this was late.
  void set_replaying(LateResults late = {}) {
    replaying_ = true;
    late_ = std::move(late);
  }
  /// A scan does not wait for a solve; by default it does.
  void set_real_time() { calibration_.set_waits(false); }
  /// What `handle` asks for the wall-clock part of a status; by default there is none.
  void set_wall_clock(std::function<v1::WallClock()> wall_clock) { wall_clock_ = std::move(wall_clock); }

 private:
  struct Answer {
    std::string request;  // serialised
    v1::Reply reply;
  };

  v1::Reply answer(const v1::Request& request);
  v1::Reply command(const v1::Request& request);
  void set_policy(const v1::Request& request, v1::Reply& reply);
  void set_radar(const v1::Request& request, v1::Reply& reply);
  void calibrate(const v1::Request& request, v1::Reply& reply);
  void take_calibration();
  void publish_calibration();
  void pause(const v1::Request& request, v1::Reply& reply);
  void step(const v1::Step& step, v1::Reply& reply);
  bool record(const v1::Request& request, v1::Reply& reply);
  void remember(const v1::Request& request, const v1::Reply& reply);
  void query(const v1::Request& request, v1::Accepted& accepted) const;

  int sensors() const { return static_cast<int>(engine_.sensors().size()); }
  bool has_classes() const { return engine_.config().tracker.classes.size() > 0; }
  void expect_late_values();
  void record_late_values();

  void fill_status(v1::Status& status) const;
  void fill_policies(v1::PolicyList& list) const;
  void fill_radars(v1::RadarList& list) const;
  void fill_snapshot(v1::Snapshot& snapshot) const;

  Engine engine_;
  CalibrationLoop calibration_;
  Stream stream_;
  JournalWriter* journal_;
  v1::Policy policy_;
  std::string policy_text_;
  bool paused_ = false;
  bool ending_ = false;
  bool replaying_ = false;
  LateResults late_;  // of the journal that is repeated
  std::uint64_t steps_ = 0;
  std::string stop_reason_;
  std::uint64_t requests_refused_ = 0;
  std::function<v1::WallClock()> wall_clock_;
  std::unordered_map<std::string, Answer> answers_;  // by request id
  std::deque<std::string> answered_ids_;             // oldest first
  std::size_t remembered_bytes_ = 0;
};

}  // namespace dwell
