#include "daemon/engine.hpp"

#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "daemon/config/policy_reader.hpp"
#include "tests/daemon/support.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"
#include "tracker/metrics/nees.hpp"

namespace dwell::testing {
namespace {

std::string published(const std::string& config, int scans) {
  RecordedRun recorded(config_of(config));
  recorded.scan(scans);
  return recorded.stream.bytes;
}

EngineConfig engine_config(const std::string& text) { return config_of(text).engine; }

std::string under(const std::string& policy) { return kBusy + "policy { " + policy + " {} }\n"; }

// --- determinism
// ----------------------------------------------------------------------------------------------

TEST(Engine, SameSeedGivesTheSameBytesAndAnotherSeedOthers) {
  for (const PolicyDescription& policy : describe_policies(3)) {
    const std::string config = under(policy.name);
    const std::string first = published(config, 300);
    EXPECT_TRUE(published(config, 300) == first) << policy.name;
    std::string other = config;
    other.replace(other.find("seed: 11"), 8, "seed: 12");
    EXPECT_FALSE(published(other, 300) == first) << policy.name;
  }
}

/// The plot that a look got from the target it was made for.
using LookKey = std::tuple<std::uint64_t, std::uint32_t, std::uint32_t>;  // scan, radar, track
std::map<LookKey, std::optional<Vector2>> plots_of_looks(const std::string& policy, int scans) {
  Engine engine(engine_config(under(policy)));
  std::map<LookKey, std::optional<Vector2>> looks;
  for (int i = 0; i < scans; ++i) {
    const ScanReport& report = engine.scan();
    for (const LookReport& look : report.looks) {
      std::optional<Vector2>& z = looks[{report.scan, look.dwell.radar.number, look.dwell.track.number}];
      for (std::size_t plot = look.first_plot; plot < look.first_plot + look.plots; ++plot) {
        // Tracks start with their targets, in order: track n is target n.
        if (report.plots[plot].source == TargetId{look.dwell.track.number}) z = report.plots[plot].z;
      }
    }
  }
  return looks;
}

TEST(Engine, SameLookGivesTheSamePlotUnderEveryPolicy) {
  constexpr int kScans = 150;
  const auto reference = plots_of_looks("round_robin", kScans);
  int compared = 0;
  for (const PolicyDescription& policy : describe_policies(3)) {
    for (const auto& [key, z] : plots_of_looks(policy.name, kScans)) {
      const auto same = reference.find(key);
      if (same == reference.end()) continue;
      EXPECT_EQ(same->second, z) << policy.name << ", scan " << std::get<0>(key);
      ++compared;
    }
  }
  EXPECT_GT(compared, kScans);
}

std::string with_budgets(std::string config) {
  const auto add = [&](const std::string& name, const std::string& budget) {
    config.insert(config.find("name: \"" + name + "\""), "budget { " + budget + " } ");
  };
  add("west", "looks: 3 window_s: 10");
  add("east", "looks: 5 horizon_s: 20 spread: FREE");
  return config;
}

/// At most 3 looks of the first radar in any 10 scans, 5 of the second in scans 1 .. 20, 21 .. 40, ..; the link is
/// never idle: the third radar is free.
TEST(Engine, BudgetsHoldUnderEveryPolicy) {
  for (const PolicyDescription& policy : describe_policies(3)) {
    SCOPED_TRACE(policy.name);
    Engine engine(engine_config(with_budgets(under(policy.name))));
    std::vector<int> west, east;
    for (int scan = 0; scan < 200; ++scan) {
      const ScanReport& report = engine.scan();
      ASSERT_EQ(report.looks.size(), 1U);
      west.push_back(report.looks[0].dwell.radar.number == 1 ? 1 : 0);
      east.push_back(report.looks[0].dwell.radar.number == 2 ? 1 : 0);
    }
    for (std::ptrdiff_t first = 0; first + 10 <= std::ssize(west); ++first) {
      ASSERT_LE(std::accumulate(west.begin() + first, west.begin() + first + 10, 0), 3) << "from scan " << first + 1;
    }
    for (std::ptrdiff_t first = 0; first < std::ssize(east); first += 20) {
      ASSERT_LE(std::accumulate(east.begin() + first, east.begin() + first + 20, 0), 5) << "from scan " << first + 1;
    }
  }
}

TEST(Engine, BudgetsAreToldToWhoeverAsks) {
  RecordedRun recorded(config_of(with_budgets(under("sa_imm"))));
  recorded.scan(30);
  v1::Request request;
  request.set_id("1");
  request.mutable_list_radars();
  const v1::RadarList list = recorded.run.handle(request).accepted().radar_list();
  EXPECT_EQ(list.radar(0).budget().looks(), 3U);
  EXPECT_LE(list.radar(0).budget().left(), 3U);
  EXPECT_EQ(list.radar(1).budget().looks(), 5U);
  EXPECT_FALSE(list.radar(2).has_budget());
  request.set_id("2");
  request.mutable_get_status();
  const int waiting = (list.radar(0).budget().due() ? 0 : 1) + (list.radar(1).budget().due() ? 0 : 1);
  EXPECT_EQ(static_cast<int>(recorded.run.handle(request).accepted().status().radars_over_budget()), waiting);
}

TEST(Engine, TruthIsTheSameUnderEveryPolicy) {
  Engine first(engine_config(under("fixed")));
  Engine second(engine_config(under("sa_imm")));
  for (int i = 0; i < 100; ++i) {
    (void)first.scan();
    (void)second.scan();
    ASSERT_EQ(first.last().truth.size(), second.last().truth.size());
    for (std::size_t t = 0; t < first.last().truth.size(); ++t) {
      EXPECT_EQ(first.last().truth[t].state, second.last().truth[t].state);
    }
  }
}

TEST(Engine, PolicyChangeKeepsTheTracks) {
  Engine changed(engine_config(under("sa_imm")));
  Engine kept(engine_config(under("sa_imm")));
  for (int i = 0; i < 10; ++i) (void)changed.scan(), (void)kept.scan();
  changed.set_policy(FixedSettings{2});
  for (std::size_t i = 0; i < kept.tracks().size(); ++i) {
    EXPECT_EQ(changed.tracks()[i].combined.mean, kept.tracks()[i].combined.mean);
  }
  EXPECT_EQ(changed.scan().looks[0].dwell.radar, RadarId{2});
}

// --- how tracks start
// -----------------------------------------------------------------------------------------

std::string many_targets(int count, const std::string& fields) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    text += "target { name: \"" + std::to_string(i) + "\" x_m: " + std::to_string(100 * i) + " y_m: 30e3 vx_mps: 20 " +
            fields + " }\n";
  }
  return text;
}

