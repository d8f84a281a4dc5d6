#include "daemon/stream.hpp"

namespace dwell {
namespace {

constexpr std::array<std::string_view, 8> kWords{"track.",  "scan.",  "plot.", "status.",
                                                 "policy.", "radar.", "end.",  "calibration."};

}  // namespace

void Stream::publish(Topic topic, TimePoint time, std::uint32_t id) {
  const auto index = static_cast<std::size_t>(topic);
  topic_ = kWords[index];
  if (topic == Topic::kTrack) topic_ += std::to_string(id) + ".";
  v1::Envelope& envelope = envelopes_[index];
  envelope.set_epoch(epoch_);
  envelope.set_sequence(++sequence_);
  envelope.set_topic_sequence(++topic_sequence_[index]);
  envelope.set_time_ns(time.time_since_epoch().count());
  bytes_.clear();
  envelope.AppendToString(&bytes_);
  sink_.send(topic_, bytes_);
}

}  // namespace dwell
