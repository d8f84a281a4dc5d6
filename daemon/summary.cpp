#include "daemon/summary.hpp"

#include <cmath>

#include <spdlog/fmt/fmt.h>
#include <Eigen/Eigenvalues>

#include "radar/frames.hpp"
#include "tracker/metrics/nees.hpp"

namespace dwell {
namespace {

const char* status_text(TrackStatus status) {
  switch (status) {
    case TrackStatus::kConfirmed:
      return "confirmed";
    case TrackStatus::kCoasting:
      return "coasting";
    case TrackStatus::kLost:
      break;
  }
  return "lost";
}

double heading_deg(const Vector2& v) {
  const double angle = to_polar(Vector2::Zero(), v).azimuth_rad / kDegree;
  return angle < 0.0 ? angle + 360.0 : angle;
}

}  // namespace

void Summary::add(const Engine& engine) {
  const ScanReport& report = engine.last();
  auto truth = report.truth.begin();
  for (std::size_t i = 0; i < engine.tracks().size(); ++i) {
    const Track& track = engine.tracks()[i];
    Row& row = rows_[track.name.empty() ? "track " + std::to_string(track.id.number) : track.name];
    row.status = status_text(track.status);
    row.state = track.combined.mean;
    row.sigma_m =
        std::sqrt(position_block(track.combined.covariance).selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
    if (truth == report.truth.end() || truth->track != track.id) continue;
    ++row.scans;
    row.squared_error_m2 += (position(truth->state) - position(track.combined.mean)).squaredNorm();
    for (const LookReport& look : report.looks) {
      if (look.dwell.track != track.id || !look.used_plot) continue;
      ++row.updates;
      row.nees_at_updates += nees(truth->state, track.combined);
    }
    ++truth;
  }
}

double Summary::position_rms_m() const {
  double sum = 0.0;
  std::uint64_t scans = 0;
  for (const auto& [name, row] : rows_) {
    sum += row.squared_error_m2;
    scans += row.scans;
  }
  return scans == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(scans));
}

std::string Summary::text(const Engine& engine) const {
  std::string text = fmt::format("{} scans of {} s, policy {}, seed {}\n\n", engine.last().scan,
                                 to_seconds(engine.config().scan_period), engine.policy_name(), engine.config().seed);
  text += fmt::format("{:<20} {:<10} {:>9} {:>9} {:>7} {:>7} {:>9} {:>7} {:>11} {:>7}\n", "track", "status", "east km",
                      "north km", "m/s", "deg", "sigma m", "updates", "RMS error m", "NEES/4");
  for (const auto& [name, row] : rows_) {
    const Vector2 v = velocity(row.state);
    text += fmt::format("{:<20} {:<10} {:>9.3f} {:>9.3f} {:>7.1f} {:>7.1f} {:>9.1f} {:>7} {:>11.2f} {:>7.2f}\n", name,
                        row.status, 1e-3 * row.state[kX], 1e-3 * row.state[kY], v.norm(), heading_deg(v), row.sigma_m,
                        row.updates,
                        std::sqrt(row.squared_error_m2 / static_cast<double>(std::max<std::uint64_t>(row.scans, 1))),
                        row.nees_at_updates / 4.0 / static_cast<double>(std::max<std::uint64_t>(row.updates, 1)));
  }
  text += fmt::format("\n{:<20} {:>9} {:>11}\n", "radar", "looks", "with plot");
  for (std::size_t i = 0; i < engine.sensors().size(); ++i) {
    text += fmt::format("{:<20} {:>9} {:>11}\n", engine.config().sensors[i].name, engine.counts().looks[i],
                        engine.counts().detections[i]);
  }
  text += fmt::format("\nposition RMS of all tracks {:.2f} m; tracks lost {}; filter failures {}\n", position_rms_m(),
                      engine.counts().tracks_lost, engine.counts().filter_failures);
  return text;
}

}  // namespace dwell
