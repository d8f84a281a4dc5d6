#include <algorithm>

#include "tests/daemon/support.hpp"

namespace dwell::testing {
namespace {

/// 20 m and .1 deg, 20 km away; 2 false plots in a surveillance look on average.
std::string surveyed(const std::string& target, const std::string& more) {
  return "radar { name: \"r\" max_range_m: 40e3 detection_probability: 0.9 range_noise_floor_m: 20 "
         "azimuth_noise_floor_deg: 0.1 clutter_density: 1e-5 surveillance { period_s: 2 } }\n"
         "target { name: \"t\" y_m: 20e3 vx_mps: 200 " +
         target + " }\n" + more;
}

TEST(Surveillance, FindsATargetThatNobodyAnnounced) {
  for (const char* association : {"NEAREST", "PDA", "IPDA", "JPDA"}) {
    SCOPED_TRACE(association);
    const std::string text =
        surveyed("start { none {} }", std::string("tracker { association: ") + association + " }\n");
    Engine engine(config_of(text).engine);
    EXPECT_TRUE(engine.tracks().empty());
    while (engine.last().scan < 60 && engine.tracks().empty()) engine.scan();
    ASSERT_EQ(engine.tracks().size(), 1U);
    EXPECT_EQ(engine.tracks()[0].name, "t");
    EXPECT_EQ(engine.counts().tracks_initiated, 1U);
    EXPECT_EQ(engine.counts().tracks_false, 0U);
    ASSERT_EQ(engine.last().truth.size(), 1U);
    EXPECT_LT((position(engine.tracks()[0].combined.mean) - position(engine.last().truth[0].state)).norm(), 200.0);
    engine.scan();
    ASSERT_EQ(engine.last().looks.size(), 1U) << "a confirmed track is looked at";
  }
}

// The dwells' own streams are not shifted: a cued track sees the same plots with surveillance and without.
TEST(Surveillance, LeavesTheDwellsAsTheyAre) {
  const std::string with = surveyed("", "");
  std::string without = with;
  without.erase(without.find("surveillance { period_s: 2 }"), std::string("surveillance { period_s: 2 }").size());
  Engine one(config_of(with).engine);
  Engine other(config_of(without).engine);
  for (int scan = 0; scan < 100; ++scan) {
    one.scan();
    other.scan();
    ASSERT_FALSE(one.tracks().empty());
    EXPECT_EQ(one.tracks()[0].combined.mean, other.tracks()[0].combined.mean);
  }
  EXPECT_EQ(one.counts().tracks_initiated, 0U) << "the plots of a confirmed track are withheld";
}

// A jump of 2.8 km in 4 s out of a footprint of 500 m: the track dies, and surveillance finds the target again.
TEST(Surveillance, FindsALostTargetAgain) {
  std::string text = surveyed("start { covariance: [1, 1, 1, 1] }", "tracker { association: IPDA }\n");
  text.insert(text.find("max_range_m"), "dwell_range_m: 500 dwell_azimuth_deg: 0.5 ");
  EngineConfig config = config_of(text).engine;
  auto& script = std::get<ScriptedMotion>(config.targets[0].motion);
  script.legs.push_back({kStreamStart + from_seconds(10.0), kStreamStart + from_seconds(12.0), {0.0, 700.0}, 0.0, 1.0});
  script.legs.push_back(
      {kStreamStart + from_seconds(12.0), kStreamStart + from_seconds(14.0), {0.0, -700.0}, 0.0, 1.0});
  Engine engine(config);
  bool lost = false;
  for (int scan = 0; scan < 80; ++scan) {
    engine.scan();
    lost =
        lost || std::any_of(engine.tracks().begin(), engine.tracks().end(), [](const Track& t) { return !t.alive(); });
  }
  EXPECT_TRUE(lost);
  EXPECT_EQ(engine.counts().tracks_initiated, 1U);
  ASSERT_EQ(engine.last().truth.size(), 1U);
  EXPECT_LT((position(engine.tracks().back().combined.mean) - position(engine.last().truth[0].state)).norm(), 200.0);
}

TEST(Surveillance, SameSeedGivesTheSameBytes) {
  const std::string text = surveyed("start { none {} }", "tracker { association: JPDA }\n");
  RecordedRun one(config_of(text));
  RecordedRun other(config_of(text));
  one.scan(100);
  other.scan(100);
  EXPECT_TRUE(one.stream.bytes == other.stream.bytes);
}

TEST(Surveillance, ConfigSaysWhatItNeeds) {
  const auto rule = [](const std::string& text) {
    const auto violations = violations_of(text);
    return violations.empty() ? std::string() : violations[0].field + ": " + violations[0].rule;
  };
  EXPECT_EQ(rule("radar { name: \"r\" surveillance { period_s: 1 } }\ntarget { name: \"t\" }"),
            "radar[1].surveillance.period_s: needs a radar with a finite max_range_m");
  EXPECT_EQ(rule("radar { name: \"r\" max_range_m: 1e5 surveillance { period_s: 1.5 } }\ntarget { name: \"t\" }"),
            "radar[1].surveillance.period_s: must be a whole number of scan periods");
  EXPECT_EQ(rule("radar { name: \"r\" }\ntarget { name: \"t\" start { none {} } }"),
            "target[1].start.none: needs a radar with surveillance, which finds the target");
  EXPECT_EQ(rule("radar { name: \"r\" }\ntarget { name: \"t\" }\ntracker { existence { confirm: 0.9 } }"),
            "tracker.existence: is of the associations IPDA, ITS and JPDA");
}

}  // namespace
}  // namespace dwell::testing
