#include "radar/recording.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <GeographicLib/LocalCartesian.hpp>

#include "radar/frames.hpp"
#include "radar/violation.hpp"

namespace dwell {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr char kHeader[] = "time_s,lat,lon,alt_m,id\n";
constexpr Duration kAll = Duration::max();

std::vector<RecordedFlight> read(const std::string& text) {
  std::istringstream input(text);
  return read_recording(input, "flight.csv");
}

/// "line field" of every violation; empty where the text is accepted.
std::vector<std::string> refused(const std::string& text) {
  std::vector<std::string> all;
  try {
    (void)read(text);
  } catch (const InvalidInput& error) {
    for (const Violation& violation : error.violations()) {
      all.push_back(std::to_string(violation.line) + ' ' + violation.field);
    }
  }
  return all;
}

/// Four good rows of `id`, from 100 s on.
std::string rows(const std::string& id) {
  std::string text;
  for (int i = 0; i < 4; ++i) text += std::to_string(100 + i) + ",52.5,4.75,1000," + id + '\n';
  return text;
}

TEST(ReadRecording, ReadsWhatTheRowsSay) {
  const auto flights = read(std::string(kHeader) + "1527693700.25,52.5,-4.75,94.91,a\n" +
                            "1527693701,52.6,-4.74,-12,a\n" + "1527693702,1e1,0,0,a\n" + "1527693703,-90,180,1e3,a\n");
  ASSERT_EQ(flights.size(), 1U);
  EXPECT_EQ(flights[0].id, "a");
  ASSERT_EQ(flights[0].samples.size(), 4U);
  EXPECT_EQ(flights[0].samples[0].unix_time, std::chrono::milliseconds(1527693700250));
  EXPECT_EQ(flights[0].samples[0].latitude_deg, 52.5);
  EXPECT_EQ(flights[0].samples[0].longitude_deg, -4.75);
  EXPECT_EQ(flights[0].samples[0].altitude_m, 94.91);
  EXPECT_EQ(flights[0].samples[1].altitude_m, -12.0);
  EXPECT_EQ(flights[0].samples[3].longitude_deg, 180.0);
}

TEST(ReadRecording, KeepsIdsInOrderOfAppearanceAndMayInterleaveThem) {
  std::string text = kHeader;
  for (int i = 0; i < 5; ++i) {
    for (const char* id : {"zulu", "alpha", "mike"}) text += std::to_string(i) + ",1,2,3," + id + '\n';
  }
  const auto flights = read(text);
  ASSERT_EQ(flights.size(), 3U);
  EXPECT_EQ(flights[0].id, "zulu");
  EXPECT_EQ(flights[1].id, "alpha");
  EXPECT_EQ(flights[2].id, "mike");
  for (const auto& flight : flights) EXPECT_EQ(flight.samples.size(), 5U);
}

TEST(ReadRecording, AcceptsCrLfBlankLinesAndNoLastNewline) {
  std::string text = kHeader + rows("a");
  const auto plain = read(text);
  text.pop_back();
  EXPECT_EQ(read(text)[0].samples.size(), 4U);
  EXPECT_EQ(read(text + "\n\n\n")[0].samples.size(), 4U);
  std::string carriage;
  for (const char c : text) carriage += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const auto flights = read(carriage + "\r\n");
  EXPECT_EQ(flights[0].id, plain[0].id);
  EXPECT_EQ(flights[0].samples.size(), 4U);
}

TEST(ReadRecording, RefusesAnEmptyFile) {
  EXPECT_THAT(refused(""), ElementsAre("0 file"));
  EXPECT_THAT(refused(kHeader), ElementsAre("0 file"));
  std::istringstream broken(kHeader + rows("a"));
  broken.setstate(std::ios::failbit);
  EXPECT_THROW((void)read_recording(broken, "flight.csv"), InvalidInput);
}

TEST(ReadRecording, RefusesAnotherHeader) {
  EXPECT_THAT(refused("time,lat,lon,alt_m,id\n" + rows("a")), ElementsAre("1 header"));
  EXPECT_THAT(refused(rows("a")), ElementsAre("1 header"));
  EXPECT_THAT(refused("\n" + std::string(kHeader) + rows("a")), testing::Contains("1 header"));
}

TEST(ReadRecording, RefusesFewerThanFourRowsOfAnId) {
  EXPECT_THAT(refused(kHeader + rows("a") + "1,2,3,4,short\n1,2,3,4,shorter\n"), ElementsAre("6 id", "7 id"));
}

TEST(ReadRecording, RefusesAnotherNumberOfColumns) {
  EXPECT_THAT(refused(kHeader + rows("a") + "200,52,4,1000\n201,52,4,1000,a,b\n,\n"),
              ElementsAre("6 row", "7 row", "8 row"));
}

class BadNumber : public testing::TestWithParam<const char*> {};

TEST_P(BadNumber, IsRefusedInEveryColumn) {
  const std::string bad = GetParam();
  const std::string good = kHeader + rows("a");
  EXPECT_THAT(refused(good + bad + ",52,4,1000,a\n"), ElementsAre("6 time_s"));
  EXPECT_THAT(refused(good + "200," + bad + ",4,1000,a\n"), ElementsAre("6 lat"));
  EXPECT_THAT(refused(good + "200,52," + bad + ",1000,a\n"), ElementsAre("6 lon"));
  EXPECT_THAT(refused(good + "200,52,4," + bad + ",a\n"), ElementsAre("6 alt_m"));
}

INSTANTIATE_TEST_SUITE_P(All, BadNumber,
                         testing::Values("nan", "NaN", "-nan", "inf", "-inf", "infinity", "1e400", "-1e400", "1e10", "",
                                         " ", "x", "1x", "1 ", " 1", "0x10", "1.5.2", "--1", "\"1\""));

TEST(ReadRecording, HoldsTheLimitsToTheLastDigit) {
  const std::string good = kHeader + rows("a");
  EXPECT_THAT(refused(good + "200,90,180,1000000,a\n201,-90,-180,-1000000,a\n"), ElementsAre());
  EXPECT_THAT(refused(good + "200,90.00000001,4,1,a\n"), ElementsAre("6 lat"));
  EXPECT_THAT(refused(good + "200,-90.00000001,4,1,a\n"), ElementsAre("6 lat"));
  EXPECT_THAT(refused(good + "200,52,180.0000001,1,a\n"), ElementsAre("6 lon"));
  EXPECT_THAT(refused(good + "200,52,-180.0000001,1,a\n"), ElementsAre("6 lon"));
  EXPECT_THAT(refused(good + "200,52,4,1000000.1,a\n"), ElementsAre("6 alt_m"));
}

TEST(ReadRecording, RefusesTimesThatDoNotIncreaseWithinAnId) {
  const std::string good = kHeader + rows("a");
  EXPECT_THAT(refused(good + "103,52,4,1000,a\n"), ElementsAre("6 time_s"));  // the same
  EXPECT_THAT(refused(good + "99,52,4,1000,a\n"), ElementsAre("6 time_s"));   // back
  EXPECT_THAT(refused(good + "103.0000000001,52,4,1000,a\n"),
              ElementsAre("6 time_s"));  // the same nanosecond
  EXPECT_THAT(refused(good + "103.000000001,52,4,1000,a\n"), ElementsAre());
  EXPECT_THAT(refused(good + rows("b")), ElementsAre());  // another id has its own time
}

TEST(ReadRecording, ListsEverythingThatIsWrongAtOnce) {
  const std::string text = std::string("time,lat,lon,alt,id\n") +  // 1
                           "100,52,4,1000,a\n" +                   // 2
                           "101,nan,200,inf,a\n" +                 // 3: three columns
                           "102,52,4,1000\n" +                     // 4
                           "\n" +                                  // 5
                           "100,52,4,1000,a\n" +                   // 6: not after line 2
                           "x,52,4,1000,\n" +                      // 7
                           "104,52,4,1000,a\n";
  EXPECT_THAT(refused(text),
              ElementsAre("1 header", "3 lat", "3 lon", "3 alt_m", "4 row", "6 time_s", "7 time_s", "7 id"));
  try {
    (void)read(text);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_EQ(error.source(), "flight.csv");
    EXPECT_THAT(error.what(), HasSubstr("flight.csv:3: lat = nan: must be a number from -90 to 90\n"));
    EXPECT_THAT(error.what(), HasSubstr("flight.csv:6: time_s = 100: must increase within an id\n"));
  }
}

TEST(ReadRecording, GivesUpOnAFileOfAnotherKindAndQuotesLittleOfIt) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += std::string(200, static_cast<char>('a' + i % 26)) + '\n';
  try {
    (void)read(text);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_EQ(error.violations().size(), 50U);
    for (const Violation& violation : error.violations()) EXPECT_LE(violation.value.size(), 80U);
  }
}