TEST(Engine, TracksStartAtTimeZeroAroundTheTruth) {
  constexpr int kTargets = 500;
  const std::string config =
      "radar { name: \"r\" }\n" + many_targets(kTargets,
                                               "start { covariance: [9e4, 0, 100, 0,  0, 400, 0, 0,"
                                               "  100, 0, 1e4, 0,  0, 0, 0, 2500] }");
  const Engine engine(engine_config(config));
  ASSERT_EQ(engine.tracks().size(), kTargets);
  double sum = 0.0;
  for (const Track& track : engine.tracks()) {
    EXPECT_EQ(track.id.number, std::stoul(track.name) + 1);
    EXPECT_EQ(track.age_scans, 0);
    EXPECT_EQ(track.status, TrackStatus::kConfirmed);
    EXPECT_FALSE(track.last_look);
    const State truth = make_state({100.0 * std::stod(track.name), 30e3}, {20.0, 0.0});
    sum += nees(truth, track.combined);
  }
  const statistics::Band band = statistics::chi_square_band(4.0 * kTargets);
  EXPECT_TRUE(band.contains(sum)) << sum;
  EXPECT_FALSE(band.contains(1.5 * sum)) << "the check sees a variance 1.5 times too large";
}

TEST(Engine, LaterTargetGetsItsTrackAtItsFirstScan) {
  Engine engine(
      engine_config("radar { name: \"r\" }\ntarget { name: \"a\" y_m: 9e3 }\n"
                    "target { name: \"b\" y_m: 8e3 start_s: 3 }\n"));
  for (std::uint64_t scan = 1; scan <= 5; ++scan) {
    (void)engine.scan();
    ASSERT_EQ(engine.tracks().size(), scan < 3 ? 1 : 2) << scan;
    EXPECT_EQ(engine.tracks().back().age_scans, scan < 3 ? static_cast<int>(scan) : static_cast<int>(scan) - 3);
  }
}

