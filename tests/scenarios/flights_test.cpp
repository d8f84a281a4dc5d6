// Recorded flights, each alone: a look every 1, 3 or 6 s at the default bank. Does the filter know how wrong it is over
// the whole flight (NEES), and how near is it to the least error that is possible (the bound given the looks)?

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scale.hpp"
#include "tests/scenarios/monte_carlo.hpp"
#include "tracker/metrics/cramer_rao.hpp"
#include "tracker/metrics/nees.hpp"

namespace dwell::testing {
namespace {

constexpr std::array kIntervals_s{1, 3, 6};
constexpr double kBoundDensity = 0.1;    // m^2/s^3: the cruise mode's, of the bound
constexpr std::size_t kAirPicture = 10;  // flights of a file
constexpr double kTurning = 0.5;         // m/s^2 across: from here on a flight turns

/// A flight of a file of recordings.
struct Flight {
  std::string file;
  std::string id;
};

/// Those of the repository, or of every file of the folder in DWELL_FLIGHTS that is no air picture of dozens.
std::vector<Flight> flights() {
  const char* folder = std::getenv("DWELL_FLIGHTS");
  const std::filesystem::path own = std::string(DWELL_SOURCE_DIR) + "/daemon/scenarios/flights";
  std::vector<Flight> all;
  for (const auto& entry : std::filesystem::directory_iterator(folder == nullptr ? own : folder)) {
    if (entry.path().extension() != ".csv") continue;
    std::ifstream input(entry.path());
    const auto recorded = read_recording(input, entry.path().string());
    if (recorded.size() > kAirPicture) continue;
    for (const RecordedFlight& flight : recorded) {
      all.push_back({entry.path().string(), flight.id});
    }
  }
  std::sort(all.begin(), all.end(),
            [](const Flight& a, const Flight& b) { return std::tie(a.file, a.id) < std::tie(b.file, b.id); });
  return all;
}

/// A radar 100 km south of the middle of the flight, P_d .9, 15 m and .05 degree, the best of recorded_flights. The
/// rule of loss by the truth is off: over a whole flight it ends tracks that would come back.
std::string config_text(const Flight& flight, int interval_s, const char* update) {
  return "scan_period_s: " + std::to_string(interval_s) +
         "\n"
         "radar { name: \"r\" y_m: -100e3 range_noise_floor_m: 15 azimuth_noise_floor_deg: 0.05 "
         "detection_probability: 0.9 }\n"
         "target { name: \"t\" recording { file: \"" +
         flight.file + "\" id: \"" + flight.id + "\" } }\ntracker { lost_squared_distance: inf update: " + update +
         " }\n";
}

/// Errors of the scans of one kind of motion, and the bound's.
struct Part {
  double squared_m2 = 0.0;
  double bound_m2 = 0.0;

  double efficiency() const { return std::sqrt(squared_m2 / bound_m2); }
};

struct Figures {
  double nees = 0.0;
  double updates = 0.0;
  int lost = 0;
  Part straight;
  Part turning;
};

void add_run(const EngineConfig& config, Figures& figures) {
  Engine engine(config);
  const double dt_s = to_seconds(config.scan_period);
  const StateMatrix f = transition(ConstantVelocity{}, dt_s);
  const StateMatrix q = white_noise(ConstantVelocity{}, kBoundDensity, dt_s);
  CramerRaoBound bound(std::get<CuedStart>(config.targets[0].track_start).covariance);
  std::optional<Vector2> velocity_before;
  do {
    engine.scan();
    if (engine.last().truth.empty()) break;
    const State& truth = engine.last().truth[0].state;
    const Track& track = engine.tracks()[0];
    bound.predict(f, q);
    for (const LookReport& look : engine.last().looks) {
      if (!look.used_plot) continue;
      bound.look(*engine.sensors()[0], truth);
      figures.nees += nees(truth, track.combined) / kStateSize;
      ++figures.updates;
    }
    const Vector2 v = velocity(truth);
    const Vector2 turn = velocity_before ? Vector2((v - *velocity_before) / dt_s) : Vector2::Zero();
    velocity_before = v;
    const double across = std::abs(v.x() * turn.y() - v.y() * turn.x()) / std::max(v.norm(), 1e-3);
    Part& part = across > kTurning ? figures.turning : figures.straight;
    part.squared_m2 += (position(truth) - position(track.combined.mean)).squaredNorm();
    part.bound_m2 += position_block(bound.covariance()).trace();
  } while (true);
  figures.lost += static_cast<int>(engine.counts().tracks_lost);
}

Figures fly(const Flight& flight, int interval_s, const char* update, int runs) {
  EngineConfig config = read_config_text(config_text(flight, interval_s, update), "flights", ".").engine;
  Figures figures;
  for (int run = 1; run <= runs; ++run) {
    config.seed = static_cast<std::uint64_t>(run);
    add_run(config, figures);
  }
  return figures;
}

TEST(RecordedFlights, NeesOfTheDefaultBank) {
  const int runs = soaked(16, 2);
  std::printf("NEES / 4 at updates of %d runs; RMS over the bound with q = %.1f, straight and turning; lost\n", runs,
              kBoundDensity);
  for (const Flight& flight : flights()) {
    std::printf("%-24s", flight.id.c_str());
    for (const int interval_s : kIntervals_s) {
      const Figures figures = fly(flight, interval_s, "EKF", runs);
      const double mean = figures.nees / figures.updates;
      std::printf("  %d s: %.2f %5.2f %5.2f %d", interval_s, mean, figures.straight.efficiency(),
                  figures.turning.efficiency(), figures.lost);
      EXPECT_GE(mean, 0.7) << flight.id << " " << interval_s;
      EXPECT_LE(mean, 1.5) << flight.id << " " << interval_s;
      EXPECT_EQ(figures.lost, 0) << flight.id << " " << interval_s;
    }
    std::printf("\n");
    std::fflush(stdout);
  }
}

// The three updates on the first flight of all.
TEST(RecordedFlights, EfficiencyOfEachUpdate) {
  const int runs = soaked(16, 2);
  const std::vector<Flight> all = flights();
  for (const char* update : {"EKF", "CONVERTED", "CUBATURE"}) {
    std::printf("%-10s RMS over the bound, straight and turning:", update);
    for (const int interval_s : kIntervals_s) {
      Figures sums;
      for (const Flight& flight : all) {
        const Figures figures = fly(flight, interval_s, update, std::max(1, runs / 8));
        sums.straight.squared_m2 += figures.straight.squared_m2;
        sums.straight.bound_m2 += figures.straight.bound_m2;
        sums.turning.squared_m2 += figures.turning.squared_m2;
        sums.turning.bound_m2 += figures.turning.bound_m2;
      }
      std::printf("  %d s: %.2f %.2f", interval_s, sums.straight.efficiency(), sums.turning.efficiency());
      EXPECT_GT(sums.straight.efficiency(), 0.5);  // no filter of the same looks is much under a bound that is one
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace dwell::testing