constexpr double kSemiMajor_m = 6378137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);

struct Place {
  double latitude_deg;
  double longitude_deg;
  double altitude_m = 0.0;
};

/// WGS-84 to earth-centred, earth-fixed. Source  Hofmann-Wellenhof et al. (2001), "GPS", (10.1).
Eigen::Vector3d earth_fixed(const Place& place) {
  const double s = std::sin(place.latitude_deg * kDegree), c = std::cos(place.latitude_deg * kDegree);
  const double n = kSemiMajor_m / std::sqrt(1.0 - kEccentricity2 * s * s);
  const double lon = place.longitude_deg * kDegree;
  return {(n + place.altitude_m) * c * std::cos(lon), (n + place.altitude_m) * c * std::sin(lon),
          (n * (1.0 - kEccentricity2) + place.altitude_m) * s};
}

/// East and north of `place` in the plane that touches the ellipsoid at `origin`.
Vector2 plane_of(const Place& origin, const Place& place) {
  const Eigen::Vector3d d = earth_fixed(place) - earth_fixed(origin);
  const double sp = std::sin(origin.latitude_deg * kDegree), cp = std::cos(origin.latitude_deg * kDegree);
  const double sl = std::sin(origin.longitude_deg * kDegree), cl = std::cos(origin.longitude_deg * kDegree);
  return {-sl * d.x() + cl * d.y(), -sp * cl * d.x() - sp * sl * d.y() + cp * d.z()};
}

