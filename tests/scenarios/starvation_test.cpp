// How long a track may go without a look.
//
// Among T tracks that differ in nothing but when they were looked at last, and whose gain grows with that age, a policy
// that takes the largest gain takes the oldest: each track waits T - 1 scans, no more. `random` gives each a share of
// 1 / T by symmetry: it waits longer than a with probability (1 - 1 / T)^a.
//
// Among tracks that differ there is no such number: how often a track is worth a look is what a policy decides. There
// the bound is that a look still finds the target, however long it had to wait: three sigmas of every track inside the
// footprint of a dwell, and no track lost.
//
// Criteria that stop growing with the age would starve tracks: `bhattacharyya` and sa_imm with cost = none look where
// modes can be told apart, which an old track's may not be. For them, as for every other, there is max_wait_turns: a
// track that has waited for n turns of T scans is next, and others that have waited as long may go before it.

#include <cmath>
#include <cstdio>
#include <map>

#include <gtest/gtest.h>

#include "daemon/config/config_reader.hpp"
#include "daemon/config/policy_reader.hpp"
#include "tests/scale.hpp"
#include "tests/scenarios/monte_carlo.hpp"

namespace dwell::testing {
namespace {

constexpr int kTracks = 5;
constexpr int kStrangers = 6;

struct Waits {
  std::uint64_t longest = 0;  // scans of a living track without a look
  double largest_sigma_m = 0.0;
  std::uint64_t lost = 0;
};

Waits waits_under(const std::string& text, std::uint64_t scans) {
  Engine engine(read_config_text(text, "starvation", ".").engine);
  std::map<std::uint32_t, std::uint64_t> last_look;
  Waits waits;
  while (engine.last().scan < scans) {
    const ScanReport& report = engine.scan();
    for (const LookReport& look : report.looks) last_look[look.dwell.track.number] = report.scan;
    for (const Track& track : engine.tracks()) {
      if (!track.alive()) continue;
      waits.longest = std::max(waits.longest, report.scan - last_look[track.id.number]);
      const Matrix2 block = position_block(track.combined.covariance);
      waits.largest_sigma_m = std::max(waits.largest_sigma_m, std::sqrt(block.trace()));
    }
  }
  waits.lost = engine.counts().tracks_lost;
  return waits;
}

struct PolicyCase {
  std::string name;
  std::string text;
};

/// Targets that differ in their names alone, one sensor.
std::string twins(const std::string& policy) {
  std::string text = R"(
linear_sensor { name: "only" c: [1,0,0,0, 0,0,1,0] r: [100,0,0,100] }
tracker { bank { mode { name: "cv" process_noise { white_noise_acceleration: 10 } } } gate: inf lost_squared_distance: inf lost_sigma_m: inf }
)";
  for (int i = 1; i <= kTracks; ++i) {
    text += "target { name: \"" + std::to_string(i) +
            "\" jump_markov { bank { mode { name: \"cv\" process_noise { white_noise_acceleration: 10 } } } } }\n";
  }
  return text + "policy { " + policy + " }\n";
}

/// Six targets that turn at random within 50 km of each other, three radars that do not see them equally well.
std::string strangers(const std::string& policy) {
  std::string text = R"(
radar { name: "west" x_m: -60e3 }
radar { name: "east" x_m: 60e3 detection_probability: 0.8 }
radar { name: "south" y_m: -60e3 beamwidth_deg: 0.3 detection_probability: 0.9 }
tracker { lost_squared_distance: inf lost_sigma_m: inf }
)";
  RandomStream random(8);
  for (int i = 1; i <= kStrangers; ++i) {
    const auto number = [&](double limit) { return std::to_string(random.uniform(-limit, limit)); };
    text += "target { name: \"" + std::to_string(i) + "\" x_m: " + number(30e3) + " y_m: " + number(30e3) +
            " vx_mps: " + number(200) + " vy_mps: " + number(200) + " jump_markov { area { radius_m: 50e3 } } }\n";
  }
  return text + "policy { " + policy + " }\n";
}

bool saturates(const PolicyCase& policy) { return policy.name == "bhattacharyya" || policy.name == "modes alone"; }

/// Every policy at its defaults, and the one of them that can be told to ask for modes alone.
std::vector<PolicyCase> policies(int sensors) {
  std::vector<PolicyCase> cases;
  for (const PolicyDescription& policy : describe_policies(sensors))
    cases.push_back({policy.name, policy.name + " {}"});
  cases.push_back({"modes alone", "sa_imm { cost: NONE beta: 1 }"});
  return cases;
}

std::uint64_t longest_wait(int tracks) {
  const auto turns = static_cast<std::uint64_t>(EngineConfig{}.max_wait_turns);
  return turns * static_cast<std::uint64_t>(tracks) + static_cast<std::uint64_t>(tracks);
}

TEST(Starvation, OfTracksThatDifferInNothingNoneWaitsLongerThanATurn) {
  constexpr std::uint64_t kScans = 300;
  for (const PolicyCase& policy : policies(1)) {
    const Waits waits = waits_under(twins(policy.text), kScans);
    std::printf("  %-18s %3d scans\n", policy.name.c_str(), static_cast<int>(waits.longest));
    if (policy.name == "random") {
      // One in a million over all tracks and scans.
      const double limit = std::log(1e-6 / (kTracks * kScans)) / std::log(1.0 - 1.0 / kTracks);
      EXPECT_LE(static_cast<double>(waits.longest), limit);
    } else if (saturates(policy)) {
      EXPECT_LE(waits.longest, longest_wait(kTracks)) << policy.name;
    } else {
      EXPECT_LE(waits.longest, kTracks - 1U) << policy.name;
    }
  }
}

TEST(Starvation, OfTracksThatDifferNoneWaitsLongerThanItMay) {
  for (const PolicyCase& policy : policies(3)) {
    const Waits waits = waits_under(strangers(policy.text), 300);
    std::printf("  %-18s %4d scans, sigma to %7.0f m, %d lost\n", policy.name.c_str(), static_cast<int>(waits.longest),
                waits.largest_sigma_m, static_cast<int>(waits.lost));
    EXPECT_LE(waits.longest, longest_wait(kStrangers)) << policy.name;
    if (saturates(policy)) continue;
    EXPECT_LE(3.0 * waits.largest_sigma_m, 10e3) << policy.name;  // a look still finds it
    EXPECT_EQ(waits.lost, 0U) << policy.name;
  }
}

}  // namespace
}  // namespace dwell::testing
