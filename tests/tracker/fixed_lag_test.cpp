#include "tracker/fixed_lag.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "radar/frames.hpp"
#include "radar/random.hpp"
#include "radar/range_bearing_radar.hpp"
#include "tests/scale.hpp"
#include "tests/tracker/position_sensor.hpp"

namespace dwell {
namespace {

constexpr Duration kPeriod = std::chrono::seconds(1);
constexpr int kLag = 6;  // scans

struct Arrived {
  Dwell dwell;
  std::vector<Plot> plots;
};

/// Two radars that look at a target in every scan or in every second, see it nine times out of ten, and false plots.
struct World {
  World() {
    RandomStream stream(1);
    const StateMatrix f = transition(ConstantVelocity{}, 1.0);
    for (int scan = 1; scan <= kScans; ++scan) {
      truth = f * truth;
      for (std::uint32_t radar = 1; radar <= 2; ++radar) {
        if (radar == 2 && scan % 2 == 0) continue;
        const TimePoint time = kStreamStart + scan * kPeriod;
        Arrived look{{RadarId{radar}, TrackId{1}, time, truth}, {}};
        if (stream.uniform() < 0.9) add(look, position(truth) + 20.0 * Vector2(stream.normal(), stream.normal()));
        for (int k = stream.poisson(1.0); k > 0; --k) {
          add(look, position(truth) + Vector2(stream.uniform(-300.0, 300.0), stream.uniform(-300.0, 300.0)));
        }
        looks.push_back(look);
      }
    }
  }

  static void add(Arrived& look, const Vector2& z) {
    look.plots.push_back({look.dwell.time, look.dwell.radar, z, std::nullopt});
  }

  FixedLag start(Tracker& tracker, int lag = kLag) const {
    const Gaussian belief{make_state({0.0, 0.0}, {90.0, 10.0}), State(1e4, 400.0, 1e4, 400.0).asDiagonal()};
    return {tracker, tracker.start(TrackId{1}, "one", belief), kStreamStart, kPeriod, lag * kPeriod};
  }

