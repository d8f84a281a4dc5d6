// Recorded flights: 20 seeds, 1800 scans, one look a second in all, shared by three or by six aircraft.

#include <array>
#include <cstdio>
#include <map>

#include <gtest/gtest.h>

#include "tests/scenarios/monte_carlo.hpp"
#include "tracker/metrics/nees.hpp"

namespace dwell::testing {
namespace {

constexpr int kSeeds = 20;
constexpr std::uint64_t kScans = 1800;

struct Flight {
  double squared_error = 0.0;  // of position, summed over scans
  double scans = 0.0;
  double nees = 0.0;  // of the whole state, summed over updates
  double updates = 0.0;

  double rms_m() const { return std::sqrt(squared_error / scans); }
  double nees_per_dimension() const { return nees / kStateSize / updates; }
};

struct Result {
  std::map<std::string, Flight> flights;
  Flight all;
  std::uint64_t lost = 0;
};

void add(const Engine& engine, const TruthReport& truth, const Track& track, Flight& flight) {
  flight.squared_error += (position(truth.state) - position(track.combined.mean)).squaredNorm();
  flight.scans += 1.0;
  for (const LookReport& look : engine.last().looks) {
    if (look.dwell.track != track.id || !look.used_plot) continue;
    flight.nees += nees(truth.state, track.combined);
    flight.updates += 1.0;
  }
}

Result run(const std::string& name, const PolicySettings& policy) {
  EngineConfig config = scenario(name, policy);
  Result result;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    config.seed = static_cast<std::uint64_t>(seed);
    Engine engine(config);
    while (engine.last().scan < kScans) {
      engine.scan();
      for (const TruthReport& truth : engine.last().truth) {
        for (const Track& track : engine.tracks()) {
          if (track.id != truth.track) continue;
          add(engine, truth, track, result.flights[track.name]);
          add(engine, truth, track, result.all);
        }
      }
    }
    result.lost += engine.counts().tracks_lost;
  }
  return result;
}

void print(const std::string& scenario, const char* policy, const Result& result) {
  std::printf("%s, %s: position RMS %.1f m, NEES/4 %.2f, tracks lost %llu\n", scenario.c_str(), policy,
              result.all.rms_m(), result.all.nees_per_dimension(), static_cast<unsigned long long>(result.lost));
  for (const auto& [name, flight] : result.flights) {
    std::printf("  %-22s %7.1f m  NEES/4 %.2f\n", name.c_str(), flight.rms_m(), flight.nees_per_dimension());
  }
}

class Recorded : public ::testing::TestWithParam<const char*> {};

TEST_P(Recorded, SaImmLosesNoTrackAndIsAFifthBetterThanRoundRobin) {
  const Result sa_imm = run(GetParam(), SaImmSettings{});
  const Result round_robin = run(GetParam(), RoundRobinSettings{});
  print(GetParam(), "sa_imm", sa_imm);
  print(GetParam(), "round_robin", round_robin);
  EXPECT_EQ(sa_imm.lost, 0U);
  EXPECT_LE(sa_imm.all.rms_m(), 0.8 * round_robin.all.rms_m());
}

INSTANTIATE_TEST_SUITE_P(Scenarios, Recorded, ::testing::Values("recorded_flights", "recorded_six"));

}  // namespace
}  // namespace dwell::testing