/// A target waits for its first plot: detected with P_d at each scan, the share of targets that have a track
/// after the instants t = 0 .. k is 1 - (1 - P_d)^(k + 1).
TEST(Engine, ShareOfFirstPlotStartsIsThatOfTheDetections) {
  const int targets = scaled(1000);
  Engine engine(engine_config("radar { name: \"r\" detection_probability: 0.3 }\n" +
                              many_targets(targets, "start { first_plot {} }")));
  for (int k = 0; k <= 5; ++k) {
    const double share = 1.0 - std::pow(0.7, k + 1);
    const auto started = static_cast<double>(engine.tracks().size());
    EXPECT_TRUE(statistics::binomial_band(targets, share).contains(started)) << started << " at t = " << k;
    (void)engine.scan();
  }
}

TEST(Engine, FirstPlotStartIsConsistentInPosition) {
  const int targets = scaled(1000);
  const Engine engine(engine_config("radar { name: \"r\" azimuth_noise_floor_deg: 0.1 range_noise_floor_m: 30 }\n" +
                                    many_targets(targets, "start { first_plot { speed_sigma_mps: 70 } }")));
  ASSERT_EQ(std::ssize(engine.tracks()), targets);
  double sum = 0.0;
  for (const Track& track : engine.tracks()) {
    sum += position_nees(make_state({100.0 * std::stod(track.name), 30e3}, {20.0, 0.0}), track.combined);
    EXPECT_EQ(velocity(track.combined.mean), Vector2::Zero());
    EXPECT_EQ(track.combined.covariance(kVx, kVx), 4900.0);
  }
  EXPECT_TRUE(statistics::chi_square_band(2.0 * targets).contains(sum)) << sum;
}

TEST(Engine, FirstPlotStartNeedsARadarThatIsUp) {
  Engine engine(engine_config("radar { name: \"r\" down: true }\n" + many_targets(3, "start { first_plot {} }")));
  for (int i = 0; i < 5; ++i) (void)engine.scan();
  EXPECT_TRUE(engine.tracks().empty());
  engine.set_sensor(0, true);
  (void)engine.scan();
  EXPECT_EQ(engine.tracks().size(), 3);
}

// --- how tracks end
// -------------------------------------------------------------------------------------------

TEST(Engine, TruthFarFromThePredictionAtFiveDetectedLooksLosesTheTrack) {
  // Every look is far by this rule; nothing is ever lost by the other.
  Engine engine(
      engine_config("radar { name: \"r\" detection_probability: 0.6 }\ntarget { name: \"t\" y_m: 30e3 }\n"
                    "tracker { lost_squared_distance: 1e-12 gate: inf lost_probability: 1e-300 }\n"));
  int detected = 0;
  while (detected < 5) {
    ASSERT_EQ(engine.tracks().size(), 1) << detected;
    ASSERT_TRUE(engine.tracks()[0].alive()) << detected;
    detected += engine.scan().looks[0].plots > 0 ? 1 : 0;
  }
  EXPECT_EQ(engine.tracks()[0].loss, LossCause::kFromTruth);
  EXPECT_EQ(engine.counts().tracks_lost, 1);
  EXPECT_TRUE(engine.last().truth.empty()) << "of living tracks";
  (void)engine.scan();
  EXPECT_TRUE(engine.tracks().empty()) << "told once; a cued track that is lost stays lost";
  EXPECT_EQ(engine.counts().tracks_lost, 1);
}

TEST(Engine, NearLookEndsTheRunOfFarOnes) {
  // A filter that matches its target: squared distances are chi-square with 2 degrees of freedom, 61 % of
  // them over 1. Five in a row happen to some tracks, a near one among them saves others.
  int outlived = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    Engine engine(engine_config("seed: " + std::to_string(seed) +
                                " radar { name: \"r\" }\ntarget { name: \"t\" y_m: 30e3 }\n"
                                "tracker { bank { mode { name: \"m\" } } lost_squared_distance: 1 gate: inf }\n"));
    for (int i = 0; i < 5; ++i) (void)engine.scan();
    outlived += engine.tracks()[0].alive() ? 1 : 0;
  }
  EXPECT_GT(outlived, 0);
  EXPECT_LT(outlived, 40);
}

