#include "clients/track_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace dwell::client {
namespace {

// Places in Track.covariance, the upper triangle of [x vx y vy] row by row.
constexpr int kVarianceX = 0;
constexpr int kCovarianceXY = 2;
constexpr int kVarianceY = 7;
constexpr int kCovarianceSize = 10;

constexpr int kWide = 100;  // columns: from here on there is room for long names

std::string cell(std::optional<double> value, int decimals) { return value ? fixed(*value, decimals) : "-"; }

std::string heading_cell(std::optional<double> heading_deg) {
  if (!heading_deg || !std::isfinite(*heading_deg)) return "-";
  return fmt::format("{:03d}", static_cast<int>(std::lround(*heading_deg)) % 360);
}

// The larger eigenvalue of the position's 2 x 2 covariance; rounding may have left it just below zero.
double semi_major_axis(double xx, double xy, double yy) {
  const double larger = 0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), xy);
  return std::sqrt(std::max(larger, 0.0));
}

std::string radar_cell(const v1::Track& track, const Names& names) {
  return track.has_last_look_radar() ? names.radar(track.last_look_radar()) : "-";
}

// A name as one field of a line: awk and cut go by blanks.
std::string field(const std::string& name) {
  std::string text = name.empty() ? "-" : printable(name);
  std::replace(text.begin(), text.end(), ' ', '_');
  return text;
}

// ".93"
std::string probability_text(double probability) {
  const std::string value = fixed(probability, 2);
  return value.starts_with("0.") ? value.substr(1) : value == "1.00" ? "1.0" : value;
}

struct LikeliestClass {
  std::string name;         // empty without classes
  std::string probability;  // "-" likewise
};

LikeliestClass likeliest_class(const v1::Track& track, const Names& names) {
  const auto& belief = track.class_belief();
  const auto likeliest = std::max_element(belief.begin(), belief.end());
  if (likeliest == belief.end()) return {"", "-"};
  const auto place = static_cast<std::size_t>(likeliest - belief.begin());
  const std::string number = fmt::format("#{}", place + 1);
  return {place < names.classes().size() ? names.classes()[place] : number, probability_text(*likeliest)};
}

std::string weight_cell(const v1::Track& track) { return track.has_weight() ? general(track.weight()) : "-"; }

std::vector<Column> track_columns(bool classes) {
  std::vector<Column> columns{{"id", true, 0},     {"name", false, 2},  {"status", false, 1}, {"E km", true, 0},
                              {"N km", true, 0},   {"m/s", true, 5},    {"hdg", true, 6},     {"sigma m", true, 3},
                              {"modes", false, 3}, {"radar", false, 8}, {"age s", true, 4}};
  if (classes) columns.insert(columns.end(), {{"class", false, 2}, {"weight", true, 7}});
  return columns;
}

Mark mark_of(v1::Track::State status, bool looked_at) {
  if (status == v1::Track::LOST) return Mark::kAlarm;
  if (status == v1::Track::COASTING) return Mark::kWarning;
  return looked_at ? Mark::kBold : Mark::kPlain;
}

}  // namespace

TrackFigures figures(const v1::Track& track, std::int64_t time_ns) {
  TrackFigures result;
  if (track.state_size() >= 4) {
    const double vx = track.state(1);
    const double vy = track.state(3);
    result.east_km = track.state(0) / 1e3;
    result.north_km = track.state(2) / 1e3;
    result.speed_mps = std::hypot(vx, vy);
    if (*result.speed_mps > 0) {  // what stands still heads nowhere
      const double degrees = std::atan2(vx, vy) * 180 / std::numbers::pi;
      result.heading_deg = degrees < 0 ? degrees + 360 : degrees;
    }
  }
  if (track.covariance_size() >= kCovarianceSize) {
    result.sigma_m =
        semi_major_axis(track.covariance(kVarianceX), track.covariance(kCovarianceXY), track.covariance(kVarianceY));
  }
  if (track.has_last_look_time_ns()) {
    result.age_of_look_s = static_cast<double>(time_ns - track.last_look_time_ns()) / 1e9;
  }
  return result;
}

std::string status_word(v1::Track::State status) {
  switch (status) {
    case v1::Track::TENTATIVE:
      return "tentative";
    case v1::Track::CONFIRMED:
      return "confirmed";
    case v1::Track::COASTING:
      return "coasting";
    case v1::Track::LOST:
      return "lost";
    default:
      return "unknown";
  }
}

std::string mode_text(const v1::Track& track) {
  std::string text;
  for (const double probability : track.mode_probability()) {
    text += (text.empty() ? "" : " ") + probability_text(probability);
  }
  return text.empty() ? "-" : text;
}

std::string class_text(const v1::Track& track, const Names& names) {
  const LikeliestClass likeliest = likeliest_class(track, names);
  return likeliest.probability == "-" ? "-" : likeliest.name + " " + likeliest.probability;
}

TrackTable::TrackTable(int columns, const Names& names)
    : longest_name_(columns < kWide ? 12 : 24),
      classes_(!names.classes().empty()),
      table_(track_columns(!names.classes().empty())) {}

void TrackTable::add(const v1::Track& track, const Names& names, std::int64_t time_ns, bool looked_at) {
  const TrackFigures f = figures(track, time_ns);
  std::vector<std::string> cells{fmt::format("{}", track.id()),
                                 clip(printable(track.name()), longest_name_),
                                 status_word(track.status()),
                                 cell(f.east_km, 2),
                                 cell(f.north_km, 2),
                                 cell(f.speed_mps, 0),
                                 heading_cell(f.heading_deg),
                                 cell(f.sigma_m, 0),
                                 mode_text(track),
                                 clip(radar_cell(track, names), longest_name_),
                                 cell(f.age_of_look_s, 1)};
  if (classes_) {
    cells.push_back(clip(class_text(track, names), longest_name_));
    cells.push_back(weight_cell(track));
  }
  table_.add(std::move(cells), mark_of(track.status(), looked_at));
}

std::string track_line_header(const Names& names) {
  return fmt::format("# {:>10} {:>5} {:<24} {:<9} {:>10} {:>10} {:>8} {:>3} {:>9} {:<10} {:>7} {}{}", "time_s", "id",
                     "name", "status", "east_km", "north_km", "speed_ms", "hdg", "sigma_m", "radar", "age_s",
                     names.classes().empty() ? "" : "class p_class weight ", "modes");
}

std::string track_line(const v1::Track& track, const Names& names, std::int64_t time_ns) {
  const TrackFigures f = figures(track, time_ns);
  const LikeliestClass likeliest = likeliest_class(track, names);
  const std::string target_class =
      names.classes().empty() ? ""
                              : field(likeliest.name) + " " + likeliest.probability + " " + weight_cell(track) + " ";
  return fmt::format("{:>12.3f} {:>5} {:<24} {:<9} {:>10} {:>10} {:>8} {:>3} {:>9} {:<10} {:>7} {}{}",
                     static_cast<double>(time_ns) / 1e9, track.id(), field(track.name()), status_word(track.status()),
                     cell(f.east_km, 3), cell(f.north_km, 3), cell(f.speed_mps, 1), heading_cell(f.heading_deg),
                     cell(f.sigma_m, 1), field(radar_cell(track, names)), cell(f.age_of_look_s, 3), target_class,
                     mode_text(track));
}

}  // namespace dwell::client
