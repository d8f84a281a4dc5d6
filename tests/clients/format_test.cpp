#include <fmt/format.h>
#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "clients/format.hpp"
#include "clients/track_table.hpp"
#include "tests/clients/fake_daemon.hpp"

namespace dwell::client {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string joined(const Lines& lines) {
  std::string text;
  for (const Line& line : lines) text += line.text + "\n";
  return text;
}

TEST(TrackFigures, AreOfPositionVelocityAndCovariance) {
  // The state: 120 km east, 40 km south, velocity (300, 400): 500 m/s, atan2(300, 400) = 36.87 deg from
  // north.
  const TrackFigures f = figures(track(7, "two"), 0);
  EXPECT_DOUBLE_EQ(*f.east_km, 120);
  EXPECT_DOUBLE_EQ(*f.north_km, -40);
  EXPECT_DOUBLE_EQ(*f.speed_mps, 500);
  EXPECT_NEAR(*f.heading_deg, 36.8699, 1e-4);  // the digits given
  EXPECT_DOUBLE_EQ(*f.sigma_m, 50);            // the larger of sqrt(2500) and sqrt(900)
  EXPECT_FALSE(f.age_of_look_s);
}

TEST(TrackFigures, SigmaIsTheMajorAxisOfATiltedEllipse) {
  // [[5 4], [4 5]] has the eigenvalues 9 and 1.
  v1::Track tilted = track(1, "");
  tilted.set_covariance(0, 5);
  tilted.set_covariance(2, 4);
  tilted.set_covariance(7, 5);
  EXPECT_DOUBLE_EQ(*figures(tilted, 0).sigma_m, 3);
}

TEST(TrackFigures, HeadingIsClockwiseFromNorth) {
  const std::vector<std::array<double, 3>> cases{{0, 1, 0}, {1, 0, 90}, {0, -1, 180}, {-1, 0, 270}};
  for (const auto& [vx, vy, heading_deg] : cases) {
    v1::Track t = track(1, "");
    t.set_state(1, vx);
    t.set_state(3, vy);
    EXPECT_DOUBLE_EQ(*figures(t, 0).heading_deg, heading_deg);
  }
  v1::Track almost_north = track(1, "");
  almost_north.set_state(1, -1e-3);  // 359.99986 deg is written 000, not 360
  EXPECT_THAT(track_line(almost_north, {}, 0), HasSubstr(" 000 "));
}

TEST(TrackFigures, AreAbsentWhereTheMessageHoldsNothing) {
  const TrackFigures f = figures(v1::Track(), 0);
  EXPECT_FALSE(f.east_km || f.north_km || f.speed_mps || f.heading_deg || f.sigma_m || f.age_of_look_s);
  EXPECT_THAT(
      track_line(v1::Track(), {}, 0),
      HasSubstr(
          "0 -                        unknown            -          -        -   -         - -                - -"));
}

TEST(TrackFigures, WhatStandsStillHasNoHeading) {
  v1::Track still = track(1, "");
  still.set_state(1, 0);
  still.set_state(3, 0);
  EXPECT_FALSE(figures(still, 0).heading_deg);
}

TEST(TrackLine, HoldsOneFieldAColumn) {
  v1::Track t = track(7, "two words");
  t.set_last_look_radar(1);
  t.set_last_look_time_ns(9'500'000'000);
  EXPECT_EQ(track_line(t, Names(snapshot(0)), 12'000'000'000),
            "      12.000     7 two_words                confirmed    120.000    -40.000    500.0 037      50.0 west"
            "         2.500 .90 .08 .02");
  EXPECT_EQ(track_line_header({}).find("age_s"), track_line(t, Names(snapshot(0)), 12'000'000'000).find("2.500"));
}

TEST(TrackLine, NeverShowsWhatIsNotFinite) {
  v1::Track t = track(7, "two");
  for (auto* values : {t.mutable_state(), t.mutable_covariance(), t.mutable_mode_probability()}) {
    for (double& value : *values) value = std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_THAT(track_line(t, {}, 0), AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf"))));
  for (auto* values : {t.mutable_state(), t.mutable_covariance()}) {
    for (double& value : *values) value = std::numeric_limits<double>::infinity();
  }
  EXPECT_THAT(track_line(t, {}, 0), AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf"))));
}

TEST(ModeText, IsCompact) {
  v1::Track t;
  EXPECT_EQ(mode_text(t), "-");
  for (const double p : {1.0, 0.0, 0.049}) t.add_mode_probability(p);
  EXPECT_EQ(mode_text(t), "1.0 .00 .05");
}

TEST(PolicyText, IsAsTheCommandLineTakesIt) {
  v1::Policy policy;
  EXPECT_EQ(policy_text(policy), "unknown");
  policy.mutable_largest_variance();
  EXPECT_EQ(policy_text(policy), "largest_variance");
  policy.mutable_sa_imm()->set_cost(v1::SaImm::X);
  policy.mutable_sa_imm()->set_beta(0.25);
  policy.mutable_sa_imm()->set_nodes(7);
  EXPECT_EQ(policy_text(policy), "sa_imm:cost=x:beta=0.25:nodes=7");
  policy.mutable_round_robin()->set_order(v1::RoundRobin::RADAR_FASTEST);
  EXPECT_EQ(policy_text(policy), "round_robin:order=radar_fastest");
}

TEST(FormatStatus, AlignsItsLinesAndSaysWhenARunIsFast) {
  const Lines lines = format_status(snapshot(2).status());
  for (const Line& line : lines) EXPECT_EQ(line.text.substr(15, 2), "  ") << line.text;
  EXPECT_THAT(joined(lines),
              AllOf(HasSubstr("run              running\n"), HasSubstr("2 of 3 up"), HasSubstr("none: a fast run")));
}

TEST(FormatStatus, ShowsTheWallClockWhereThereIsOne) {
  v1::Status status = snapshot(2).status();
  status.mutable_wall_clock()->set_uptime_s(90061.5);
  status.mutable_wall_clock()->set_missed_scans(3);
  EXPECT_THAT(joined(format_status(status)),
              AllOf(HasSubstr("1 d 01:01:01"), HasSubstr("missed scans     3"), Not(HasSubstr("fast"))));
}

TEST(FormatPolicies, MarksTheActiveOneAndNamesEachParameter) {
  v1::PolicyList list;
  v1::PolicyEntry& plain = *list.add_entry();
  plain.set_name("largest_variance");
  v1::PolicyEntry& active = *list.add_entry();
  active.set_name("sa_imm");
  active.set_summary("one-step expected cost");
  active.set_active(true);
  for (const char* name : {"beta", "nodes"}) {
    v1::PolicyParameter& parameter = *active.add_parameter();
    parameter.set_name(name);
    parameter.set_rule("a rule");
    parameter.set_default_value("5");
  }
  const Lines lines = format_policies(list, {});
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[1].text, "   largest_variance  -");
  EXPECT_EQ(lines[2].text, "*  sa_imm            beta       5        a rule  one-step expected cost");
  EXPECT_EQ(lines[3].text, "                     nodes      5        a rule");
}

TEST(FormatRadars, LeavesOutWhatASensorDoesNotHave) {
  v1::RadarList list;
  v1::RadarState& radar = *list.add_radar();
  radar.set_number(1);
  radar.set_name("west");
  radar.set_up(true);
  radar.set_looks(8);
  radar.set_detections(6);
  radar.set_x_m(-120e3);
  radar.set_y_m(0);
  v1::RadarState& linear = *list.add_radar();
  linear.set_number(2);
  linear.set_name("linear");
  linear.mutable_budget()->set_looks(10);
  linear.mutable_budget()->set_left(4);
  const Lines lines = format_radars(list, {});
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[1].text, " 1  west    up         8      6    75.0 %       -  -120.000  0.000");
  EXPECT_EQ(lines[2].text, " 2  linear  down       0      0         -  (4/10)         -      -");
}

TEST(FormatSnapshot, FitsThePageAndCountsTheRest) {
  const Lines lines = format_snapshot(snapshot(500), {60, 20});
  ASSERT_EQ(lines.size(), 20u);
  EXPECT_EQ(lines.back().text, "... 486 more tracks");
  for (std::size_t i = 4; i < lines.size(); ++i) EXPECT_LE(display_width(lines[i].text), 60) << lines[i].text;
  EXPECT_EQ(format_snapshot(snapshot(500), {}).size(), 505u);
}

TEST(FormatSnapshot, HoldsLostTracksToo) {
  v1::Snapshot s = snapshot(2);
  s.mutable_track(0)->set_status(v1::Track::LOST);
  const Lines lines = format_snapshot(s, {});
  EXPECT_THAT(lines[5].text, HasSubstr("lost"));
  EXPECT_EQ(lines[5].mark, Mark::kAlarm);
  EXPECT_THAT(joined(format_snapshot(snapshot(0), {})), HasSubstr("no tracks"));
}

TEST(FormatRefusal, SaysFieldValueAndRuleOfEachViolation) {
  v1::Refused refused;
  refused.set_reason(v1::Refused::INVALID);
  for (const char* field : {"policy.nodes", "policy.beta"}) {
    v1::Violation& violation = *refused.add_violation();
    violation.set_field(field);
    violation.set_value("99\x1b[2J");
    violation.set_rule("2 .. 32");
  }
  const Lines lines = format_refusal(refused);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].text, "refused: invalid");
  EXPECT_EQ(lines[1].text, "  policy.nodes = 99?[2J: 2 .. 32");
}

TEST(Json, KeepsTheNamesOfTheSchemaAndLeavesAbsentFieldsOut) {
  v1::Track t = track(7, "two");
  const auto parsed = nlohmann::json::parse(json(t));
  EXPECT_EQ(parsed.at("age_scans"), 0);                // a plain field is there even when it is zero
  EXPECT_FALSE(parsed.contains("last_look_time_ns"));  // an optional one only when it is set
  t.set_last_look_time_ns(9'500'000'000);
  EXPECT_EQ(nlohmann::json::parse(json(t)).at("last_look_time_ns"), "9500000000");  // 64 bits: a string
  EXPECT_EQ(json(t).find('\n'), std::string::npos);
}

}  // namespace
}  // namespace dwell::client