/// Ten seconds of target, then eight looks without a plot at P_d = .9: 1e-8 < 3e-8.
TEST(Engine, TrackIsDroppedAfterItsTargetHasEnded) {
  Engine engine(
      engine_config("radar { name: \"r\" detection_probability: 0.9 }\n"
                    "target { name: \"t\" y_m: 30e3 duration_s: 10 }\ntracker { lost_probability: 3e-8 }\n"));
  while (engine.counts().tracks_dropped == 0) {
    (void)engine.scan();
    ASSERT_LE(engine.last().scan, 18);
    EXPECT_EQ(engine.last().truth.size(), engine.last().scan <= 10 ? 1 : 0);
  }
  // A miss of the live target before scan 11 counts too.
  EXPECT_GE(engine.last().scan, 16);
  EXPECT_EQ(engine.tracks()[0].loss, LossCause::kNoPlots);
  EXPECT_EQ(engine.counts().tracks_lost, 0);
  EXPECT_EQ(engine.counts().filter_failures, 0);
}

TEST(Engine, RepeatOfARecordingIsANewTrack) {
  TemporaryDirectory directory;
  write_file(directory / "f.csv",
             "time_s,lat,lon,alt_m,id\n0,52,5,100,a\n1,52.1,5,100,a\n2,52.2,5,100,a\n3,52.3,5,100,a\n");
  const DaemonConfig config = read_config_text(
      "radar { name: \"r\" y_m: -20e3 }\ntarget { name: \"t\" recording { file: \"f.csv\" repeat: true } }", "test",
      directory.path());
  Engine engine(config.engine);
  std::map<std::uint32_t, std::string> names;
  std::set<std::uint32_t> lost;
  for (int i = 0; i < 60; ++i) {
    (void)engine.scan();
    for (const Track& track : engine.tracks()) {
      EXPECT_FALSE(lost.contains(track.id.number)) << "the last message of an id";
      names[track.id.number] = track.name;
      if (!track.alive()) lost.insert(track.id.number);
    }
  }
  // A life of three seconds starts every four: at t = 0, 4, 8, ...
  ASSERT_EQ(names.size(), 16);
  EXPECT_EQ(names[1], "t");
  for (std::uint32_t life = 2; life <= 16; ++life) EXPECT_EQ(names[life], "t#" + std::to_string(life));
  EXPECT_GT(engine.counts().tracks_dropped, 0);
  EXPECT_EQ(engine.counts().tracks_lost, 0);
}

// --- looks
// ----------------------------------------------------------------------------------------------------

TEST(Engine, LooksOfAScanAreOfDifferentRadarsAndTracks) {
  const std::string config = kBusy + "target { name: \"three\" x_m: 5e3 y_m: 40e3 }\n";
  for (const PolicyDescription& policy : describe_policies(3)) {
    for (std::size_t looks = 1; looks <= 3; ++looks) {
      Engine engine(
          engine_config(config + "looks_per_scan: " + std::to_string(looks) + "\npolicy { " + policy.name + " {} }"));
      for (int i = 0; i < 50; ++i) {
        const ScanReport& report = engine.scan();
        std::set<std::uint32_t> radars, tracks;
        for (const LookReport& look : report.looks) {
          radars.insert(look.dwell.radar.number);
          tracks.insert(look.dwell.track.number);
        }
        EXPECT_EQ(report.looks.size(), looks);
        EXPECT_EQ(radars.size(), looks);
        EXPECT_EQ(tracks.size(), looks);
      }
    }
  }
}

TEST(Engine, FewerTracksThanLooksGiveALookEach) {
  Engine engine(engine_config(kBusy + "looks_per_scan: 3"));
  EXPECT_EQ(engine.scan().looks.size(), 2);
}

