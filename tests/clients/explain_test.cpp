#include <gmock/gmock.h>

#include <limits>
#include <string>

#include "clients/explain.hpp"
#include "tests/clients/fake_daemon.hpp"

namespace dwell::client {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string text_of(const v1::Snapshot& snapshot) {
  std::string text;
  for (const Line& line : explain(snapshot, {})) text += line.text + "\n";
  return text;
}

v1::Candidate& add(v1::ScanReport& report, std::uint32_t radar, std::uint32_t track, double score) {
  v1::Candidate& candidate = *report.add_candidate();
  candidate.set_radar(radar);
  candidate.set_track(track);
  candidate.set_score(score);
  return candidate;
}

/// Three candidates, the second chosen: a cost of 5000 comes down to 800, less 200 for the use of radar 1.
v1::Snapshot one_scan() {
  v1::Snapshot s = snapshot(2);
  v1::ScanReport& report = *s.mutable_last_scan();
  report.set_scan(12);
  report.set_policy("sa_imm");
  add(report, 1, 1, 100);
  v1::Candidate& winner = add(report, 1, 2, 4000);
  winner.set_cost_without_look(5000);
  winner.set_expected_cost(800);
  add(report, 3, 2, 3000);
  v1::Look& look = *report.add_look();
  look.set_radar(1);
  look.set_track(2);
  look.set_plots(2);
  look.set_used_plot(1);
  look.set_nis(1.5);
  report.set_margin(1000);
  return s;
}

TEST(Explain, SaysWhatTheTrackIsAndWhatThatMadeItWorth) {
  v1::Snapshot s = one_scan();
  EXPECT_THAT(text_of(s), AllOf(Not(HasSubstr("class")), Not(HasSubstr("weight"))));
  s.add_class_name("calm");
  s.add_class_name("threat");
  for (v1::Candidate& candidate : *s.mutable_last_scan()->mutable_candidate()) candidate.set_weight(5.5);
  v1::Track& second = *s.mutable_track(1);
  second.add_class_belief(0.1);
  second.add_class_belief(0.9);
  second.set_weight(14.5);
  EXPECT_THAT(text_of(s),
              AllOf(HasSubstr("\nclass   threat .90 after the look; weight 5.5 when it was chosen, 14.5 now\n"),
                    HasSubstr("  weight\n")));
}

TEST(Explain, SaysWhatWasChosenAndWhy) {
  EXPECT_EQ(text_of(one_scan()),
            "scan 12, policy sa_imm, 3 candidates\n"
            "chosen  west -> 2 target2: 2 plots, plot 1 used, nis 1.5\n"
            "why     a look by west brings the expected cost of track 2 target2 from 5000 down to 800: a "
            "gain of 4000 "
            "after 200 for the use of the radar; none of the 2 candidates left has more\n"
            "margin  1000 over linear -> 2 target2\n"
            "\n"
            "   radar   track  name     score  cost without look  expected cost\n"
            "*  west        2  target2   4000               5000            800\n"
            "   linear      2  target2   3000                  -              -\n"
            "   west        1  target1    100                  -              -\n");
}

TEST(Explain, BeforeTheFirstScanThereIsNothingToExplain) {
  EXPECT_EQ(text_of(snapshot(2)), "no scan has been completed yet\n");
}

TEST(Explain, SaysWhenNothingWasFeasible) {
  v1::Snapshot s = snapshot(0);
  s.mutable_last_scan()->set_scan(3);
  EXPECT_THAT(text_of(s), HasSubstr("nothing: no pair was feasible"));
}

TEST(Explain, SaysWhenTheOnlyPairWon) {
  v1::Snapshot s = one_scan();
  s.mutable_last_scan()->mutable_candidate()->DeleteSubrange(2, 1);
  s.mutable_last_scan()->mutable_candidate()->DeleteSubrange(0, 1);
  s.mutable_last_scan()->clear_margin();
  EXPECT_THAT(text_of(s),
              AllOf(HasSubstr("; no other pair was feasible"), HasSubstr("none: fewer than two candidates")));
}

TEST(Explain, DoesNotCallBestWhatIsNot) {
  v1::Snapshot s = one_scan();
  s.mutable_last_scan()->mutable_candidate(0)->set_score(9000);
  EXPECT_THAT(text_of(s), AllOf(HasSubstr("1 of the 2 candidates left have more"), Not(HasSubstr("none"))));
  s.mutable_last_scan()->mutable_candidate(0)->set_score(4000);
  EXPECT_THAT(text_of(s), HasSubstr("1 of the 2 candidates left have as much: the policy broke the tie"));
}

TEST(Explain, ScoresWithoutCostsAreCalledScores) {
  v1::Snapshot s = one_scan();
  s.mutable_last_scan()->mutable_candidate(1)->clear_expected_cost();
  EXPECT_THAT(text_of(s), HasSubstr("why     a score of 4000; none of the 2 candidates left has more"));
}

TEST(Explain, TheSecondOfTwoLooksIsMeasuredAgainstThoseNotChosen) {
  v1::Snapshot s = one_scan();
  v1::Look& look = *s.mutable_last_scan()->add_look();
  look.set_radar(3);
  look.set_track(2);
  EXPECT_THAT(text_of(s),
              AllOf(HasSubstr("chosen  linear -> 2 target2: 0 plots, none in the gate"),
                    HasSubstr("a score of 3000; no other pair was feasible"), HasSubstr("over west -> 1 target1")));
}

TEST(Explain, SaysThatThePolicyFellBack) {
  v1::Snapshot s = one_scan();
  s.mutable_last_scan()->set_fell_back(true);
  EXPECT_THAT(text_of(s), HasSubstr("the policy could not answer; a cheaper one decided"));
}

TEST(Explain, SaysThatTheLookWasOwed) {
  v1::Snapshot s = one_scan();
  EXPECT_THAT(text_of(s), Not(HasSubstr("owed")));
  s.mutable_last_scan()->set_owed(true);
  EXPECT_THAT(text_of(s), HasSubstr("the first look was owed: its track or its radar had waited too long"));
}

TEST(Explain, ScoresThatAreNotNumbersGoLastAndAreDashes) {
  v1::Snapshot s = one_scan();
  s.mutable_last_scan()->mutable_candidate(0)->set_score(std::numeric_limits<double>::quiet_NaN());
  const Lines lines = explain(s, {});
  EXPECT_EQ(lines.back().text, "   west        1  target1      -                  -              -");
}

TEST(Explain, FitsThePage) {
  v1::Snapshot s = snapshot(300);
  *s.mutable_last_scan() = one_scan().last_scan();
  for (std::uint32_t id = 3; id <= 300; ++id) add(*s.mutable_last_scan(), 1, id, id);
  const Lines lines = explain(s, {60, 24});
  ASSERT_EQ(lines.size(), 24u);
  EXPECT_THAT(lines.back().text, StartsWith("... "));
  for (const Line& line : lines) EXPECT_LE(display_width(line.text), 60) << line.text;
}

}  // namespace
}  // namespace dwell::client