  static constexpr int kScans = 10;
  PositionSensor sensor{400.0 * Matrix2::Identity(), 0.9, 1.0 / (600.0 * 600.0), 300.0};
  State truth = make_state({0.0, 0.0}, {100.0, 0.0});
  std::vector<Arrived> looks;
};

Tracker tracker_with(Association association) {
  const ModeBank bank = *named_bank("cruise_and_turn");
  TrackerSettings settings;
  settings.association = association;
  return {*discretise(bank, 1.0), bank.initial_probability, settings};
}

/// Every bit of the belief, and what is counted beside it.
bool same(const Track& a, const Track& b) {
  bool equal = a.estimate.probability == b.estimate.probability && a.status == b.status && a.nis == b.nis &&
               a.existence == b.existence && a.rejections == b.rejections && a.last_look == b.last_look &&
               a.last_radar == b.last_radar && a.age_scans == b.age_scans && a.unseen_scans == b.unseen_scans &&
               a.log_miss_probability == b.log_miss_probability;
  for (std::size_t j = 0; j < a.estimate.modes.size(); ++j) {
    const Gaussian& one = a.estimate.modes[j];
    const Gaussian& other = b.estimate.modes[j];
    equal = equal && std::memcmp(one.mean.data(), other.mean.data(), sizeof(State)) == 0 &&
            std::memcmp(one.covariance.data(), other.covariance.data(), sizeof(StateMatrix)) == 0;
  }
  return equal;
}

class FixedLagOf : public testing::TestWithParam<Association> {};

INSTANTIATE_TEST_SUITE_P(Associations, FixedLagOf,
                         testing::Values(Association::kNearest, Association::kPda, Association::kIpda,
                                         Association::kIts));

// Each look late by 0 .. 6 scans, plots and looks that arrive in one scan in any order: 10^4 orders.
TEST_P(FixedLagOf, AnyOrderWithinTheLagIsTheOrderOfTime) {
  World world;
  Tracker tracker = tracker_with(GetParam());
  Track expected = world.start(tracker).track();
  std::size_t next = 0;
  for (int scan = 1; scan <= World::kScans + kLag; ++scan) {
    tracker.predict(expected);
    for (; next < world.looks.size() && world.looks[next].dwell.time == kStreamStart + scan * kPeriod; ++next) {
      auto plots = world.looks[next].plots;
      std::sort(plots.begin(), plots.end(), [](const Plot& a, const Plot& b) { return a.z.x() < b.z.x(); });
      (void)tracker.look(expected, world.sensor, world.looks[next].dwell, plots);
    }
  }
  ASSERT_TRUE(expected.alive());
  RandomStream stream(2);
  // The looks of ITS take thirty times as long.
  const int orders = GetParam() == Association::kIts ? soaked(10'000, scaled(500)) : scaled(10'000);
  int late = 0;
  for (int order = 0; order < orders; ++order) {
    struct Due {
      int scan;
      double turn;
      std::size_t look;
    };
    std::vector<Due> due;
    for (std::size_t i = 0; i < world.looks.size(); ++i) {
      const int made = static_cast<int>((world.looks[i].dwell.time - kStreamStart) / kPeriod);
      due.push_back({made + static_cast<int>(stream.bits() % (kLag + 1)), stream.uniform(), i});
      late += due.back().scan > made ? 1 : 0;
    }
    std::sort(due.begin(), due.end(),
              [](const Due& a, const Due& b) { return std::tie(a.scan, a.turn) < std::tie(b.scan, b.turn); });
    FixedLag lagged = world.start(tracker);
    auto arriving = due.begin();
    for (int scan = 1; scan <= World::kScans + kLag; ++scan) {
      lagged.advance();
      for (; arriving != due.end() && arriving->scan == scan; ++arriving) {
        Arrived look = world.looks[arriving->look];
        if (look.plots.size() > 1) std::swap(look.plots.front(), look.plots[stream.bits() % look.plots.size()]);
        ASSERT_EQ(lagged.look(world.sensor, look.dwell, look.plots), FixedLag::Arrival::kUsed);
      }
    }
    ASSERT_TRUE(same(lagged.track(), expected)) << "order " << order;
    ASSERT_EQ(lagged.counts().too_late + lagged.counts().duplicates, 0U);
  }
  EXPECT_GT(late, orders * static_cast<int>(world.looks.size()) / 2);
}

// All looks by two networks, the second up to the lag later, and one plot of a look ahead of the others.
TEST_P(FixedLagOf, DuplicatesCountOnce) {
  World world;
  Tracker tracker = tracker_with(GetParam());
  FixedLag once = world.start(tracker);
  FixedLag twice = world.start(tracker);
  std::uint64_t plots = 0;
  for (int scan = 1; scan <= World::kScans; ++scan) {
    once.advance();
    twice.advance();
    for (const Arrived& look : world.looks) {
      if (look.dwell.time == once.time()) {
        (void)once.look(world.sensor, look.dwell, look.plots);
        if (!look.plots.empty()) (void)twice.look(world.sensor, look.dwell, {&look.plots.back(), 1});
        const auto arrival = look.plots.size() == 1 ? FixedLag::Arrival::kDuplicate : FixedLag::Arrival::kUsed;
        EXPECT_EQ(twice.look(world.sensor, look.dwell, look.plots), arrival);
        plots += look.plots.empty() ? 0 : 1;
      }
      if (look.dwell.time == once.time() - 3 * kPeriod) {
        EXPECT_EQ(twice.look(world.sensor, look.dwell, look.plots), FixedLag::Arrival::kDuplicate);
        plots += look.plots.size();
      }
    }
  }
  EXPECT_TRUE(same(once.track(), twice.track()));
  EXPECT_EQ(twice.counts().duplicates, plots);
  EXPECT_EQ(once.counts().duplicates, 0U);
}

// At the lag a look still counts; a scan later it is dropped, and the track is as if it had never been.
TEST(FixedLag, LooksOlderThanTheLagAreDroppedAndCounted) {
  World world;
  Tracker tracker = tracker_with(Association::kNearest);
  const Dwell dwell{RadarId{1}, TrackId{1}, kStreamStart + kPeriod, world.truth};
  const std::vector<Plot> plots(1, {dwell.time, dwell.radar, Vector2(95.0, 10.0), std::nullopt});
  for (const int late : {kLag, kLag + 1}) {
    FixedLag lagged = world.start(tracker);
    for (int scan = 1; scan <= 1 + late; ++scan) lagged.advance();
    const Track without = lagged.track();
    const bool dropped = late > kLag;
    EXPECT_EQ(lagged.look(world.sensor, dwell, plots),
              dropped ? FixedLag::Arrival::kTooLate : FixedLag::Arrival::kUsed);
    EXPECT_EQ(lagged.counts().too_late, dropped ? 1U : 0U);
    EXPECT_EQ(same(lagged.track(), without), dropped);
  }
}

// Eight misses lose the track; the plots of the first of them, late, keep it alive.
TEST(FixedLag, ALostTrackLivesAgainByLatePlots) {
  World world;
  Tracker tracker = tracker_with(Association::kNearest);
  FixedLag lagged = world.start(tracker, 10);
  std::vector<Dwell> looks;
  for (int scan = 1; scan <= 8; ++scan) {
    lagged.advance();
    looks.push_back({RadarId{1}, TrackId{1}, lagged.time(), lagged.track().combined.mean});
    (void)lagged.look(world.sensor, looks.back(), {});
  }
  EXPECT_FALSE(lagged.track().alive());
  lagged.advance();
  const Plot plot{looks[4].time, RadarId{1}, Vector2(480.0, 20.0), std::nullopt};
  EXPECT_EQ(lagged.look(world.sensor, looks[4], {&plot, 1}), FixedLag::Arrival::kUsed);
  EXPECT_TRUE(lagged.track().alive());
}

TEST(FixedLag, PlotsThatAreNotFiniteArePassedOver) {
  World world;
  Tracker tracker = tracker_with(Association::kNearest);
  FixedLag lagged = world.start(tracker);
  lagged.advance();
  const Dwell dwell{RadarId{1}, TrackId{1}, lagged.time(), world.truth};
  std::vector<Plot> plots(
      2, {dwell.time, dwell.radar, Vector2(std::numeric_limits<double>::infinity(), 0.0), std::nullopt});
  plots[1].z = Vector2(std::numeric_limits<double>::quiet_NaN(), 0.0);
  EXPECT_EQ(lagged.look(world.sensor, dwell, plots), FixedLag::Arrival::kUsed);
  EXPECT_TRUE(lagged.track().combined.mean.allFinite());
}

// --- captures of two networks

/// A plot of a capture by two networks, as `tod_s,..,sic,..,rho_m,theta_deg,..,address,track_no` of its CSV.
struct Captured {
  std::string target;  // radar and identity
  std::int64_t tick;   // of 1/128 s: the resolution of the time of day in ASTERIX
  Vector2 z;
};

std::vector<Captured> read_capture(const char* file) {
  std::ifstream input(file);
  std::vector<Captured> all;
  std::string line;
  std::getline(input, line);
  while (std::getline(input, line)) {
    std::vector<std::string> cell;
    std::istringstream cells(line);
    for (std::string text; std::getline(cells, text, ',');) cell.push_back(text);
    all.push_back({cell.at(3) + "/" + (cell.at(9).empty() ? cell.at(10) : cell.at(9)),
                   std::llround(std::stod(cell.at(1)) * 128.0),
                   {std::stod(cell.at(5)), std::stod(cell.at(6)) * kDegree}});
  }
  return all;
}

/// What three radars of a turn in 4 s send of ten targets each, in the units of CAT048 (1/128 s, 1/256 NM, 360 / 2^16
/// degrees): over one network some 5 ms later, over the other 10, one record in 20 lost on either; by their arrival.
std::vector<Captured> make_capture() {
  constexpr double kRangeUnit_m = 1852.0 / 256.0;
  constexpr double kAngleUnit_rad = 360.0 * kDegree / 65536.0;
  RandomStream stream(8);
  std::vector<std::pair<double, Captured>> arrived;
  for (int radar = 1; radar <= 3; ++radar) {
    for (int target = 1; target <= 10; ++target) {
      Vector2 place(stream.uniform(-150e3, 150e3), stream.uniform(-150e3, 150e3));
      const Vector2 step = 4.0 * Vector2(stream.uniform(-200.0, 200.0), stream.uniform(-200.0, 200.0));
      for (int turn = 0; turn < 4; ++turn, place += step) {
        const double azimuth = std::atan2(place.x(), place.y());
        const double sent_s = 4.0 * (turn + (azimuth + std::numbers::pi) / (2.0 * std::numbers::pi));
        const Captured plot{std::to_string(radar) + "/" + std::to_string(target),
                            std::llround(sent_s * 128.0),
                            {kRangeUnit_m * std::round((place.norm() + 50.0 * stream.normal()) / kRangeUnit_m),
                             kAngleUnit_rad * std::round((azimuth + 1.4e-3 * stream.normal()) / kAngleUnit_rad)}};
        for (const double delay_s : {0.005, 0.010}) {
          if (stream.uniform() < 0.95) arrived.emplace_back(sent_s + delay_s * stream.uniform(0.5, 1.5), plot);
        }
      }
    }
  }
  std::sort(arrived.begin(), arrived.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Captured> capture;
  for (const auto& [time_s, plot] : arrived) capture.push_back(plot);
  return capture;
}

/// In the order in which they came, and once with what came before left out: the same bits, and each is counted.
void expect_counted_once(const std::vector<Captured>& capture) {
  const Duration tick = std::chrono::nanoseconds(7'812'500);
  const ModeBank bank = *named_bank("cruise_and_turn");
  Tracker tracker(*discretise(bank, to_seconds(tick)), bank.initial_probability, {});
  RadarFigures figures;
  figures.range_noise_floor_m = 50.0;
  figures.azimuth_noise_floor_rad = 0.08 * kDegree;
  const RangeBearingRadar radar(figures);
  struct Both {
    FixedLag once, twice;
    std::vector<Captured> seen;
  };
  std::map<std::string, Both> tracks;
  std::uint64_t repeated = 0;
  std::uint64_t counted = 0;
  for (const Captured& captured : capture) {
    const TimePoint time = kStreamStart + captured.tick * tick;
    const Plot plot{time, RadarId{1}, captured.z, std::nullopt};
    const auto belief = Tracker::belief_from(plot, radar, 250.0);
    ASSERT_TRUE(belief);
    const Track start = tracker.start(TrackId{1}, captured.target, *belief);
    const FixedLag fresh(tracker, start, time, tick, std::chrono::seconds(5));
    Both& both = tracks.try_emplace(captured.target, Both{fresh, fresh, {}}).first->second;
    while (both.once.time() < time) {
      both.once.advance();
      both.twice.advance();
    }
    const Dwell dwell{RadarId{1}, TrackId{1}, time, start.combined.mean};
    const bool again = std::any_of(both.seen.begin(), both.seen.end(), [&](const Captured& earlier) {
      return earlier.tick == captured.tick && earlier.z == captured.z;
    });
    repeated += again ? 1 : 0;
    if (!again) (void)both.once.look(radar, dwell, {&plot, 1});
    const auto arrival = both.twice.look(radar, dwell, {&plot, 1});
    EXPECT_EQ(arrival, again ? FixedLag::Arrival::kDuplicate : FixedLag::Arrival::kUsed);
    both.seen.push_back(captured);
  }
  for (const auto& [target, both] : tracks) {
    EXPECT_TRUE(same(both.once.track(), both.twice.track())) << target;
    counted += both.twice.counts().duplicates;
  }
  std::printf("%zu plots of %zu targets, %llu of them repeated\n", capture.size(), tracks.size(),
              static_cast<unsigned long long>(repeated));
  EXPECT_EQ(counted, repeated);
  EXPECT_GT(repeated, 0U);
}

// R23. And where DWELL_CAPTURE names the plots of a real one (CAT048 of seven radars, nearly every record twice), that.
TEST(FixedLag, CaptureOfTwoNetworksCountsOnce) {
  expect_counted_once(make_capture());
  if (const char* file = std::getenv("DWELL_CAPTURE")) expect_counted_once(read_capture(file));
}

}  // namespace
}  // namespace dwell