RecordedFlight flight_of(const std::vector<double>& times_s, const std::vector<Place>& places) {
  RecordedFlight flight{"test", {}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    flight.samples.push_back({from_seconds(1.5e9) + from_seconds(times_s[i]), places[i].latitude_deg,
                              places[i].longitude_deg, places[i].altitude_m});
  }
  return flight;
}

/// A flight along a curve of east, north and up (metres) in the plane at 47 N 8 E.
RecordedFlight flown(const std::vector<double>& times_s, const std::function<Eigen::Vector3d(double)>& curve) {
  const GeographicLib::LocalCartesian plane(47.0, 8.0, 0.0);
  std::vector<Place> places;
  for (const double t : times_s) {
    const Eigen::Vector3d p = curve(t);
    Place place{};
    plane.Reverse(p.x(), p.y(), p.z(), place.latitude_deg, place.longitude_deg, place.altitude_m);
    places.push_back(place);
  }
  return flight_of(times_s, places);
}

/// Times with steps between 0.4 and 2.9 s: nothing below may rely on an even grid.
std::vector<double> uneven_times() { return {0.0, 1.0, 1.4, 4.0, 5.5, 6.0, 8.9, 10.0, 11.0, 13.0, 13.5, 15.0}; }

/// A weaving climb: every derivative is there.
RecordedFlight weaving() {
  return flown(uneven_times(), [](double t) {
    return Eigen::Vector3d(120.0 * t + 300.0 * std::sin(0.4 * t), -60.0 * t + 200.0 * std::cos(0.5 * t),
                           2000.0 + 5.0 * t + 20.0 * std::sin(0.3 * t));
  });
}

Vector2 position_at(const FlightPath& path, double time_s) { return position(path.state(from_seconds(time_s))); }
Vector2 velocity_at(const FlightPath& path, double time_s) { return velocity(path.state(from_seconds(time_s))); }

