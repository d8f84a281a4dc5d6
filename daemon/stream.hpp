#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "dwell/v1/stream.pb.h"
#include "radar/time.hpp"

namespace dwell {

/// Where the stream's bytes go: a socket, or a test.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual void send(std::string_view topic, std::string_view envelope) = 0;
};

/// First words of the topics, each with its own topic_sequence.
enum class Topic { kTrack, kScan, kPlot, kStatus, kPolicy, kRadar, kEnd, kCalibration };

/// Numbers the messages and writes the envelopes: the only place that knows a sequence number.
class Stream {
 public:
  Stream(Sink& sink, std::uint64_t epoch) : sink_(sink), epoch_(epoch) {}

  /// The envelope whose body is to be filled for the next message of a topic; reused, and so without allocation.
  v1::Envelope& envelope(Topic topic) { return envelopes_[static_cast<std::size_t>(topic)]; }
  /// Sends it. `id` follows the first word of a track's topic: track.7.
  void publish(Topic topic, TimePoint time, std::uint32_t id = 0);

  std::uint64_t epoch() const { return epoch_; }
  std::uint64_t last_sequence() const { return sequence_; }

 private:
  Sink& sink_;
  std::uint64_t epoch_;
  std::uint64_t sequence_ = 0;
  std::array<std::uint64_t, 8> topic_sequence_{};
  std::array<v1::Envelope, 8> envelopes_;
  std::string topic_;
  std::string bytes_;
};

}  // namespace dwell
