#include "radar/recording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <istream>
#include <optional>
#include <span>
#include <utility>

#include <GeographicLib/LocalCartesian.hpp>

#include "radar/assert.hpp"
#include "radar/violation.hpp"

namespace dwell {
namespace {

constexpr std::string_view kHeader = "time_s,lat,lon,alt_m,id";
constexpr std::size_t kColumns = 5;
constexpr std::size_t kMostViolations = 50;  // enough to see what is wrong with a file of another kind
constexpr int kLeastSamples = 4;
constexpr double kLargestTime_s = 4.6e9;  // to the year 2115; two of them apart still fit in nanoseconds

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    fields.push_back(line.substr(begin, comma - begin));
    if (comma == std::string_view::npos) return fields;
    begin = comma + 1;
  }
}

class RecordingReader {
 public:
  explicit RecordingReader(std::string_view source) : source_(source) {}

  std::vector<RecordedFlight> read(std::istream& input) {
    std::string line;
    while (violations_.size() < kMostViolations && std::getline(input, line)) {
      ++line_;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line_ == 1) {
        if (line != kHeader) refuse("header", line, "must be `" + std::string(kHeader) + "`");
      } else if (!line.empty()) {
        read_row(line);
      }
    }
    if (line_ == 0) refuse("file", "", "is empty or unreadable");
    check_lengths();
    if (!violations_.empty()) throw InvalidInput(std::string(source_), std::move(violations_));
    return std::move(flights_);
  }

 private:
  void read_row(std::string_view line) {
    const std::vector<std::string_view> fields = split(line);
    if (fields.size() != kColumns) {
      refuse("row", line, "must have 5 columns: " + std::string(kHeader));
      return;
    }
    const auto time_s = number("time_s", fields[0], kLargestTime_s);
    const auto latitude = number("lat", fields[1], 90.0);
    const auto longitude = number("lon", fields[2], 180.0);
    const auto altitude = number("alt_m", fields[3], 1e6);
    if (fields[4].empty()) refuse("id", "", "must not be empty");
    if (!time_s || !latitude || !longitude || !altitude || fields[4].empty()) return;
    RecordedFlight& flight = flight_of(fields[4]);
    const Duration time = from_seconds(*time_s);
    if (!flight.samples.empty() && time <= flight.samples.back().unix_time) {
      refuse("time_s", fields[0], "must increase within an id");
      return;
    }
    flight.samples.push_back({time, *latitude, *longitude, *altitude});
  }

  std::optional<double> number(std::string_view name, std::string_view text, double limit) {
    const std::string limit_text = std::to_string(static_cast<long>(limit));
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size() && std::abs(value) <= limit) return value;
    refuse(name, text, "must be a number from -" + limit_text + " to " + limit_text);
    return std::nullopt;
  }

  RecordedFlight& flight_of(std::string_view id) {
    const auto same = [&](const RecordedFlight& flight) { return flight.id == id; };
    const auto found = std::find_if(flights_.rbegin(), flights_.rend(), same);
    if (found != flights_.rend()) return *found;
    first_line_.push_back(line_);
    return flights_.emplace_back(RecordedFlight{std::string(id), {}});
  }

  void check_lengths() {
    if (!violations_.empty()) return;  // refused rows count for nothing
    line_ = 0;
    if (flights_.empty()) refuse("file", "", "has no rows");
    for (std::size_t i = 0; i < flights_.size(); ++i) {
      line_ = first_line_[i];
      if (std::ssize(flights_[i].samples) < kLeastSamples) refuse("id", flights_[i].id, "has fewer than 4 rows");
    }
  }

  void refuse(std::string_view field, std::string_view value, std::string rule) {
    violations_.push_back({std::string(field), std::string(value.substr(0, 80)), std::move(rule), line_, 0});
  }

  std::string_view source_;
  int line_ = 0;
  std::vector<RecordedFlight> flights_;
  std::vector<int> first_line_;  // of each flight
  std::vector<Violation> violations_;
};

/// Second derivatives of the natural cubic spline through (t, y): the tridiagonal system
///   h_{i-1} m_{i-1} + 2 (h_{i-1} + h_i) m_i + h_i m_{i+1} = 6 (d_i - d_{i-1}),  m_0 = m_n = 0,
/// h interval widths, d divided differences. Solved by elimination without pivots (diagonally dominant).
/// Source  de Boor (1978), "A Practical Guide to Splines", IV.
Eigen::Matrix3Xd natural_curvature(const std::vector<Duration>& times, const Eigen::Matrix3Xd& points) {
  const Eigen::Index n = points.cols();
  Eigen::Matrix3Xd m = Eigen::Matrix3Xd::Zero(3, n);
  std::vector<double> upper(static_cast<std::size_t>(n), 0.0);
  const auto width = [&](Eigen::Index i) { return to_seconds(times[i + 1] - times[i]); };
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const double left = width(i - 1);
    const double right = width(i);
    const double pivot = 2.0 * (left + right) - left * upper[i - 1];
    upper[i] = right / pivot;
    const Eigen::Vector3d rise =
        (points.col(i + 1) - points.col(i)) / right - (points.col(i) - points.col(i - 1)) / left;
    m.col(i) = (6.0 * rise - left * m.col(i - 1)) / pivot;
  }
  for (Eigen::Index i = n - 2; i > 0; --i) m.col(i) -= upper[i] * m.col(i + 1);
  return m;
}