// Four samples on a meridian, one degree either side of 48 N. The northing of the outer ones in the tangent
// plane is the meridian's arc, each piece seen under the angle it has turned by:
//   north = int_{p0}^{p1} M(p) cos(p - p0) dp,   M(p) = a (1 - e^2) (1 - e^2 sin^2 p)^(-3/2),
// by Simpson's rule with 200 pieces (error 1e-12 m). It is 5.7 m shorter than the arc of 111.2 km: theta^2
// / 6.
TEST(FlightPath, ADegreeNorthIsWhereTheMeridianArcSays) {
  const FlightPath path(flight_of({0, 1, 2, 3}, {{47, 8}, {47.5, 8}, {48.5, 8}, {49, 8}}), Duration{0}, kAll);
  const auto integrate = [](double to_deg, bool seen_from_the_plane) {
    const auto piece = [&](double theta) {
      const double s = std::sin(48.0 * kDegree + theta);
      const double m = kSemiMajor_m * (1.0 - kEccentricity2) / std::pow(1.0 - kEccentricity2 * s * s, 1.5);
      return seen_from_the_plane ? m * std::cos(theta) : m;
    };
    const double h = to_deg * kDegree / 200.0;
    double sum = piece(0.0) + piece(200.0 * h);
    for (int i = 1; i < 200; ++i) sum += piece(i * h) * (i % 2 == 1 ? 4.0 : 2.0);
    return sum * h / 3.0;
  };
  for (const auto& [time_s, degrees] : {std::pair{0.0, -1.0}, {1.0, -0.5}, {2.0, 0.5}, {3.0, 1.0}}) {
    const Vector2 p = position_at(path, time_s);
    EXPECT_NEAR(p.x(), 0.0, 1e-8);
    EXPECT_NEAR(p.y(), integrate(degrees, true), 1e-7);
    const double arc_m = integrate(degrees, false);
    const double theta = degrees * kDegree;
    EXPECT_NEAR(p.y() / arc_m, 1.0 - theta * theta / 6.0, 1e-6);  // e^2 moves the next term by 1e-7
  }
}

// The published length of the arc of one degree, 48 .. 49 N on WGS-84: 111 208 m (any table of degree
// lengths: 48 N 111.20 km), as a guard on the formula above.
TEST(FlightPath, ADegreeOfTheMeridianIsAbout111Kilometres) {
  const FlightPath path(flight_of({0, 1, 2, 3}, {{47, 8}, {47.5, 8}, {48.5, 8}, {49, 8}}), Duration{0}, kAll);
  EXPECT_NEAR(position_at(path, 3.0).y(), 111.2e3, 50.0);
}

// Height h over a point that lies theta north adds h sin(theta) to its northing, theta the angle between the
// verticals.
TEST(FlightPath, AltitudeMovesAPointAlongItsVertical) {
  const FlightPath low(flight_of({0, 1, 2, 3}, {{47, 8}, {47.5, 8}, {48.5, 8}, {49, 8}}), Duration{0}, kAll);
  const FlightPath high(flight_of({0, 1, 2, 3}, {{47, 8, 9e3}, {47.5, 8, 9e3}, {48.5, 8, 9e3}, {49, 8, 9e3}}),
                        Duration{0}, kAll);
  EXPECT_NEAR(position_at(high, 3.0).y() - position_at(low, 3.0).y(), 9e3 * std::sin(1.0 * kDegree), 1e-7);
}

// An independent route through earth-fixed coordinates; the origin is the middle of the box.
TEST(FlightPath, PassesThroughItsSamples) {
  const RecordedFlight flight = weaving();
  const FlightPath path(flight, Duration{0}, kAll);
  double low_lat = 90, high_lat = -90, low_lon = 180, high_lon = -180;
  for (const auto& sample : flight.samples) {
    low_lat = std::min(low_lat, sample.latitude_deg);
    high_lat = std::max(high_lat, sample.latitude_deg);
    low_lon = std::min(low_lon, sample.longitude_deg);
    high_lon = std::max(high_lon, sample.longitude_deg);
  }
  const Place origin{0.5 * (low_lat + high_lat), 0.5 * (low_lon + high_lon)};
  for (const auto& sample : flight.samples) {
    const Duration since = sample.unix_time - flight.samples.front().unix_time;
    const Vector2 expected = plane_of(origin, {sample.latitude_deg, sample.longitude_deg, sample.altitude_m});
    EXPECT_LE((position(path.state(since)) - expected).norm(), 1e-7);  // earth-fixed 6e6 m: 1e-9 m a rounding
    EXPECT_NEAR(path.altitude_m(since), sample.altitude_m, 1e-9);
  }
  EXPECT_EQ(path.length(), from_seconds(15.0));
}

