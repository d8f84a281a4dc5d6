#include "radar/look.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "radar/linear_sensor.hpp"
#include "radar/range_bearing_radar.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"

namespace dwell {
namespace {

using statistics::binomial_band;
using statistics::chi_square_band;
using statistics::kolmogorov_bound;
using statistics::kolmogorov_distance;
using statistics::normal_sum_band;

constexpr double kPi = std::numbers::pi;
constexpr RadarId kRadar{1};

State at(const RadarFigures& figures, double range_m, double azimuth_rad) {
  return make_state(to_cartesian(figures.position_m, {range_m, azimuth_rad}), {0.0, 0.0});
}

Dwell dwell_at(int scan, const State& pointing) {
  return {kRadar, TrackId{1}, kStreamStart + from_seconds(scan), pointing};
}

std::vector<Plot> look(const Sensor& sensor, const Dwell& dwell, const std::vector<TargetTruth>& targets,
                       std::uint64_t seed = 1) {
  std::vector<Plot> plots;
  simulate_look(sensor, dwell, targets, RandomStream(seed).fork("radar/1"), plots);
  return plots;
}

/// How many of `count` looks at `pointing` saw the target.
int times_seen(const Sensor& sensor, const State& pointing, const State& target, int count) {
  int seen = 0;
  for (int scan = 0; scan < count; ++scan) {
    seen += static_cast<int>(look(sensor, dwell_at(scan, pointing), {{TargetId{1}, target}}).size());
  }
  return seen;
}

bool same(const Plot& a, const Plot& b) {
  return a.time == b.time && a.radar == b.radar && a.z == b.z && a.source == b.source;
}

bool same(const std::vector<Plot>& a, const std::vector<Plot>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Plot& x, const Plot& y) { return same(x, y); });
}

/// Sums over whitened errors whose exact laws are known: N(0, n), chi-square(n), and for the cross term
/// sum (a + b)^2 / 2 chi-square(n) where a and b are independent.
struct WhitenedSums {
  Vector2 sum = Vector2::Zero();
  Vector2 squares = Vector2::Zero();
  double cross = 0.0;
  int count = 0;

  void add(const Vector2& error) {
    sum += error;
    squares += error.cwiseProduct(error);
    cross += 0.5 * error.sum() * error.sum();
    ++count;
  }
};

void expect_standard_normal(const WhitenedSums& sums) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(normal_sum_band(sums.count).contains(sums.sum[i])) << i << ": " << sums.sum[i];
    EXPECT_TRUE(chi_square_band(sums.count).contains(sums.squares[i])) << i << ": " << sums.squares[i];
  }
  EXPECT_TRUE(chi_square_band(sums.count).contains(sums.cross)) << sums.cross;
}

struct NoiseCase {
  double range_m;
  double range_floor_m;
  double azimuth_floor_rad;
};

class LookNoise : public testing::TestWithParam<NoiseCase> {};

