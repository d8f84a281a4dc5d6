#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "radar/random.hpp"
#include "radar/range_bearing_radar.hpp"
#include "tracker/metrics/continuity.hpp"
#include "tracker/metrics/gospa.hpp"
#include "tracker/metrics/mode_error.hpp"
#include "tracker/metrics/nis.hpp"
#include "tracker/metrics/ospa.hpp"
#include "tracker/metrics/track_loss.hpp"

namespace dwell {
namespace {

using Points = std::vector<Vector2>;

Points random_points(RandomStream& stream, int most) {
  Points points(stream.bits() % static_cast<unsigned>(most + 1));
  for (Vector2& p : points) p = {stream.uniform(0.0, 100.0), stream.uniform(0.0, 100.0)};
  return points;
}

TEST(Assignment, EqualsEnumeration) {
  RandomStream stream(1);
  for (int trial = 0; trial < 200; ++trial) {
    const auto columns = static_cast<Eigen::Index>(1 + stream.bits() % 6);
    const auto rows = static_cast<Eigen::Index>(1 + stream.bits() % static_cast<unsigned>(columns));
    Eigen::MatrixXd cost(rows, columns);
    for (double& c : cost.reshaped()) c = stream.uniform(-5.0, 5.0);
    std::vector<Eigen::Index> order(static_cast<std::size_t>(columns));
    std::iota(order.begin(), order.end(), 0);
    double best = 1e300;
    do {
      double sum = 0.0;
      for (Eigen::Index i = 0; i < rows; ++i) sum += cost(i, order[static_cast<std::size_t>(i)]);
      best = std::min(best, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    double sum = 0.0;
    const auto column = assign(cost);
    for (Eigen::Index i = 0; i < rows; ++i) sum += cost(i, column[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(sum, best, 1e-12);
    std::vector<Eigen::Index> sorted = column;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_TRUE(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
  }
}

// Two targets and three tracks, c = 10: pairs at 3 and 4 m, one false. The second target is better left with the
// farther track when the nearer one is the first's.
TEST(Gospa, PartsByHand) {
  const Gospa parts = gospa(Points{{0, 0}, {50, 0}}, Points{{50, 4}, {3, 0}, {200, 200}}, 10.0);
  EXPECT_DOUBLE_EQ(parts.localisation, 25.0);
  EXPECT_DOUBLE_EQ(parts.missed, 0.0);
  EXPECT_DOUBLE_EQ(parts.false_tracks, 50.0);
  const Gospa apart = gospa(Points{{0, 0}}, Points{{30, 0}}, 10.0);  // farther than c: one missed, one false
  EXPECT_DOUBLE_EQ(apart.localisation, 0.0);
  EXPECT_DOUBLE_EQ(apart.value(), 10.0);
  EXPECT_EQ(gospa({}, {}, 10.0).value(), 0.0);
}

TEST(Ospa, ByHand) {
  EXPECT_DOUBLE_EQ(ospa(Points{{0, 0}}, Points{{3, 0}, {80, 0}}, 10.0), std::sqrt((9.0 + 100.0) / 2.0));
  EXPECT_DOUBLE_EQ(ospa(Points{{0, 0}}, Points{}, 10.0), 10.0);
  EXPECT_EQ(ospa(Points{}, Points{}, 10.0), 0.0);
}

TimePoint at_s(double seconds) { return kStreamStart + from_seconds(seconds); }

// Found at its third scan, without a track at the sixth, another at the seventh, which becomes a third at the eighth.
TEST(Continuity, CountsByHand) {
  Continuity target;
  const std::vector<std::uint32_t> tracks{0, 0, 4, 4, 4, 0, 5, 6, 6, 6};
  for (std::size_t scan = 0; scan < tracks.size(); ++scan) {
    const auto track = tracks[scan] == 0 ? std::nullopt : std::optional(TrackId{tracks[scan]});
    target.add(at_s(10.0 + 2.0 * static_cast<double>(scan)), track);
  }
  EXPECT_EQ(target.scans(), 10);
  EXPECT_EQ(target.tracked(), 7);
  EXPECT_EQ(target.breaks(), 2);
  EXPECT_EQ(target.latency_s(), 4.0);
  Continuity unseen;
  unseen.add(at_s(0.0), std::nullopt);
  EXPECT_FALSE(unseen.latency_s());
}

// 10 km north: 100 m across are 10 mrad. The limit is a rectangle of range and azimuth.
TEST(TrackLoss, IsByRangeOrAzimuth) {
  const RangeBearingRadar radar(RadarFigures{});
  const Vector2 limit(50.0, 0.01);
  const auto lost = [&](double x, double y) {
    return is_lost(radar, make_state({x, y}, {0, 0}), make_state({0.0, 10e3}, {0, 0}), limit);
  };
  EXPECT_FALSE(lost(99.0, 10e3));
  EXPECT_TRUE(lost(101.0, 10e3));
  EXPECT_FALSE(lost(0.0, 10.049e3));
  EXPECT_TRUE(lost(0.0, 9.949e3));
  EXPECT_TRUE(is_lost(radar, make_state({0.0, -10e3}, {0, 0}), make_state({0.0, 10e3}, {0, 0}), limit));
}

// The band is where an exponential variable of mean 2 lies but for 2.5 % on each side.
TEST(Nis, BandHasNineteenTwentieths) {
  EXPECT_NEAR(1.0 - std::exp(-0.5 * kNisBand.low), 0.025, 1e-15);
  EXPECT_NEAR(std::exp(-0.5 * kNisBand.high), 0.025, 1e-15);
}

TEST(ModeError, TheLikeliestIsTheFirstAmongEquals) {
  EXPECT_EQ(likeliest_mode(make_estimate({}, Eigen::Vector3d(.2, .4, .4))), 1);
}

// Both are metrics: symmetric, zero of a set and itself, and the triangle inequality, up to rounding.
TEST(SetDistances, AreMetrics) {
  RandomStream stream(2);
  for (int trial = 0; trial < 500; ++trial) {
    const Points a = random_points(stream, 5);
    const Points b = random_points(stream, 5);
    const Points c = random_points(stream, 5);
    const auto g = [](const Points& x, const Points& y) { return gospa(x, y, 30.0).value(); };
    const auto o = [](const Points& x, const Points& y) { return ospa(x, y, 30.0); };
    EXPECT_NEAR(g(a, b), g(b, a), 1e-12);
    EXPECT_NEAR(o(a, b), o(b, a), 1e-12);
    EXPECT_NEAR(g(a, a), 0.0, 1e-6);  // the root of 1e-13
    EXPECT_NEAR(o(a, a), 0.0, 1e-6);
    EXPECT_LE(g(a, c), g(a, b) + g(b, c) + 1e-12);
    EXPECT_LE(o(a, c), o(a, b) + o(b, c) + 1e-12);
  }
}

}  // namespace
}  // namespace dwell
