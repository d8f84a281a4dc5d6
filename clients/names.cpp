#include "clients/names.hpp"

#include <fmt/format.h>

#include "clients/text.hpp"

namespace dwell::client {

Names::Names(const v1::Snapshot& snapshot) {
  for (const v1::RadarState& radar : snapshot.radar()) set_radar(radar.number(), radar.name());
  for (const v1::Track& track : snapshot.track()) set_track(track.id(), track.name());
  for (const std::string& name : snapshot.class_name()) classes_.push_back(printable(name));
}

void Names::set_radar(std::uint32_t number, const std::string& name) { radar_[number] = printable(name); }

void Names::set_track(std::uint32_t id, const std::string& name) {
  if (!name.empty()) track_[id] = printable(name);
}

std::string Names::radar(std::uint32_t number) const {
  const auto found = radar_.find(number);
  return found == radar_.end() || found->second.empty() ? fmt::format("#{}", number) : found->second;
}

std::string Names::track_name(std::uint32_t id) const {
  const auto found = track_.find(id);
  return found == track_.end() ? std::string() : found->second;
}

std::string Names::track(std::uint32_t id) const {
  const std::string name = track_name(id);
  return name.empty() ? fmt::format("{}", id) : fmt::format("{} {}", id, name);
}

}  // namespace dwell::client