TEST(FlightPath, MiddleOfTheBoxIsTheOrigin) {
  const FlightPath path(flight_of({0, 1, 2, 3}, {{10, 20}, {10, 20.2}, {10.1, 20.1}, {9.9, 20.1}}), Duration{0}, kAll);
  EXPECT_NEAR(position_at(path, 0.0).x(), -position_at(path, 1.0).x(), 1e-7);
  EXPECT_NEAR(position_at(path, 2.0).x(), 0.0, 1e-7);
  EXPECT_NEAR(position_at(path, 3.0).x(), 0.0, 1e-7);
  // North is longer by the change of the meridian radius, 3 a e^2 sin cos theta^2 = 0.07 m.
  EXPECT_NEAR(position_at(path, 2.0).y(), -position_at(path, 3.0).y(), 0.1);
}

// A straight line in one plane is one in any other. Latitudes are rounded to 7e-15 degrees, 1e-9 m.
TEST(FlightPath, ReproducesAStraightLineExactly) {
  const auto line = [](double t) { return Eigen::Vector3d(-2000.0 + 150.0 * t, 800.0 - 90.0 * t, 3000.0); };
  const FlightPath path(flown(uneven_times(), line), Duration{0}, kAll);
  const Vector2 first = position_at(path, 0.0);
  const Vector2 slope = (position_at(path, 15.0) - first) / 15.0;
  EXPECT_NEAR(slope.norm(), std::hypot(150.0, 90.0), 1e-3);
  for (int eighth = 0; eighth <= 120; ++eighth) {
    const double t = eighth / 8.0;
    EXPECT_LE((position_at(path, t) - (first + slope * t)).norm(), 1e-7);
    EXPECT_LE((velocity_at(path, t) - slope).norm(), 1e-7);
  }
}

TEST(FlightPath, ReproducesALinearClimbExactly) {
  std::vector<Place> places;
  for (const double t : uneven_times()) places.push_back({47.0 + 1e-3 * t, 8.0, 500.0 + 12.5 * t});
  const FlightPath path(flight_of(uneven_times(), places), Duration{0}, kAll);
  for (int eighth = 0; eighth <= 120; ++eighth) {
    const double t = eighth / 8.0;
    EXPECT_NEAR(path.altitude_m(from_seconds(t)), 500.0 + 12.5 * t, 1e-9);
  }
}

// Within an interval position is a cubic, so five points give its slope exactly but for rounding, 1e-12 m /
// 0.01 s.
TEST(FlightPath, VelocityIsTheDerivativeOfPosition) {
  const FlightPath path(weaving(), Duration{0}, kAll);
  const auto times = uneven_times();
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    for (const double part : {0.2, 0.5, 0.8}) {
      const double t = times[i] + part * (times[i + 1] - times[i]);
      const double h = 0.01;
      const Vector2 slope = (8.0 * (position_at(path, t + h) - position_at(path, t - h)) -
                             (position_at(path, t + 2 * h) - position_at(path, t - 2 * h))) /
                            (12.0 * h);
      EXPECT_LE((velocity_at(path, t) - slope).norm(), 1e-8);
    }
  }
}

/// Velocity and acceleration at `t` from three velocities on one side of it: exact for a parabola.
struct OneSided {
  Vector2 velocity;
  Vector2 acceleration;
};
OneSided one_sided(const FlightPath& path, double t, double h) {
  const Vector2 v1 = velocity_at(path, t + h), v2 = velocity_at(path, t + 2 * h), v3 = velocity_at(path, t + 3 * h);
  return {3.0 * v1 - 3.0 * v2 + v3, (-2.5 * v1 + 4.0 * v2 - 1.5 * v3) / h};
}

// The three properties (through the samples, twice differentiable, no curvature at the ends) leave one curve
// only: the natural cubic spline.
TEST(FlightPath, IsTwiceDifferentiableAcrossKnots) {
  const FlightPath path(weaving(), Duration{0}, kAll);
  const auto times = uneven_times();
  double largest_jerk_step = 0.0;
  for (std::size_t i = 1; i + 1 < times.size(); ++i) {
    const OneSided left = one_sided(path, times[i], -0.1);
    const OneSided right = one_sided(path, times[i], 0.1);
    EXPECT_LE((left.velocity - right.velocity).norm(), 1e-8) << times[i];
    EXPECT_LE((left.acceleration - right.acceleration).norm(), 1e-8) << times[i];
    const auto jerk = [&](double h) -> Vector2 {
      return (one_sided(path, times[i] + h, h).acceleration - one_sided(path, times[i], h).acceleration) / h;
    };
    largest_jerk_step = std::max(largest_jerk_step, (jerk(0.1) - jerk(-0.1)).norm());
  }
  EXPECT_GT(largest_jerk_step, 1.0);  // the third derivative does jump: knots were crossed
}