TEST(Engine, AllRadarsDownIsNoLookAndTheTracksArePredictedOn) {
  for (const PolicyDescription& policy : describe_policies(3)) {
    Engine engine(engine_config(under(policy.name)));
    for (int i = 0; i < 10; ++i) (void)engine.scan();
    for (std::size_t sensor = 0; sensor < 3; ++sensor) engine.set_sensor(sensor, false);
    double variance = 0.0;
    for (int i = 0; i < 100; ++i) {
      const ScanReport& report = engine.scan();
      EXPECT_EQ(engine.tracks()[0].status, TrackStatus::kCoasting);
      EXPECT_TRUE(report.decision.candidates.empty());
      EXPECT_TRUE(report.looks.empty());
      EXPECT_TRUE(report.plots.empty());
      EXPECT_FALSE(report.decision.margin);
      ASSERT_EQ(engine.tracks().size(), 2);
      const double now = engine.tracks()[0].combined.covariance.trace();
      EXPECT_GT(now, variance);
      variance = now;
    }
    engine.set_sensor(1, true);
    const ScanReport& report = engine.scan();
    ASSERT_EQ(report.looks.size(), 1);
    EXPECT_EQ(report.looks[0].dwell.radar, RadarId{2});
  }
}

/// Nobody can look: the track coasts until its position is unknown, then it is given up.
TEST(Engine, TrackThatNobodyReachesIsGivenUp) {
  Engine engine(
      engine_config("radar { name: \"near\" max_range_m: 50e3 }\n"
                    "target { name: \"out\" y_m: 49e3 vy_mps: 300 }\ntracker { lost_sigma_m: 5e3 }\n"));
  double sigma_m = 0.0;
  while (!engine.tracks().empty() && engine.tracks()[0].alive()) {
    ASSERT_LT(engine.last().scan, 1000);
    sigma_m = std::sqrt(position_block(engine.tracks()[0].combined.covariance).trace());
    (void)engine.scan();
  }
  ASSERT_EQ(engine.tracks().size(), 1);
  EXPECT_EQ(engine.tracks()[0].loss, LossCause::kUncertain);
  EXPECT_LE(sigma_m, 5e3);
  EXPECT_EQ(engine.counts().tracks_lost, 1);
}

TEST(Engine, OnlyCoveredPairsAreFeasible) {
  Engine engine(
      engine_config("radar { name: \"near\" max_range_m: 20e3 }\nradar { name: \"far\" }\n"
                    "radar { name: \"west\" sector_centre_deg: 270 sector_width_deg: 90 }\n"
                    "target { name: \"t\" y_m: 30e3 }"));
  const ScanReport& report = engine.scan();
  ASSERT_EQ(report.decision.candidates.size(), 1);
  EXPECT_EQ(report.decision.candidates[0].pair.sensor, 1);
}

TEST(Engine, ShareOfLooksWithAPlotIsTheDetectionProbability) {
  const int looks = scaled(4000);
  Engine engine(
      engine_config("radar { name: \"r\" detection_probability: 0.8 }\ntarget { name: \"t\" y_m: 30e3 }\n"
                    "tracker { gate: inf lost_probability: 1e-300 lost_squared_distance: inf }\n"));
  for (int i = 0; i < looks; ++i) {
    const bool seen = engine.scan().looks[0].used_plot.has_value();
    EXPECT_EQ(engine.tracks()[0].status, seen ? TrackStatus::kConfirmed : TrackStatus::kCoasting);
  }
  EXPECT_EQ(engine.counts().looks[0], static_cast<std::uint64_t>(looks));
  const auto detections = static_cast<double>(engine.counts().detections[0]);
  EXPECT_TRUE(statistics::binomial_band(looks, 0.8).contains(detections)) << detections;
}

TEST(Engine, TargetOverTheRadarIsNoFailure) {
  for (const char* update : {"EKF", "CONVERTED"}) {
    Engine engine(
        engine_config("radar { name: \"r\" }\ntarget { name: \"t\" }\n"
                      "tracker { update: " +
                      std::string(update) + " }"));
    for (int i = 0; i < 100; ++i) {
      (void)engine.scan();
      for (const Track& track : engine.tracks()) EXPECT_TRUE(track.combined.mean.allFinite());
    }
  }
}

}  // namespace
}  // namespace dwell::testing
