#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clients/names.hpp"
#include "dwell/v1/control.pb.h"
#include "dwell/v1/stream.pb.h"

namespace dwell::client {

/// What a listener knows: a snapshot, and every message of the stream applied to it. The state behind
/// `watch`.
class Picture {
 public:
  struct Entry {
    v1::Track track;
    std::int64_t time_ns;  // of the message it came with
  };

  void load(const v1::Snapshot& snapshot);
  void apply(const v1::Envelope& envelope);

  /// By id. A lost track stays for a while, so that its loss is seen, and then goes.
  const std::map<std::uint32_t, Entry>& tracks() const { return tracks_; }
  const Names& names() const { return names_; }
  const std::vector<std::string>& mode_names() const { return mode_names_; }
  const std::optional<v1::ScanReport>& last_scan() const { return last_scan_; }
  std::int64_t time_ns() const { return time_ns_; }

  /// The last Status, with what the messages since then have changed.
  v1::Status status() const;

 private:
  void apply(const v1::RadarChange& change);
  void forget_lost();

  std::map<std::uint32_t, Entry> tracks_;
  std::map<std::uint32_t, bool> radar_up_;
  Names names_;
  std::vector<std::string> mode_names_;
  std::optional<v1::ScanReport> last_scan_;
  v1::Status status_;
  std::int64_t time_ns_ = 0;
};

}  // namespace dwell::client