// The sigmas are written out here, not taken from the radar. Due south, so that half of the plots lie across
// the cut.
TEST_P(LookNoise, HasTheSigmaOfTheRadarEquation) {
  const auto [range_m, range_floor_m, azimuth_floor_rad] = GetParam();
  RadarFigures figures;
  figures.position_m = {30e3, -20e3};
  figures.range_noise_floor_m = range_floor_m;
  figures.azimuth_noise_floor_rad = azimuth_floor_rad;
  const RangeBearingRadar radar(figures);
  const double snr = 1e5 * std::pow(100e3 / range_m, 4);
  const double sigma_range =
      std::sqrt(std::pow(0.5 * 299792458.0 * 50e-9, 2) / (2.0 * snr) + std::pow(range_floor_m, 2));
  const double sigma_azimuth = std::sqrt(std::pow(kPi / 180.0 / 1.6, 2) / (2.0 * snr) + std::pow(azimuth_floor_rad, 2));

  const State target = at(figures, range_m, kPi);
  WhitenedSums sums;
  WhitenedSums twin;  // a fifth wider
  int east_of_south = 0;
  const int count = scaled(20'000);
  for (int scan = 0; scan < count; ++scan) {
    const auto plots = look(radar, dwell_at(scan, target), {{TargetId{1}, target}});
    ASSERT_EQ(plots.size(), 1U);
    EXPECT_GT(plots[0].z[1], -kPi);
    EXPECT_LE(plots[0].z[1], kPi);
    east_of_south += plots[0].z[1] > 0.0;
    const double turned = plots[0].z[1] > 0.0 ? plots[0].z[1] - kPi : plots[0].z[1] + kPi;
    const Vector2 error((plots[0].z[0] - range_m) / sigma_range, turned / sigma_azimuth);
    sums.add(error);
    twin.add(error / 1.2);
  }
  expect_standard_normal(sums);
  EXPECT_TRUE(binomial_band(count, 0.5).contains(east_of_south)) << east_of_south;
  EXPECT_FALSE(chi_square_band(count).contains(twin.squares[0]));
  EXPECT_FALSE(chi_square_band(count).contains(twin.squares[1]));
}

INSTANTIATE_TEST_SUITE_P(Ranges, LookNoise,
                         testing::Values(NoiseCase{5e3, 0.0, 0.0}, NoiseCase{60e3, 0.0, 0.0},
                                         NoiseCase{100e3, 0.0, 0.0}, NoiseCase{350e3, 0.0, 0.0},
                                         NoiseCase{5e3, 6.0, 1e-3}, NoiseCase{100e3, 0.02, 3e-5},
                                         NoiseCase{350e3, 0.2, 3e-4}));

// z = C x + v with a full R: whitened by its root the errors are standard and independent. Twin: without the
// covariance the cross term has 1 + 0.8 of its variance.
TEST(Look, OfALinearSensorHasTheFullNoiseCovariance) {
  MeasurementJacobian c;
  c << 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0;
  Matrix2 r;
  r << 4.0, 4.8, 4.8, 9.0;
  const LinearSensor sensor(c, r, 1.0);
  const Matrix2 root = r.llt().matrixL();
  const State x(100.0, 1.0, 200.0, 2.0);
  WhitenedSums sums;
  WhitenedSums twin;
  const int count = scaled(20'000);
  for (int scan = 0; scan < count; ++scan) {
    const auto plots = look(sensor, dwell_at(scan, State::Zero()), {{TargetId{1}, x}});
    ASSERT_EQ(plots.size(), 1U);
    const Vector2 error = plots[0].z - Vector2(100.0, 4.0);
    sums.add(root.triangularView<Eigen::Lower>().solve(error));
    twin.add(error.cwiseQuotient(Vector2(2.0, 3.0)));
  }
  expect_standard_normal(sums);
  EXPECT_FALSE(chi_square_band(count).contains(twin.cross));
}

TEST(Look, SeesAFixedShareOfItsLooks) {
  const int count = scaled(20'000);
  for (const double probability : {1.0, 0.9, 0.5, 0.1}) {
    for (const double range_m : {20e3, 300e3}) {
      RadarFigures figures;
      figures.detection = FixedDetection{probability};
      const State target = at(figures, range_m, 0.4);
      const int seen = times_seen(RangeBearingRadar(figures), target, target, count);
      EXPECT_TRUE(binomial_band(count, probability).contains(seen)) << seen << " of " << count << ", " << probability;
      EXPECT_FALSE(binomial_band(count, 0.5 * probability).contains(seen)) << probability;
    }
  }
}

// P_d = P_fa^(1 / (1 + SNR)), SNR = 20 (100 km / R)^4, written out. Twin: SNR doubled.
TEST(Look, SeesTheShareOfSwerlingOne) {
  const int count = scaled(20'000);
  RadarFigures figures;
  figures.snr_reference = 20.0;
  figures.detection = SwerlingOneDetection{1e-5};
  for (const double range_m : {60e3, 100e3, 140e3, 180e3}) {
    const double snr = 20.0 * std::pow(100e3 / range_m, 4);
    const State target = at(figures, range_m, -2.0);
    const int seen = times_seen(RangeBearingRadar(figures), target, target, count);
    EXPECT_TRUE(binomial_band(count, std::pow(1e-5, 1.0 / (1.0 + snr))).contains(seen)) << range_m << ": " << seen;
    EXPECT_FALSE(binomial_band(count, std::pow(1e-5, 1.0 / (1.0 + 2.0 * snr))).contains(seen)) << range_m;
  }
}

TEST(Look, SeesUpToTheEdgeOfTheFootprintAndNothingBeyond) {
  RadarFigures figures;
  figures.dwell_range_m = 10e3;
  figures.dwell_azimuth_rad = 3.0 * kDegree;
  const RangeBearingRadar radar(figures);
  const int count = scaled(1000);
  for (const double azimuth : {0.3, kPi, -179.0 * kDegree}) {  // the last two footprints lie across south
    const State pointing = at(figures, 100e3, azimuth);
    const auto seen = [&](double range_off_m, double azimuth_off_deg) {
      const State target = at(figures, 100e3 + range_off_m, azimuth + azimuth_off_deg * kDegree);
      return times_seen(radar, pointing, target, count);
    };
    EXPECT_EQ(seen(9999.99, 0.0), count);
    EXPECT_EQ(seen(-9999.99, 0.0), count);
    EXPECT_EQ(seen(0.0, 2.9999), count);
    EXPECT_EQ(seen(0.0, -2.9999), count);
    EXPECT_EQ(seen(10000.01, 0.0), 0);
    EXPECT_EQ(seen(-10000.01, 0.0), 0);
    EXPECT_EQ(seen(0.0, 3.0001), 0);
    EXPECT_EQ(seen(0.0, -3.0001), 0);
    EXPECT_EQ(seen(-200e3, 0.0), 0);  // behind the radar, same line
  }
}

TEST(Look, NeverSeesATargetOutsideTheCoverage) {
  RadarFigures figures;
  figures.max_range_m = 100e3;
  figures.sector_centre_rad = kPi;
  figures.sector_width_rad = 20.0 * kDegree;
  const RangeBearingRadar radar(figures);
  const int count = scaled(1000);
  const State edge = at(figures, 99e3, kPi - 9.5 * kDegree);
  EXPECT_EQ(times_seen(radar, edge, at(figures, 99.9e3, kPi - 9.9 * kDegree), count), count);
  EXPECT_EQ(times_seen(radar, edge, at(figures, 100.1e3, kPi - 9.5 * kDegree), count), 0);
  EXPECT_EQ(times_seen(radar, edge, at(figures, 99e3, kPi - 10.1 * kDegree), count), 0);
  EXPECT_EQ(times_seen(radar, at(figures, 0.0, 0.0), at(figures, 0.0, 0.0), count), 0);
}

RadarFigures cluttered() {
  RadarFigures figures;
  figures.position_m = {-10e3, 5e3};
  figures.clutter_density = 3e-3;
  figures.dwell_range_m = 10e3;
  figures.dwell_azimuth_rad = 3.0 * kDegree;
  return figures;
}

struct Clutter {
  std::vector<int> counts;
  std::vector<double> ranges_m;
  std::vector<double> offsets_rad;  // azimuth from the middle of the footprint
};

Clutter clutter_of(const RadarFigures& figures, double range_m, double azimuth_rad, int count) {
  const RangeBearingRadar radar(figures);
  const State pointing = at(figures, range_m, azimuth_rad);
  Clutter clutter;
  for (int scan = 0; scan < count; ++scan) {
    const auto plots = look(radar, dwell_at(scan, pointing), {});
    clutter.counts.push_back(static_cast<int>(plots.size()));
    for (const Plot& plot : plots) {
      EXPECT_FALSE(plot.source.has_value());
      EXPECT_GT(plot.z[1], -kPi);
      EXPECT_LE(plot.z[1], kPi);
      clutter.ranges_m.push_back(plot.z[0]);
      clutter.offsets_rad.push_back(std::remainder(plot.z[1] - azimuth_rad, 2.0 * kPi));
    }
  }
  return clutter;
}

struct Box {
  double near_m;
  double far_m;
  double half_rad;
};

/// Counts Poisson with density x area; plots uniform over the box, the two coordinates independent; none
/// outside.
void expect_uniform_clutter(const Clutter& clutter, const Box& box, double density) {
  const double mean = density * (box.far_m - box.near_m) * 2.0 * box.half_rad;
  const double n = static_cast<double>(clutter.ranges_m.size());
  EXPECT_TRUE(statistics::poisson_band(mean * static_cast<double>(clutter.counts.size())).contains(n)) << n;
  const auto fit = statistics::poisson_fit(clutter.counts, mean);
  EXPECT_TRUE(chi_square_band(fit.degrees).contains(fit.statistic)) << fit.statistic << " of " << fit.degrees;

  constexpr std::size_t kCells = 8;
  std::vector<double> observed(kCells * kCells, 0.0);
  std::vector<double> across, along;
  for (std::size_t i = 0; i < clutter.ranges_m.size(); ++i) {
    along.push_back((clutter.ranges_m[i] - box.near_m) / (box.far_m - box.near_m));
    across.push_back(0.5 + 0.5 * clutter.offsets_rad[i] / box.half_rad);
    ASSERT_TRUE(along[i] >= 0.0 && along[i] <= 1.0) << clutter.ranges_m[i];
    ASSERT_TRUE(across[i] >= -1e-12 && across[i] <= 1.0 + 1e-12) << clutter.offsets_rad[i];
    const auto cell = [](double x) { return static_cast<std::size_t>(std::clamp(x, 0.0, 0.999999) * kCells); };
    observed[cell(along[i]) * kCells + cell(across[i])] += 1.0;
  }
  const auto uniform = [](double x) { return std::clamp(x, 0.0, 1.0); };
  EXPECT_LE(kolmogorov_distance(along, uniform), kolmogorov_bound(n));
  EXPECT_LE(kolmogorov_distance(across, uniform), kolmogorov_bound(n));
  const std::vector<double> expected(kCells * kCells, n / (kCells * kCells));
  const double statistic = statistics::pearson(observed, expected);
  EXPECT_TRUE(chi_square_band(kCells * kCells - 1).contains(statistic)) << statistic;
}

TEST(FalseAlarms, ArePoissonAndUniformOverTheFootprint) {
  const int count = scaled(20'000);
  const Clutter clutter = clutter_of(cluttered(), 60e3, 0.7, count);
  expect_uniform_clutter(clutter, {50e3, 70e3, 3.0 * kDegree}, 3e-3);
  // Twins: a density a tenth higher, and uniform over the area of the annulus instead of range x azimuth.
  const double n = static_cast<double>(clutter.ranges_m.size());
  const double mean = 3.3e-3 * 20e3 * 6.0 * kDegree;
  EXPECT_FALSE(statistics::poisson_band(mean * count).contains(n));
  const auto by_area = [](double r) { return (r * r - 50e3 * 50e3) / (70e3 * 70e3 - 50e3 * 50e3); };
  EXPECT_GT(kolmogorov_distance(clutter.ranges_m, by_area), kolmogorov_bound(n));
}

TEST(FalseAlarms, CrossSouthWithoutAGap) {
  expect_uniform_clutter(clutter_of(cluttered(), 60e3, kPi, scaled(20'000)), {50e3, 70e3, 3.0 * kDegree}, 3e-3);
}

TEST(FalseAlarms, AreClippedAtTheRadar) {
  expect_uniform_clutter(clutter_of(cluttered(), 4e3, -1.0, scaled(20'000)), {0.0, 14e3, 3.0 * kDegree}, 3e-3);
}

TEST(FalseAlarms, AreClippedAtTheGreatestRange) {
  RadarFigures figures = cluttered();
  figures.max_range_m = 63e3;
  expect_uniform_clutter(clutter_of(figures, 60e3, 2.0, scaled(20'000)), {50e3, 63e3, 3.0 * kDegree}, 3e-3);
}

TEST(FalseAlarms, AFootprintBeyondTheGreatestRangeIsEmpty) {
  RadarFigures figures = cluttered();
  figures.max_range_m = 50e3;
  EXPECT_TRUE(clutter_of(figures, 60e3 + 1.0, 2.0, scaled(1000)).ranges_m.empty());
}

// A beam of 90 degrees has a default footprint of +-270: no direction may be counted twice.
TEST(FalseAlarms, AFootprintWiderThanTheCircleIsTheCircle) {
  RadarFigures figures = cluttered();
  figures.dwell_azimuth_rad = 270.0 * kDegree;
  figures.clutter_density = 1e-4;
  expect_uniform_clutter(clutter_of(figures, 60e3, 0.7, scaled(20'000)), {50e3, 70e3, kPi}, 1e-4);
}

TEST(FalseAlarms, WithoutDensityThereAreNone) {
  RadarFigures figures = cluttered();
  figures.clutter_density = 0.0;
  EXPECT_TRUE(clutter_of(figures, 60e3, 2.0, 100).ranges_m.empty());
}

/// A look at three targets in clutter, and what is needed to repeat it.
struct Crowd {
  RadarFigures figures = cluttered();
  State pointing = at(figures, 60e3, 0.7);
  std::vector<TargetTruth> targets{{TargetId{4}, at(figures, 61e3, 0.70)},
                                   {TargetId{2}, at(figures, 58e3, 0.71)},
                                   {TargetId{9}, at(figures, 63e3, 0.68)}};
};

TEST(Look, ReturnsTargetsInOrderThenFalseAlarms) {
  const Crowd crowd;
  const Dwell dwell = dwell_at(17, crowd.pointing);
  const auto plots = look(RangeBearingRadar(crowd.figures), dwell, crowd.targets);
  ASSERT_GT(plots.size(), 3U);
  EXPECT_EQ(plots[0].source, TargetId{4});
  EXPECT_EQ(plots[1].source, TargetId{2});
  EXPECT_EQ(plots[2].source, TargetId{9});
  for (std::size_t i = 0; i < plots.size(); ++i) {
    EXPECT_EQ(plots[i].time, dwell.time);
    EXPECT_EQ(plots[i].radar, dwell.radar);
    EXPECT_EQ(plots[i].source.has_value(), i < 3);
  }
}

TEST(Look, ClearsThePlotsFirst) {
  std::vector<Plot> plots(5);
  simulate_look(RangeBearingRadar({}), dwell_at(1, State::Zero()), {}, RandomStream(1), plots);
  EXPECT_TRUE(plots.empty());
}

// Common random numbers: one look is the same whatever was looked at before, with the same stream.
TEST(Look, IsTheSameWhateverHappenedBefore) {
  const Crowd crowd;
  const RangeBearingRadar radar(crowd.figures);
  const RandomStream stream = RandomStream(3).fork("radar/1");
  std::vector<Plot> alone, after;
  simulate_look(radar, dwell_at(17, crowd.pointing), crowd.targets, stream, alone);
  for (int scan = 0; scan < 17; ++scan) {
    const State elsewhere = at(crowd.figures, 30e3 + 1e3 * scan, 0.2 * scan);
    simulate_look(radar, dwell_at(scan, elsewhere), crowd.targets, stream, after);
  }
  simulate_look(radar, dwell_at(17, crowd.pointing), crowd.targets, stream, after);
  EXPECT_TRUE(same(alone, after));
  EXPECT_FALSE(alone.empty());
}

TEST(Look, FurtherTargetsDoNotShiftTheOthers) {
  const Crowd crowd;
  const RangeBearingRadar radar(crowd.figures);
  const Dwell dwell = dwell_at(17, crowd.pointing);
  const auto all = look(radar, dwell, crowd.targets);
  const auto one = look(radar, dwell, {crowd.targets[1]});
  ASSERT_EQ(one.size() + 2, all.size());
  EXPECT_TRUE(same(one[0], all[1]));
  EXPECT_TRUE(
      std::equal(one.begin() + 1, one.end(), all.begin() + 3, [](const Plot& a, const Plot& b) { return same(a, b); }));
}

TEST(Look, AimingElsewhereDoesNotChangeTheTargetsPlot) {
  const Crowd crowd;
  const RangeBearingRadar radar(crowd.figures);
  const auto here = look(radar, dwell_at(17, crowd.pointing), {crowd.targets[0]});
  const auto there = look(radar, dwell_at(17, at(crowd.figures, 59e3, 0.69)), {crowd.targets[0]});
  EXPECT_TRUE(same(here[0], there[0]));
}

TEST(Look, ChangesWithTimeWithTargetAndWithStream) {
  const Crowd crowd;
  const RangeBearingRadar radar(crowd.figures);
  const TargetTruth renamed{TargetId{5}, crowd.targets[0].state};
  const Vector2 z = look(radar, dwell_at(17, crowd.pointing), {crowd.targets[0]})[0].z;
  EXPECT_NE(look(radar, dwell_at(18, crowd.pointing), {crowd.targets[0]})[0].z, z);
  EXPECT_NE(look(radar, dwell_at(17, crowd.pointing), {renamed})[0].z, z);
  EXPECT_NE(look(radar, dwell_at(17, crowd.pointing), {crowd.targets[0]}, 2)[0].z, z);
}

}  // namespace
}  // namespace dwell
