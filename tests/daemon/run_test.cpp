#include <gmock/gmock.h>

#include <set>

#include "tests/daemon/support.hpp"

namespace dwell::testing {
namespace {

using ::testing::HasSubstr;

v1::Request request(const std::string& id) {
  v1::Request message;
  message.set_id(id);
  message.set_client("test");
  return message;
}

v1::Request set_policy(const std::string& id, const std::string& text) {
  v1::Request message = request(id);
  message.mutable_set_policy()->set_text(text);
  return message;
}

v1::Request set_radar(const std::string& id, const std::string& name, bool up) {
  v1::Request message = request(id);
  message.mutable_set_radar()->set_name(name);
  message.mutable_set_radar()->set_up(up);
  return message;
}

v1::Request pause(const std::string& id) {
  v1::Request message = request(id);
  message.mutable_pause();
  return message;
}

v1::Request resume(const std::string& id) {
  v1::Request message = request(id);
  message.mutable_resume();
  return message;
}

v1::Request step(const std::string& id, std::uint64_t scans) {
  v1::Request message = request(id);
  message.mutable_step()->set_scans(static_cast<std::uint32_t>(scans));
  return message;
}

v1::Request snapshot(const std::string& id) {
  v1::Request message = request(id);
  message.mutable_get_snapshot();
  return message;
}

std::vector<v1::ScanReport> scan_reports(const Recorder& stream) {
  std::vector<v1::ScanReport> reports;
  for (const v1::Envelope& envelope : stream.envelopes) {
    if (envelope.has_scan_report()) reports.push_back(envelope.scan_report());
  }
  return reports;
}

class RunTest : public ::testing::Test {
 protected:
  v1::Reply ask(const v1::Request& message) { return recorded.run.handle(message); }
  v1::Refused refused(const v1::Request& message) {
    const v1::Reply reply = ask(message);
    EXPECT_TRUE(reply.has_refused()) << reply.ShortDebugString();
    return reply.refused();
  }

