#include "tracker/fixed_lag.hpp"

#include <algorithm>
#include <utility>

#include "radar/assert.hpp"

namespace dwell {
namespace {

bool before(const Plot& one, const Plot& other) {
  return one.z.x() < other.z.x() || (one.z.x() == other.z.x() && one.z.y() < other.z.y());
}

}  // namespace

FixedLag::FixedLag(Tracker& tracker, Track track, TimePoint time, Duration scan_period, Duration lag)
    : tracker_(tracker), scan_period_(scan_period), lag_(lag), track_(std::move(track)) {
  DWELL_ASSERT(scan_period > Duration::zero() && lag >= Duration::zero());
  scans_.push_back({time, track_, {}});
}

void FixedLag::advance() {
  if (track_.alive()) tracker_.predict(track_);
  scans_.push_back({time() + scan_period_, track_, {}});
  while (time() - scans_.front().time > lag_) scans_.pop_front();
}

FixedLag::Arrival FixedLag::look(const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots) {
  if (dwell.time < scans_.front().time) {
    counts_.too_late += plots.size();
    return Arrival::kTooLate;
  }
  const auto at = std::find_if(scans_.begin(), scans_.end(), [&](const Scan& scan) { return scan.time == dwell.time; });
  DWELL_ASSERT(at != scans_.end());
  if (!insert(*at, sensor, dwell, plots)) return Arrival::kDuplicate;
  replay(static_cast<std::size_t>(at - scans_.begin()));
  return Arrival::kUsed;
}

/// Says whether anything was new.
bool FixedLag::insert(Scan& scan, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots) {
  const auto by_radar = [](const Look& look, RadarId radar) { return look.dwell.radar.number < radar.number; };
  auto look = std::lower_bound(scan.looks.begin(), scan.looks.end(), dwell.radar, by_radar);
  bool is_new = look == scan.looks.end() || look->dwell.radar != dwell.radar;
  if (is_new) look = scan.looks.insert(look, {&sensor, dwell, {}});
  for (const Plot& plot : plots) {
    if (!plot.z.allFinite()) continue;  // the tracker passes it over; it has no place in an order
    const auto place = std::lower_bound(look->plots.begin(), look->plots.end(), plot, before);
    if (place != look->plots.end() && place->z == plot.z) {
      ++counts_.duplicates;
    } else {
      look->plots.insert(place, plot);
      is_new = true;
    }
  }
  return is_new;
}

void FixedLag::replay(std::size_t from) {
  track_ = scans_[from].predicted;
  for (std::size_t i = from; i < scans_.size(); ++i) {
    if (i > from) {
      if (track_.alive()) tracker_.predict(track_);
      scans_[i].predicted = track_;
    }
    for (const Look& look : scans_[i].looks) {
      if (track_.alive()) (void)tracker_.look(track_, *look.sensor, look.dwell, look.plots);
    }
  }
}

}  // namespace dwell