TEST(FlightPath, HasNoCurvatureAtItsEnds) {
  const FlightPath path(weaving(), Duration{0}, kAll);
  EXPECT_LE(one_sided(path, 0.0, 0.1).acceleration.norm(), 1e-8);
  EXPECT_LE(one_sided(path, 15.0, -0.1).acceleration.norm(), 1e-8);
  EXPECT_GT(one_sided(path, 6.0, 0.1).acceleration.norm(), 1.0);
}

/// The same places `shift` degrees of longitude farther round the earth, in [-180, 180].
RecordedFlight shifted(RecordedFlight flight, double shift_deg) {
  for (auto& sample : flight.samples) sample.longitude_deg = std::remainder(sample.longitude_deg + shift_deg, 360.0);
  return flight;
}

// The ellipsoid is round: a flight across 180 degrees is the same curve as the one across 8 degrees.
TEST(FlightPath, CrossesOneHundredAndEightyDegrees) {
  const FlightPath here(weaving(), Duration{0}, kAll);
  for (const double shift_deg : {171.99, 172.0, -188.0, -188.005, 352.0}) {
    const FlightPath there(shifted(weaving(), shift_deg), Duration{0}, kAll);
    for (int half = 0; half <= 30; ++half) {
      const double t = half / 2.0;
      EXPECT_LE((position_at(here, t) - position_at(there, t)).norm(), 1e-6) << shift_deg;
      EXPECT_LE((velocity_at(here, t) - velocity_at(there, t)).norm(), 1e-6) << shift_deg;
    }
  }
}

TEST(FlightPath, UsesTheSamplesOfItsSpan) {
  const RecordedFlight flight = weaving();  // 0 1 1.4 4 5.5 6 8.9 10 11 13 13.5 15
  const auto count = [&](double begin_s, double length_s) {
    return FlightPath::samples_in(flight, from_seconds(begin_s), from_seconds(length_s));
  };
  EXPECT_EQ(FlightPath::samples_in(flight, Duration{0}, kAll), 12);
  EXPECT_EQ(count(0.0, 4.0), 4);  // both ends belong to it
  EXPECT_EQ(count(0.0, 3.999), 3);
  EXPECT_EQ(count(0.001, 4.0), 3);
  EXPECT_EQ(count(1.0, 5.0), 5);
  EXPECT_EQ(count(15.0, 5.0), 1);
  EXPECT_EQ(count(15.1, 5.0), 0);
  EXPECT_EQ(FlightPath::samples_in(flight, kAll, kAll), 0);
  EXPECT_EQ(FlightPath(flight, from_seconds(1.0), from_seconds(5.0)).length(), from_seconds(5.0));
}

TEST(FlightPath, TakesEveryTimeThatTheReaderTakes) {
  std::string text = kHeader;
  for (const char* time : {"-4600000000", "-1", "0.5", "4600000000"}) text += std::string(time) + ",1,2,3,a\n";
  const RecordedFlight flight = read(text)[0];
  EXPECT_EQ(FlightPath::samples_in(flight, Duration{0}, kAll), 4);
  EXPECT_EQ(FlightPath::samples_in(flight, from_seconds(4.6e9), from_seconds(9e9)), 2);
  EXPECT_EQ(FlightPath(flight, Duration{0}, kAll).length(), from_seconds(9.2e9));
}

TEST(FlightPathDeathTest, StopsOnFewerThanFourSamplesAndOnTimesOutside) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(FlightPath(weaving(), Duration{0}, from_seconds(1.4)), "invariant broken");
  const FlightPath path(weaving(), Duration{0}, kAll);
  EXPECT_DEATH((void)path.state(Duration{-1}), "invariant broken");
  EXPECT_DEATH((void)path.state(path.length() + Duration{1}), "invariant broken");
}