  RecordedRun recorded{config_of(kBusy)};
};

// --- retries
// --------------------------------------------------------------------------------------------------

TEST_F(RunTest, CommandIsAnsweredWithTheScanAtWhichItTakesEffect) {
  recorded.scan(4);
  const v1::Reply reply = ask(set_policy("a", "round_robin:order=locked"));
  EXPECT_EQ(reply.id(), "a");
  EXPECT_EQ(reply.accepted().effective_scan(), 5);
  EXPECT_EQ(reply.accepted().policy().round_robin().order(), v1::RoundRobin::LOCKED);
  const v1::PolicyChange& change = recorded.stream.envelopes.back().policy_change();
  EXPECT_EQ(recorded.stream.topics.back(), "policy.");
  EXPECT_EQ(change.scan(), 5);
  EXPECT_EQ(change.client(), "test");
  EXPECT_EQ(change.request_id(), "a");
  EXPECT_TRUE(change.from().has_sa_imm());
  EXPECT_TRUE(change.to().has_round_robin());
  recorded.scan(1);
  const auto reports = scan_reports(recorded.stream);
  EXPECT_EQ(reports[3].policy(), "sa_imm");
  EXPECT_EQ(reports[4].policy(), "round_robin");
  EXPECT_EQ(reports[4].scan(), 5);
}

TEST_F(RunTest, RetryIsAppliedOnceAndGetsTheSameAnswer) {
  recorded.scan(2);
  const v1::Request message = set_radar("a", "west", false);
  const std::string first = ask(message).SerializeAsString();
  (void)ask(set_radar("b", "west", true));
  const std::size_t published = recorded.stream.envelopes.size();
  recorded.scan(3);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(ask(message).SerializeAsString(), first);
  EXPECT_TRUE(recorded.run.engine().sensor_state(0).up) << "the second command stands";
  recorded.run.scan();
  for (std::size_t i = published; i < recorded.stream.envelopes.size(); ++i) {
    EXPECT_FALSE(recorded.stream.envelopes[i].has_radar_change());
  }
}

TEST_F(RunTest, RefusedCommandIsRefusedAgain) {
  const v1::Request message = set_policy("a", "none");
  EXPECT_EQ(ask(message).SerializeAsString(), ask(message).SerializeAsString());
  EXPECT_EQ(recorded.run.requests_refused(), 2);
}

TEST_F(RunTest, IdOfAnotherRequestIsRefused) {
  EXPECT_TRUE(ask(set_policy("a", "fixed")).has_accepted());
  EXPECT_EQ(refused(set_policy("a", "round_robin")).reason(), v1::Refused::ID_REUSED);
  EXPECT_EQ(refused(set_radar("a", "west", false)).reason(), v1::Refused::ID_REUSED);
  EXPECT_EQ(recorded.run.engine().policy_name(), "fixed");
}

TEST_F(RunTest, QueriesMayShareAnIdAndAreAnsweredAnew) {
  EXPECT_EQ(ask(snapshot("q")).accepted().effective_scan(), 0);
  recorded.scan(1);
  EXPECT_EQ(ask(snapshot("q")).accepted().effective_scan(), 1);
  EXPECT_TRUE(ask(set_policy("q", "fixed")).has_accepted());
}

TEST_F(RunTest, FourThousandAnswersAreRemembered) {
  const v1::Request first = set_radar("first", "west", false);
  const std::string answer = ask(first).SerializeAsString();
  for (int i = 1; i < 4096; ++i) (void)ask(set_radar(std::to_string(i), "west", true));
  recorded.run.scan();
  EXPECT_EQ(ask(first).SerializeAsString(), answer);
  (void)ask(set_radar("last", "west", true));
  EXPECT_EQ(ask(first).accepted().effective_scan(), 2) << "forgotten, and so a new command";
}

// --- refusals
// -------------------------------------------------------------------------------------------------

TEST_F(RunTest, IdIsOneTo64CharactersAndClientAtMost64) {
  for (const std::string& id : {std::string(), std::string(65, 'x')}) {
    const v1::Refused refusal = refused(set_policy(id, "fixed"));
    EXPECT_EQ(refusal.reason(), v1::Refused::INVALID);
    EXPECT_EQ(refusal.violation(0).field(), "id");
  }
  v1::Request message = set_policy("a", "fixed");
  message.set_client(std::string(65, 'x'));
  EXPECT_EQ(refused(message).violation(0).field(), "client");
  message.set_client("");
  message.set_id(std::string(64, 'x'));
  EXPECT_TRUE(ask(message).has_accepted());
}

/// A reply whose text were cut inside a character could not be read by any client.
TEST_F(RunTest, RepliesAreValidUtf8) {
  std::string wide;
  for (int i = 0; i < 100; ++i) wide += "\u20ac";  // 3 bytes each: neither 64 nor 80 is a whole number of them
  for (const v1::Request& message :
       {set_policy(wide, "fixed"), set_policy("a", wide), set_policy("b", "sa_imm:" + wide),
        set_policy("c", "sa_imm:nodes=" + wide), set_radar("d", wide, true)}) {
    v1::Reply reply;
    EXPECT_TRUE(reply.ParseFromString(ask(message).SerializeAsString())) << message.id();
    EXPECT_TRUE(reply.has_refused());
  }
}

TEST_F(RunTest, RequestWithoutBodyIsMalformed) { EXPECT_EQ(refused(request("a")).reason(), v1::Refused::MALFORMED); }

TEST_F(RunTest, FieldsOfANewerVersionAreUnsupported) {
  v1::Request message = request("a");
  message.GetReflection()->MutableUnknownFields(&message)->AddVarint(99, 1);
  EXPECT_EQ(refused(message).reason(), v1::Refused::UNSUPPORTED) << "a command that this version does not know";
  message = set_policy("a", "fixed");
  auto* inner = message.mutable_set_policy();
  inner->GetReflection()->MutableUnknownFields(inner)->AddVarint(99, 1);
  EXPECT_EQ(refused(message).reason(), v1::Refused::UNSUPPORTED);
  message = request("a");
  auto* nodes = message.mutable_set_policy()->mutable_policy()->mutable_sa_imm();
  nodes->GetReflection()->MutableUnknownFields(nodes)->AddVarint(99, 1);
  EXPECT_EQ(refused(message).reason(), v1::Refused::UNSUPPORTED);
  EXPECT_EQ(recorded.run.engine().policy_name(), "sa_imm");
}

TEST_F(RunTest, UnknownPolicyListsTheValidAndChangesNothing) {
  const v1::Refused refusal = refused(set_policy("a", "greedy"));
  EXPECT_EQ(refusal.reason(), v1::Refused::INVALID);
  EXPECT_EQ(refusal.violation(0).field(), "policy");
  EXPECT_EQ(refusal.violation(0).value(), "greedy");
  EXPECT_THAT(refusal.violation(0).rule(), HasSubstr("round_robin, fixed, largest_variance, sa_imm"));
  v1::Request empty = request("b");
  empty.mutable_set_policy();
  EXPECT_EQ(refused(empty).reason(), v1::Refused::INVALID);
  EXPECT_TRUE(recorded.stream.envelopes.empty());
}

TEST_F(RunTest, PolicyMessageIsCheckedLikeAConfig) {
  v1::Request message = request("a");
  message.mutable_set_policy()->mutable_policy()->mutable_sa_imm()->set_beta(std::nan(""));
  EXPECT_EQ(refused(message).violation(0).field(), "sa_imm.beta");
  message = request("b");
  message.mutable_set_policy()->mutable_policy()->mutable_fixed()->set_sensor(4);
  EXPECT_EQ(refused(message).violation(0).rule(), "must be a whole number from 1 to 3");
  EXPECT_EQ(recorded.run.engine().policy_name(), "sa_imm");
}

TEST_F(RunTest, UnknownRadarListsTheValid) {
  const v1::Refused refusal = refused(set_radar("a", "north", false));
  EXPECT_EQ(refusal.reason(), v1::Refused::INVALID);
  EXPECT_EQ(refusal.violation(0).field(), "set_radar.name");
  EXPECT_EQ(refusal.violation(0).value(), "north");
  EXPECT_EQ(refusal.violation(0).rule(), "must be one of: west, east, south");
}

// --- radars
// ---------------------------------------------------------------------------------------------------

std::set<std::uint32_t> radars_of(const v1::ScanReport& report) {
  std::set<std::uint32_t> radars;
  for (const v1::Candidate& candidate : report.candidate()) radars.insert(candidate.radar());
  return radars;
}

TEST_F(RunTest, RadarDownLeavesTheCandidatesAtTheEffectiveScan) {
  recorded.scan(2);
  EXPECT_EQ(ask(set_radar("a", "east", false)).accepted().effective_scan(), 3);
  EXPECT_EQ(recorded.stream.topics.back(), "radar.");
  const v1::RadarChange& change = recorded.stream.envelopes.back().radar_change();
  EXPECT_EQ(change.scan(), 3);
  EXPECT_EQ(change.radar(), 2);
  EXPECT_EQ(change.name(), "east");
  EXPECT_FALSE(change.up());
  recorded.scan(2);
  EXPECT_EQ(ask(set_radar("b", "east", true)).accepted().effective_scan(), 5);
  recorded.scan(1);
  const auto reports = scan_reports(recorded.stream);
  using Radars = std::set<std::uint32_t>;
  EXPECT_EQ(radars_of(reports[1]), (Radars{1, 2, 3}));
  EXPECT_EQ(radars_of(reports[2]), (Radars{1, 3}));
  EXPECT_EQ(radars_of(reports[3]), (Radars{1, 3}));
  EXPECT_EQ(radars_of(reports[4]), (Radars{1, 2, 3}));
}

TEST_F(RunTest, RadarListCountsLooksAndDetections) {
  recorded.scan(50);
  v1::Request message = request("a");
  message.mutable_list_radars();
  const v1::RadarList list = ask(message).accepted().radar_list();
  ASSERT_EQ(list.radar_size(), 3);
  std::uint64_t looks = 0;
  for (const v1::RadarState& radar : list.radar()) {
    looks += radar.looks();
    EXPECT_LE(radar.detections(), radar.looks());
    EXPECT_TRUE(radar.up());
  }
  EXPECT_EQ(looks, 50);
  EXPECT_EQ(list.radar(0).name(), "west");
  EXPECT_EQ(list.radar(0).x_m(), -40e3);
}

// --- pause, step, stop
// ----------------------------------------------------------------------------------------

TEST_F(RunTest, StepsCountDownWhilePaused) {
  EXPECT_EQ(refused(step("a", 3)).reason(), v1::Refused::NOT_NOW) << "it runs";
  EXPECT_EQ(ask(pause("b")).accepted().status().run(), v1::Status::PAUSED);
  EXPECT_TRUE(recorded.run.paused());
  EXPECT_TRUE(ask(step("c", 3)).has_accepted());
  EXPECT_EQ(recorded.run.steps(), 3);
  recorded.scan(1);
  EXPECT_EQ(recorded.run.steps(), 2);
  EXPECT_TRUE(ask(step("c", 3)).has_accepted()) << "a retry";
  EXPECT_EQ(recorded.run.steps(), 2);
  EXPECT_TRUE(ask(step("d", 1)).has_accepted());
  EXPECT_EQ(recorded.run.steps(), 3);
  EXPECT_EQ(ask(resume("e")).accepted().status().run(), v1::Status::RUNNING);
  EXPECT_FALSE(recorded.run.paused());
  EXPECT_EQ(recorded.run.steps(), 0);
}

TEST_F(RunTest, StepIsOneToAMillionScans) {
  (void)ask(pause("a"));
  for (const std::uint64_t bad : {0UL, 1'000'001UL}) {
    const v1::Refused refusal = refused(step(std::to_string(bad), bad));
    EXPECT_EQ(refusal.reason(), v1::Refused::INVALID);
    EXPECT_EQ(refusal.violation(0).value(), std::to_string(bad));
  }
  v1::Request one = request("b");
  one.mutable_step();
  EXPECT_TRUE(ask(one).has_accepted());
  EXPECT_EQ(recorded.run.steps(), 1);
  EXPECT_TRUE(ask(step("c", 1'000'000)).has_accepted());
  EXPECT_EQ(recorded.run.steps(), 1'000'000);
}

TEST_F(RunTest, PauseTwiceAndResumeTwiceAreAccepted) {
  EXPECT_TRUE(ask(pause("a")).has_accepted());
  EXPECT_TRUE(ask(pause("b")).has_accepted());
  EXPECT_TRUE(ask(resume("c")).has_accepted());
  EXPECT_TRUE(ask(resume("d")).has_accepted());
  EXPECT_FALSE(recorded.run.paused());
}

TEST_F(RunTest, StopSaysWhoAndNoCommandFollows) {
  v1::Request message = request("a");
  message.mutable_stop();
  EXPECT_EQ(ask(message).accepted().status().run(), v1::Status::ENDING);
  EXPECT_TRUE(recorded.run.stop_requested());
  EXPECT_EQ(recorded.run.stop_reason(), "stopped by test");
  EXPECT_EQ(refused(set_policy("b", "fixed")).reason(), v1::Refused::NOT_NOW);
  EXPECT_TRUE(ask(message).has_accepted()) << "a retry";
  EXPECT_TRUE(ask(snapshot("c")).has_accepted()) << "a query";
}

TEST_F(RunTest, EndOfStreamCarriesItsOwnSequence) {
  recorded.scan(3);
  recorded.run.publish_end("for a test");
  const v1::Envelope& last = recorded.stream.envelopes.back();
  EXPECT_EQ(last.end_of_stream().final_sequence(), last.sequence());
  EXPECT_EQ(last.end_of_stream().reason(), "for a test");
  EXPECT_EQ(recorded.stream.topics.back(), "end.");
}

// --- snapshot
// -------------------------------------------------------------------------------------------------

TEST_F(RunTest, SnapshotIsWhatTheStreamHasSaid) {
  const v1::Snapshot before = ask(snapshot("q")).accepted().snapshot();
  EXPECT_EQ(before.sequence(), 0);
  EXPECT_FALSE(before.has_last_scan());
  EXPECT_EQ(before.track_size(), 2) << "tracks start at t = 0";
  EXPECT_THAT(before.mode_name(), ::testing::ElementsAre("cruise", "turn", "hard_turn"));
  (void)ask(set_policy("a", "largest_variance"));
  (void)ask(set_radar("b", "south", false));
  for (int i = 0; i < 30; ++i) {
    recorded.run.scan();
    recorded.run.publish_status(nullptr);
    const v1::Snapshot now = ask(snapshot("q")).accepted().snapshot();
    const auto& envelopes = recorded.stream.envelopes;
    EXPECT_EQ(now.epoch(), envelopes.back().epoch());
    EXPECT_EQ(now.sequence(), envelopes.back().sequence());
    EXPECT_EQ(now.time_ns(), envelopes.back().time_ns());
    EXPECT_EQ(now.last_scan().SerializeAsString(), scan_reports(recorded.stream).back().SerializeAsString());
    v1::Status status = envelopes.back().status();
    status.set_last_sequence(now.status().last_sequence());
    EXPECT_EQ(now.status().SerializeAsString(), status.SerializeAsString());
    std::vector<std::string> tracks;
    for (const v1::Envelope& envelope : envelopes) {
      if (envelope.has_track() && envelope.time_ns() == now.time_ns()) {
        tracks.push_back(envelope.track().SerializeAsString());
      }
    }
    ASSERT_EQ(now.track_size(), static_cast<int>(tracks.size()));
    for (int track = 0; track < now.track_size(); ++track) {
      EXPECT_EQ(now.track(track).SerializeAsString(), tracks[static_cast<std::size_t>(track)]);
    }
  }
  (void)ask(set_policy("c", "fixed"));
  const v1::Snapshot after = ask(snapshot("q")).accepted().snapshot();
  EXPECT_TRUE(after.policy().has_fixed());
  EXPECT_EQ(after.last_scan().policy(), "largest_variance") << "which decided that scan";
  EXPECT_FALSE(after.radar(2).up());
  EXPECT_EQ(after.status().radars_up(), 2);
  EXPECT_EQ(after.scan_period_s(), 1.0);
}

TEST_F(RunTest, PolicyListMarksTheActiveOne) {
  (void)ask(set_policy("a", "fixed:sensor=2"));
  v1::Request message = request("b");
  message.mutable_list_policies();
  const v1::PolicyList list = ask(message).accepted().policy_list();
  EXPECT_GE(list.entry_size(), 4);
  for (const v1::PolicyEntry& entry : list.entry()) EXPECT_EQ(entry.active(), entry.name() == "fixed");
  message = request("c");
  message.mutable_get_policy();
  EXPECT_EQ(ask(message).accepted().policy().fixed().sensor(), 2);
  message = request("d");
  message.mutable_get_status();
  EXPECT_EQ(ask(message).accepted().status().policy(), "fixed:sensor=2");
  EXPECT_FALSE(ask(message).accepted().status().has_wall_clock()) << "no clock in a fast run";
}

}  // namespace
}  // namespace dwell::testing
