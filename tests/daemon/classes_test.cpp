// What a target is: config, simulation, belief and what it changes in the choice.

#include <algorithm>
#include <map>

#include "tests/daemon/support.hpp"
#include "tests/statistics.hpp"

namespace dwell::testing {
namespace {

const std::string kTwo = "class { name: \"calm\" prior: 0.7 } class { name: \"threat\" prior: 0.3 weight: 16 } ";
const std::string kEmission = "emission: [0.8, 0.2, 0.3, 0.7] ";

std::string classes(const std::string& more = "") { return "classes { " + kTwo + more + "}\n"; }

/// kBusy with classes, declared by all its radars.
std::string busy(const std::string& more = "", const std::string& emission = kEmission) {
  std::string text = kBusy;
  for (std::size_t at = text.find("radar {"); at != std::string::npos; at = text.find("radar {", at + 1)) {
    text.insert(at + 7, " " + emission);
  }
  return text + classes(more);
}

void expect_refusal(const std::string& text, const std::string& field, const std::string& value,
                    const std::string& rule) {
  SCOPED_TRACE(text + refusal_of(text));
  const auto violations = violations_of(text);
  ASSERT_EQ(violations.size(), 1U);
  EXPECT_EQ(violations[0].field, field);
  EXPECT_EQ(violations[0].value, value);
  EXPECT_EQ(violations[0].rule, rule);
}

TEST(Classes, ConfigErrorsNameTheKey) {
  const auto scenario = [](const std::string& radar, const std::string& target, const std::string& more) {
    return "radar { name: \"r\" " + radar + "}\ntarget { name: \"t\" y_m: 50e3 " + target + "}\n" + more;
  };
  const std::string sums = "rows must sum to 1";
  expect_refusal(scenario("emission: [0.8, 0.2, 0.3, 0.6] ", "", classes()), "radar[1].emission", "row 2 sums to 0.9",
                 sums);
  expect_refusal(scenario("", "", classes("transition: [1, 0, 0.5, 0.6] ")), "classes.transition", "row 2 sums to 1.1",
                 sums);
  expect_refusal(scenario("emission: [1, 0, 0] ", "", classes()), "radar[1].emission", "3 values",
                 "must have 4 values");
  expect_refusal(scenario(kEmission, "", ""), "radar[1].emission", "4 values", "needs classes");
  expect_refusal(scenario("", "class: \"calm\" ", ""), "target[1].class", "\"calm\"", "needs classes");
  expect_refusal(scenario("", "class: \"call\" ", classes()), "target[1].class", "\"call\"",
                 "must be one of: calm, threat");
  expect_refusal(scenario("", "", "classes { class { name: \"calm\" } }"), "classes.class", "1 classes",
                 "must be from 2 to 16");
  expect_refusal(scenario("", "", "classes { class { name: \"a\" } class { name: \"a\" } }"), "classes.class[2].name",
                 "\"a\"", "must be unique among the classes");
  expect_refusal(scenario("", "", "classes { class { name: \"a\" } class { name: \"b\" prior: 0.2 } }"),
                 "classes.class", "priors sum to 0.7", "priors must sum to 1");
  expect_refusal(scenario("", "", "policy { gittins_hmm {} }"), "policy.gittins_hmm", "", "needs classes of targets");
  EXPECT_EQ(refusal_of(scenario(kEmission, "class: \"calm\" ", classes() + "policy { gittins_hmm {} }")), "");
}

TEST(Classes, PolicyThatNeedsThemIsRefusedWithout) {
  v1::Request request;
  request.set_id("1");
  request.mutable_set_policy()->set_text("gittins_hmm");
  RecordedRun without(config_of(kBusy));
  const v1::Reply refused = without.run.handle(request);
  ASSERT_TRUE(refused.has_refused());
  EXPECT_EQ(refused.refused().reason(), v1::Refused::INVALID);
  EXPECT_EQ(refused.refused().violation(0).field(), "gittins_hmm");
  EXPECT_EQ(refused.refused().violation(0).rule(), "needs classes of targets");
  RecordedRun with(config_of(busy()));
  EXPECT_TRUE(with.run.handle(request).has_accepted());
  with.scan(3);
  EXPECT_EQ(with.run.engine().last().policy, "gittins_hmm");
}

TEST(Classes, EffectiveConfigReadsBackTheSame) {
  const DaemonConfig once = config_of(busy());
  const DaemonConfig again = read_config(once.effective, "effective", kScenarios);
  EXPECT_EQ(once.effective.SerializeAsString(), again.effective.SerializeAsString());
  RecordedRun first(once);
  RecordedRun second(again);
  first.scan(30);
  second.scan(30);
  EXPECT_EQ(first.stream.bytes, second.stream.bytes);
}

TEST(Classes, WithoutThemTheStreamSaysNothingOfThem) {
  RecordedRun recorded(config_of(kBusy));
  recorded.scan(30);
  for (const v1::Envelope& envelope : recorded.stream.envelopes) {
    EXPECT_EQ(envelope.track().class_belief_size(), 0);
    EXPECT_FALSE(envelope.track().has_weight());
    EXPECT_FALSE(envelope.plot().has_declared_class());
    for (const v1::Candidate& candidate : envelope.scan_report().candidate()) EXPECT_FALSE(candidate.has_weight());
    for (const v1::Truth& truth : envelope.scan_report().truth()) EXPECT_FALSE(truth.has_target_class());
  }
}

/// Declarations are drawn beside what was drawn before: where they say nothing, plots and tracks are the same bit for
/// bit.
TEST(Classes, LeaveWhatWasDrawnAsItWas) {
  const std::string turns = "policy { round_robin {} }\n";
  RecordedRun without(config_of(kBusy + turns));
  RecordedRun with(config_of(busy("", "emission: [0.5, 0.5, 0.5, 0.5] ") + turns));
  without.scan(100);
  with.scan(100);
  ASSERT_EQ(without.stream.topics, with.stream.topics);
  int declared = 0;
  for (std::size_t i = 0; i < with.stream.envelopes.size(); ++i) {
    v1::Envelope same = with.stream.envelopes[i];
    if (same.has_plot()) {
      declared += same.plot().has_declared_class() ? 1 : 0;
      same.mutable_plot()->clear_declared_class();
    } else if (same.has_track()) {
      same.mutable_track()->clear_class_belief();
      same.mutable_track()->clear_weight();
    } else if (same.has_scan_report()) {
      continue;  // its costs are weighted
    }
    EXPECT_EQ(same.SerializeAsString(), without.stream.envelopes[i].SerializeAsString());
  }
  EXPECT_EQ(declared, std::ranges::count(with.stream.topics, "plot."));
}

TEST(Classes, StreamHasBeliefWeightAndTruth) {
  RecordedRun recorded(config_of(busy()));
  recorded.scan(60);
  bool learned = false;
  for (const v1::Envelope& envelope : recorded.stream.envelopes) {
    if (envelope.has_track()) {
      const auto& belief = envelope.track().class_belief();
      ASSERT_EQ(belief.size(), 2);
      EXPECT_NEAR(belief[0] + belief[1], 1.0, 1e-14);
      EXPECT_NEAR(envelope.track().weight(), belief[0] + 16.0 * belief[1], 1e-13);
      learned = learned || std::max(belief[0], belief[1]) > 0.95;
    }
    for (const v1::Candidate& candidate : envelope.scan_report().candidate()) EXPECT_GE(candidate.weight(), 1.0);
    for (const v1::Truth& truth : envelope.scan_report().truth()) {
      EXPECT_TRUE(truth.target_class() == 1 || truth.target_class() == 2);
    }
  }
  EXPECT_TRUE(learned);
  v1::Request request;
  request.set_id("1");
  request.mutable_get_snapshot();
  const v1::Snapshot snapshot = recorded.run.handle(request).accepted().snapshot();
  ASSERT_EQ(snapshot.class_name_size(), 2);
  EXPECT_EQ(snapshot.class_name(1), "threat");
}

/// An intent moves when it is looked at, and at no other time; the belief likewise.
TEST(Classes, MoveOnlyWhenLookedAt) {
  EngineConfig config = config_of(busy("transition: [0.7, 0.3, 0.4, 0.6] ")).engine;
  Engine engine(config);
  std::map<std::uint32_t, int> was;
  std::map<std::uint32_t, Eigen::VectorXd> believed;
  int moves = 0;
  for (int scan = 0; scan < 200; ++scan) {
    engine.scan();
    for (const TruthReport& truth : engine.last().truth) {
      const auto track = std::ranges::find_if(engine.tracks(), [&](const Track& t) { return t.id == truth.track; });
      const bool looked = engine.last().looks.front().dwell.track == truth.track;
      const auto last = was.find(truth.track.number);
      if (last != was.end() && !looked) {
        EXPECT_EQ(last->second, *truth.target_class);
        EXPECT_EQ(believed[truth.track.number], track->class_belief);
      } else if (last != was.end()) {
        moves += last->second != *truth.target_class ? 1 : 0;
      }
      was[truth.track.number] = *truth.target_class;
      believed[truth.track.number] = track->class_belief;
    }
  }
  // Of 200 looks a share of 2 x .3 x .4 / .7 = .34 moves; the bound is 1e-6 on the safe side of 68.
  EXPECT_GT(moves, 30);
}

/// Two targets, mirror images; one turns out to be a threat, sixteen times as important. Without weights the two would
/// be exchangeable: that the threat has more looks in each of 20 runs has a chance of 2^-20 then.
TEST(Classes, ATrackThatTurnsOutImportantGetsMoreLooks) {
  int looks_at_threat = 0;
  int looks = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    const bool left = seed % 2 == 0;
    const std::string text = "seed: " + std::to_string(seed) + "\nradar { name: \"r\" " + kEmission +
                             "detection_probability: 0.9 }\n"
                             "target { name: \"left\" x_m: -20e3 y_m: 40e3 vy_mps: 100 class: \"" +
                             (left ? "threat" : "calm") +
                             "\" }\n"
                             "target { name: \"right\" x_m: 20e3 y_m: 40e3 vy_mps: 100 class: \"" +
                             (left ? "calm" : "threat") + "\" }\n" + classes();
    Engine engine(config_of(text).engine);
    int at_threat = 0;
    int at_calm = 0;
    for (int scan = 0; scan < 150; ++scan) {
      engine.scan();
      if (scan < 50) continue;  // what they are is not known yet
      for (const LookReport& look : engine.last().looks)
        ++((look.dwell.track.number == 1) == left ? at_threat : at_calm);
    }
    EXPECT_GT(at_threat, at_calm) << "seed " << seed;
    looks_at_threat += at_threat;
    looks += at_threat + at_calm;
  }
  RecordProperty("share_at_threat", std::to_string(static_cast<double>(looks_at_threat) / looks));
}

/// A track that surveillance has found knows what its plots have declared.
TEST(Classes, OfATrackFoundBySurveillanceAreThoseOfItsPlots) {
  for (const char* association : {"NEAREST", "IPDA"}) {
    const std::string text =
        "radar { name: \"r\" max_range_m: 40e3 range_noise_floor_m: 20 azimuth_noise_floor_deg: 0.1 "
        "surveillance { period_s: 2 } emission: [0.99, 0.01, 0.01, 0.99] }\n"
        "target { name: \"t\" y_m: 20e3 vx_mps: 200 weight: 2 class: \"threat\" start { none {} } }\n" +
        classes() + "tracker { association: " + association + " }\n";
    Engine engine(config_of(text).engine);
    while (engine.last().scan < 60 && engine.tracks().empty()) engine.scan();
    ASSERT_EQ(engine.tracks().size(), 1U);
    // Two plots or more, right in 99 of 100: odds of .3 / .7 times 99 twice at least.
    EXPECT_GT(engine.tracks()[0].class_belief[1], 0.999);
    EXPECT_NEAR(engine.tracks()[0].weight, 2.0 * 16.0, 0.1);
  }
}

TEST(Classes, FirstPlotDeclaresToo) {
  const std::string text =
      "radar { name: \"r\" emission: [1, 0, 0, 1] }\n"
      "target { name: \"t\" y_m: 20e3 class: \"threat\" start { first_plot {} } }\n" +
      classes();
  Engine engine(config_of(text).engine);
  ASSERT_EQ(engine.tracks().size(), 1U);
  EXPECT_GT(engine.tracks()[0].class_belief[1], 0.9999);
}

/// Classes that are not given are drawn by their priors, for each target by its name.
TEST(Classes, AreDrawnByThePriors) {
  const int targets = 1000;
  std::string text = "radar { name: \"r\" }\n" + classes();
  for (int i = 0; i < targets; ++i) text += "target { name: \"" + std::to_string(i) + "\" y_m: 50e3 }\n";
  const Engine engine(config_of(text).engine);
  const auto threats =
      std::ranges::count_if(engine.living_targets(), [](const auto& t) { return t.target_class == 1; });
  const auto band = statistics::binomial_band(targets, 0.3);
  EXPECT_TRUE(band.contains(static_cast<double>(threats))) << threats;
}

}  // namespace
}  // namespace dwell::testing