TEST(RecordedTrajectory, PutsTheFlightInTimeAndPlace) {
  const auto path = std::make_shared<const FlightPath>(weaving(), Duration{0}, kAll);
  RecordedTrajectory trajectory(path, kStreamStart + from_seconds(100.0), TimePoint::max(), {40e3, -7e3});
  for (int scan = 100; scan <= 115; ++scan) {
    const State x = trajectory.advance(kStreamStart + from_seconds(scan)).value();
    const State flown_there = path->state(from_seconds(scan - 100));
    EXPECT_EQ(position(x), position(flown_there) + Vector2(40e3, -7e3));
    EXPECT_EQ(velocity(x), velocity(flown_there));
    EXPECT_EQ(trajectory.altitude_m(), path->altitude_m(from_seconds(scan - 100)));
  }
}

TEST(RecordedTrajectory, EndsWithTheFlightOrEarlier) {
  const auto path = std::make_shared<const FlightPath>(weaving(), Duration{0}, kAll);
  const auto at_s = [](double t) { return kStreamStart + from_seconds(t); };
  RecordedTrajectory whole(path, at_s(100.0), TimePoint::max(), Vector2::Zero());
  EXPECT_FALSE(whole.advance(at_s(99.0)).has_value());
  EXPECT_TRUE(whole.advance(at_s(115.0)).has_value());
  EXPECT_FALSE(whole.ended(at_s(115.0)));
  EXPECT_FALSE(whole.advance(at_s(116.0)).has_value());
  EXPECT_TRUE(whole.ended(at_s(116.0)));
  RecordedTrajectory cut(path, at_s(100.0), at_s(103.0), Vector2::Zero());
  EXPECT_TRUE(cut.advance(at_s(103.0)).has_value());
  EXPECT_FALSE(cut.advance(at_s(104.0)).has_value());
  EXPECT_TRUE(cut.ended(at_s(104.0)));
}

/// What the table of daemon/scenarios/flights/README.md says of a flight.
struct Figures {
  double median_speed_mps;
  double turning_deg;
  double largest_lateral_g;
};

Figures figures_of(const FlightPath& path) {
  Figures figures{};
  std::vector<double> speeds;
  const double step_s = 0.1;
  Vector2 before = velocity_at(path, step_s / 2);
  const int steps = static_cast<int>(to_seconds(path.length()) / step_s) - 1;
  for (int i = 1; i <= steps; ++i) {
    const double t = i * step_s;
    const Vector2 v = velocity_at(path, t);
    const Vector2 after = velocity_at(path, t + step_s / 2);
    const Vector2 acceleration = (after - before) / step_s;
    const double turning = (v.x() * acceleration.y() - v.y() * acceleration.x()) / v.norm();
    speeds.push_back(v.norm());
    figures.turning_deg += std::abs(turning) / v.norm() * step_s / kDegree;
    figures.largest_lateral_g = std::max(figures.largest_lateral_g, std::abs(turning) / 9.80665);
    before = after;
  }
  std::nth_element(speeds.begin(), speeds.begin() + std::ssize(speeds) / 2, speeds.end());
  figures.median_speed_mps = speeds[speeds.size() / 2];
  return figures;
}

TEST(Flights, AreWhatTheirTableSays) {
  std::ifstream file(DWELL_SOURCE_DIR "/daemon/scenarios/flights/flights.csv");
  const auto flights = read_recording(file, "flights.csv");
  const std::map<std::string, Figures> table{
      {"belevingsvlucht", {129, 1138, 0.51}}, {"dreamliner_airfrance", {109, 1459, 0.82}},
      {"bornholm", {78, 2793, 0.62}},         {"zero_gravity", {210, 519, 0.63}},
      {"toulouse", {83, 3208, 0.63}},         {"munich", {78, 1547, 0.55}}};
  ASSERT_EQ(flights.size(), table.size());
  for (const RecordedFlight& flight : flights) {
    const FlightPath path(flight, Duration{0}, kAll);
    EXPECT_EQ(flight.samples.size(), 1801U);
    EXPECT_EQ(path.length(), from_seconds(1800.0));
    const Figures figures = figures_of(path);
    const Figures& expected = table.at(flight.id);  // rounded to the last digit shown
    EXPECT_NEAR(figures.median_speed_mps, expected.median_speed_mps, 0.6) << flight.id;
    EXPECT_NEAR(figures.turning_deg, expected.turning_deg, 1.0) << flight.id;
    EXPECT_NEAR(figures.largest_lateral_g, expected.largest_lateral_g, 0.006) << flight.id;
  }
}

}  // namespace
}  // namespace dwell
