#include <gmock/gmock.h>

#include <string>

#include "clients/track_table.hpp"
#include "clients/watch_frame.hpp"
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

Picture picture_of(const v1::Snapshot& snapshot) {
  Picture picture;
  picture.load(snapshot);
  return picture;
}

v1::Envelope at(std::int64_t time_ns) {
  v1::Envelope envelope;
  envelope.set_time_ns(time_ns);
  return envelope;
}

Supply good() { return {.stream = "tcp://stream", .control = "tcp://control"}; }

TEST(WatchFrame, FitsEveryPage) {
  Picture picture = picture_of(snapshot(200));
  const Supply bad{.stream = "tcp://stream",
                   .control = "tcp://control",
                   .silent_s = 99,
                   .losses = {3, 40, 2},
                   .without_snapshot = true};
  for (const int rows : {1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 24, 60}) {
    for (int columns = 1; columns <= 220; columns += 3) {
      const Lines lines = watch_frame(picture, bad, {columns, rows});
      ASSERT_LE(static_cast<int>(lines.size()), rows);
      for (const Line& line : lines) ASSERT_LE(display_width(paint(line, columns, false)), columns);
    }
  }
}

TEST(WatchFrame, WideShowsEveryColumnNarrowTheEssential) {
  const Picture picture = picture_of(snapshot(3));
  const std::string wide = joined(watch_frame(picture, good(), {200, 50}));
  for (const char* column :
       {"id", "name", "status", "E km", "N km", "m/s", "hdg", "sigma m", "modes", "radar", "age s"}) {
    EXPECT_THAT(wide, HasSubstr(column));
  }
  EXPECT_THAT(joined(watch_frame(picture, good(), {80, 24})), AllOf(HasSubstr("sigma m"), HasSubstr("age s")));
  const std::string narrow = joined(watch_frame(picture, good(), {24, 24}));
  EXPECT_THAT(narrow, AllOf(HasSubstr("E km"), HasSubstr("N km"), Not(HasSubstr("hdg"))));
}

TEST(WatchFrame, ShowsTheClassWhereThereAreClasses) {
  v1::Snapshot s = snapshot(2);
  EXPECT_THAT(joined(watch_frame(picture_of(s), good(), {200, 50})), Not(HasSubstr("class")));
  s.add_class_name("calm");
  s.add_class_name("a threat");
  v1::Track& second = *s.mutable_track(1);
  second.add_class_belief(0.07);
  second.add_class_belief(0.93);
  second.set_weight(18.7);
  const std::string shown = joined(watch_frame(picture_of(s), good(), {200, 50}));
  EXPECT_THAT(shown, AllOf(HasSubstr("class"), HasSubstr("weight"), testing::ContainsRegex("a threat .93 +18.7")));
  const Names names(s);
  EXPECT_THAT(track_line_header(names), HasSubstr("class p_class weight modes"));
  EXPECT_THAT(track_line(second, names, 0), HasSubstr(" a_threat .93 18.7 "));
  EXPECT_THAT(track_line(s.track(0), names, 0), HasSubstr(" - - - "));
}

TEST(WatchFrame, CountsTheTracksThatDoNotFit) {
  const Lines lines = watch_frame(picture_of(snapshot(200)), good(), {200, 24});
  ASSERT_EQ(lines.size(), 24u);
  EXPECT_EQ(lines.back().text, "... 183 more tracks");
}

TEST(WatchFrame, ShowsTheDecision) {
  v1::Snapshot s = snapshot(3);
  EXPECT_EQ(decision_text(picture_of(s)), "last look: none yet");
  v1::ScanReport& report = *s.mutable_last_scan();
  EXPECT_EQ(decision_text(picture_of(s)), "last look: none, no pair was feasible");
  report.set_margin(12.5);
  for (const std::uint32_t radar : {1u, 9u}) {
    v1::Look& look = *report.add_look();
    look.set_radar(radar);
    look.set_track(radar == 1 ? 2 : 77);
    if (radar == 1) look.set_used_plot(1);
  }
  EXPECT_EQ(decision_text(picture_of(s)), "last look: west -> 2 target2, #9 -> 77 (no plot), margin 12.5");
}

TEST(WatchFrame, MarksSilenceHolesAndRestarts) {
  const Picture picture = picture_of(snapshot(1));
  Supply supply = good();
  supply.silent_s = kSilenceSeconds;
  EXPECT_THAT(joined(watch_frame(picture, supply, {200, 50})), Not(HasSubstr("NO DATA")));
  supply.silent_s = kSilenceSeconds + 1;
  supply.losses = {.holes = 1, .messages = 12, .restarts = 1};
  EXPECT_THAT(joined(watch_frame(picture, supply, {200, 50})),
              HasSubstr("NO DATA for 4 s from tcp://stream; 12 messages missed in 1 gap; daemon restarted\n"));
  supply.without_snapshot = true;
  EXPECT_THAT(joined(watch_frame(picture, supply, {200, 50})), HasSubstr("NO SNAPSHOT: no answer from tcp://control"));
}

TEST(WatchFrame, SaysWhatItWaitsForAtTheStart) {
  Supply supply = good();
  supply.started = false;
  EXPECT_EQ(joined(watch_frame({}, supply, {80, 24})), "waiting for an answer from tcp://control\n");
}

TEST(Picture, ALostTrackIsShownLastAndThenForgotten) {
  Picture picture = picture_of(snapshot(3));
  v1::Envelope loss = at(13'000'000'000);
  *loss.mutable_track() = track(1, "target1");
  loss.mutable_track()->set_status(v1::Track::LOST);
  picture.apply(loss);
  const Lines lines = watch_frame(picture, good(), {200, 50});
  EXPECT_THAT(lines.back().text, HasSubstr("target1"));
  EXPECT_THAT(lines.back().text, HasSubstr("lost"));
  EXPECT_EQ(picture.status().tracks_confirmed(), 2u);

  v1::Envelope later = at(60'000'000'000);
  later.mutable_scan_report()->set_scan(60);
  picture.apply(later);
  EXPECT_EQ(picture.tracks().size(), 2u);
  EXPECT_EQ(picture.status().scan(), 60u);
}

TEST(Picture, FollowsChangesOfPolicyAndRadars) {
  Picture picture = picture_of(snapshot(1));
  EXPECT_EQ(picture.status().radars_up(), 2u);
  v1::Envelope radar = at(13'000'000'000);
  radar.mutable_radar_change()->set_radar(2);
  radar.mutable_radar_change()->set_name("east");
  radar.mutable_radar_change()->set_up(true);
  picture.apply(radar);
  EXPECT_EQ(picture.status().radars_up(), 3u);
  v1::Envelope policy = at(14'000'000'000);
  policy.mutable_policy_change()->mutable_to()->mutable_round_robin();
  picture.apply(policy);
  EXPECT_EQ(picture.status().policy(), "round_robin");
  EXPECT_EQ(picture.time_ns(), 14'000'000'000);
}

TEST(Picture, WithoutASnapshotRadarsAreNumbers) {
  Picture picture;
  v1::Envelope message = at(1'000'000'000);
  *message.mutable_track() = track(5, "five");
  message.mutable_track()->set_last_look_radar(2);
  picture.apply(message);
  EXPECT_THAT(joined(watch_frame(picture, good(), {200, 50})), AllOf(HasSubstr("five"), HasSubstr("#2")));
}

}  // namespace
}  // namespace dwell::client