/// a + b, or the largest duration where that is larger still. Requires b >= 0.
Duration saturating_sum(Duration a, Duration b) { return a > Duration::max() - b ? Duration::max() : a + b; }

/// The sample range [first, last) of a span.
std::pair<std::size_t, std::size_t> span_of(const RecordedFlight& flight, Duration begin, Duration length) {
  const Duration from = saturating_sum(flight.samples.front().unix_time, begin);
  const Duration to = saturating_sum(from, length);
  const auto before = [](const RecordedFlight::Sample& sample, Duration time) { return sample.unix_time < time; };
  const auto after = [](Duration time, const RecordedFlight::Sample& sample) { return time < sample.unix_time; };
  const auto& samples = flight.samples;
  const auto first = std::lower_bound(samples.begin(), samples.end(), from, before);
  const auto last = std::upper_bound(first, samples.end(), to, after);
  return {first - samples.begin(), last - samples.begin()};
}

/// The middle of the box of latitude and longitude, degrees.
std::array<double, 2> middle(std::span<const RecordedFlight::Sample> samples) {
  double low_lat = 90.0, high_lat = -90.0, low_lon = 0.0, high_lon = 0.0;
  for (const auto& sample : samples) {
    low_lat = std::min(low_lat, sample.latitude_deg);
    high_lat = std::max(high_lat, sample.latitude_deg);
    const double lon = std::remainder(sample.longitude_deg - samples.front().longitude_deg, 360.0);
    low_lon = std::min(low_lon, lon);
    high_lon = std::max(high_lon, lon);
  }
  return {0.5 * (low_lat + high_lat), samples.front().longitude_deg + 0.5 * (low_lon + high_lon)};
}

}  // namespace

std::vector<RecordedFlight> read_recording(std::istream& input, std::string_view source) {
  return RecordingReader(source).read(input);
}

int FlightPath::samples_in(const RecordedFlight& flight, Duration begin, Duration length) {
  const auto [first, last] = span_of(flight, begin, length);
  return static_cast<int>(last - first);
}

FlightPath::FlightPath(const RecordedFlight& flight, Duration begin, Duration length) {
  const auto [first, last] = span_of(flight, begin, length);
  DWELL_ASSERT(last - first >= kLeastSamples);
  const std::span samples(flight.samples.data() + first, last - first);
  const auto [latitude_deg, longitude_deg] = middle(samples);
  const GeographicLib::LocalCartesian plane(latitude_deg, longitude_deg, 0.0);
  points_.resize(3, std::ssize(samples));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& sample = samples[i];
    double east_m = 0.0, north_m = 0.0, up_m = 0.0;
    plane.Forward(sample.latitude_deg, sample.longitude_deg, sample.altitude_m, east_m, north_m, up_m);
    points_.col(static_cast<Eigen::Index>(i)) << east_m, north_m, sample.altitude_m;
    times_.push_back(sample.unix_time - samples.front().unix_time);
  }
  curvature_ = natural_curvature(times_, points_);
}

FlightPath::Interval FlightPath::locate(Duration since_begin) const {
  DWELL_ASSERT(since_begin >= Duration::zero() && since_begin <= length());
  const auto above = std::upper_bound(times_.begin() + 1, times_.end() - 1, since_begin);
  const Eigen::Index right = above - times_.begin();
  const double width_s = to_seconds(times_[right] - times_[right - 1]);
  const double b = to_seconds(since_begin - times_[right - 1]) / width_s;
  return {right - 1, width_s, 1.0 - b, b};
}

State FlightPath::state(Duration since_begin) const {
  const auto [i, h, a, b] = locate(since_begin);
  const auto y0 = points_.col(i), y1 = points_.col(i + 1);
  const auto m0 = curvature_.col(i), m1 = curvature_.col(i + 1);
  const Eigen::Vector3d place = a * y0 + b * y1 + h * h / 6.0 * ((a * a * a - a) * m0 + (b * b * b - b) * m1);
  const Eigen::Vector3d rate = (y1 - y0) / h + h / 6.0 * ((1.0 - 3.0 * a * a) * m0 + (3.0 * b * b - 1.0) * m1);
  return make_state(place.head<2>(), rate.head<2>());
}

double FlightPath::altitude_m(Duration since_begin) const {
  const auto [i, h, a, b] = locate(since_begin);
  return a * points_(2, i) + b * points_(2, i + 1) +
         h * h / 6.0 * ((a * a * a - a) * curvature_(2, i) + (b * b * b - b) * curvature_(2, i + 1));
}

RecordedTrajectory::RecordedTrajectory(std::shared_ptr<const FlightPath> path, TimePoint start, TimePoint end,
                                       Vector2 offset_m)
    : path_(std::move(path)), start_(start), end_(std::min(end, start + path_->length())), offset_m_(offset_m) {}

std::optional<State> RecordedTrajectory::advance(TimePoint time) {
  if (time < start_ || time > end_) return std::nullopt;
  altitude_m_ = path_->altitude_m(time - start_);
  const State x = path_->state(time - start_);
  return make_state(position(x) + offset_m_, velocity(x));
}

}  // namespace dwell
