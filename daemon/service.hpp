#pragma once

#include <chrono>
#include <optional>
#include <set>
#include <vector>

#include "daemon/run.hpp"
#include "daemon/sockets.hpp"

namespace dwell {

struct ServiceOptions {
  bool fast = false;                       ///< no wall clock: scans as fast as they come, statuses by stream time
  std::optional<std::uint64_t> scans;      ///< end after so many
  int wait_subscribers = 0;                ///< before the first scan
  std::vector<v1::JournalRequest> replay;  ///< to apply before their scans
  LateResults late;                        ///< of the journal
  bool replaying = false;
  std::string end_reason = "all scans done";  ///< after `scans`
};

/// The loop that meets the world: wall clock, sockets and signals around a Run. One thread.
class Service {
 public:
  /// `signals` is a signalfd that becomes readable when the run is to end.
  Service(Run& run, Publisher& publisher, ControlSocket& control, int signals, const ServiceOptions& options);

  /// Until the scans are done, a client stops it or a signal comes. `after_scan` sees every scan.
  void loop(const std::function<void(const Engine&)>& after_scan);

 private:
  using Clock = std::chrono::steady_clock;

  bool ready_to_scan();
  void scan();
  void apply_replay();
  void publish_status();
  void wait();
  void serve();
  std::optional<std::string> reason_to_end();
  v1::WallClock wall_clock() const;

  Run& run_;
  Publisher& publisher_;
  ControlSocket& control_;
  int signals_;
  ServiceOptions options_;
  std::size_t replayed_ = 0;
  bool subscribers_came_;
  bool was_running_ = false;
  const Clock::time_point started_;
  Clock::time_point next_scan_;
  Clock::time_point next_status_;
  TimePoint next_stream_status_{};
  std::uint64_t missed_scans_ = 0;
  std::uint64_t malformed_ = 0;
  std::vector<float> durations_us_;  // of the last scans, a ring
  std::size_t next_duration_ = 0;
};

}  // namespace dwell
