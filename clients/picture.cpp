#include "clients/picture.hpp"

#include <algorithm>

#include "clients/format.hpp"

namespace dwell::client {
namespace {

constexpr std::int64_t kLostShownNs = 15'000'000'000;  // long enough to be read at one scan a second

}  // namespace

void Picture::load(const v1::Snapshot& snapshot) {
  *this = Picture();
  names_ = Names(snapshot);
  mode_names_.assign(snapshot.mode_name().begin(), snapshot.mode_name().end());
  if (snapshot.has_last_scan()) last_scan_ = snapshot.last_scan();
  status_ = snapshot.status();
  time_ns_ = snapshot.time_ns();
  for (const v1::RadarState& radar : snapshot.radar()) radar_up_[radar.number()] = radar.up();
  for (const v1::Track& track : snapshot.track()) tracks_[track.id()] = {track, time_ns_};
}

void Picture::apply(const v1::Envelope& envelope) {
  time_ns_ = envelope.time_ns();
  switch (envelope.body_case()) {
    case v1::Envelope::kTrack: {
      const v1::Track& track = envelope.track();
      tracks_[track.id()] = {track, time_ns_};
      names_.set_track(track.id(), track.name());
      break;
    }
    case v1::Envelope::kScanReport:
      last_scan_ = envelope.scan_report();
      status_.set_scan(last_scan_->scan());
      forget_lost();
      break;
    case v1::Envelope::kStatus:
      status_ = envelope.status();
      break;
    case v1::Envelope::kPolicyChange:
      status_.set_policy(policy_text(envelope.policy_change().to()));
      break;
    case v1::Envelope::kRadarChange:
      apply(envelope.radar_change());
      break;
    default:  // plots are not shown; the end is the loop's affair
      break;
  }
}

void Picture::apply(const v1::RadarChange& change) {
  radar_up_[change.radar()] = change.up();
  names_.set_radar(change.radar(), change.name());
}

void Picture::forget_lost() {
  std::erase_if(tracks_, [&](const auto& item) {
    return item.second.track.status() == v1::Track::LOST && time_ns_ - item.second.time_ns > kLostShownNs;
  });
}

v1::Status Picture::status() const {
  v1::Status status = status_;
  const auto count = [&](v1::Track::State wanted) {
    return static_cast<std::uint32_t>(std::count_if(
        tracks_.begin(), tracks_.end(), [&](const auto& item) { return item.second.track.status() == wanted; }));
  };
  status.set_tracks_confirmed(count(v1::Track::CONFIRMED));
  status.set_tracks_coasting(count(v1::Track::COASTING));
  if (!radar_up_.empty()) {  // known from a snapshot
    status.set_radars(static_cast<std::uint32_t>(radar_up_.size()));
    status.set_radars_up(static_cast<std::uint32_t>(
        std::count_if(radar_up_.begin(), radar_up_.end(), [](const auto& item) { return item.second; })));
  }
  return status;
}

}  // namespace dwell::client
