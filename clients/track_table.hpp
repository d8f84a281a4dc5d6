#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "clients/names.hpp"
#include "clients/table.hpp"
#include "dwell/v1/stream.pb.h"

namespace dwell::client {

/// What people read of a track's state. Absent where the message does not hold the values it is computed
/// from.
struct TrackFigures {
  std::optional<double> east_km;
  std::optional<double> north_km;
  std::optional<double> speed_mps;
  std::optional<double> heading_deg;    // of the velocity, from north, clockwise, [0, 360)
  std::optional<double> sigma_m;        // semi-major axis of the 1-sigma ellipse of the position
  std::optional<double> age_of_look_s;  // stream time since the last look at it
};

/// `time_ns`: the stream time that the age of the last look is counted to.
TrackFigures figures(const v1::Track& track, std::int64_t time_ns);

/// "confirmed"
std::string status_word(v1::Track::State status);

/// ".90 .05 .05"; "-" where there are none.
std::string mode_text(const v1::Track& track);

/// The class that the track is of most probably and its probability: "threat .93"; "-" without classes.
std::string class_text(const v1::Track& track, const Names& names);

/// The table that `watch` and `snapshot` share: one row a track. With classes there are two more columns.
class TrackTable {
 public:
  TrackTable(int columns, const Names& names);  // of the page
  void add(const v1::Track& track, const Names& names, std::int64_t time_ns, bool looked_at);
  Lines lines(const Page& page) const { return table_.lines(page, "tracks"); }

 private:
  int longest_name_;  // one long name must not push the figures off the page
  bool classes_;
  Table table_;
};

/// `watch` into a pipe: the names of the columns, and one line of the same columns with the time in front.
std::string track_line_header(const Names& names);
std::string track_line(const v1::Track& track, const Names& names, std::int64_t time_ns);

}  // namespace dwell::client
