#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "clients/commands.hpp"
#include "tests/clients/fake_daemon.hpp"

namespace dwell::client {
namespace {

constexpr const char* kEndpoint = "inproc://control";

v1::Reply answer(const v1::Request& request, int) {
  v1::Reply reply = accepted(request, 43);
  if (request.has_get_policy()) reply.mutable_accepted()->mutable_policy()->mutable_round_robin();
  if (request.has_get_snapshot()) *reply.mutable_accepted()->mutable_snapshot() = snapshot(2);
  if (request.has_set_radar() && request.set_radar().name() == "nowhere") {
    v1::Violation& violation = *reply.mutable_refused()->add_violation();
    reply.mutable_refused()->set_reason(v1::Refused::INVALID);
    violation.set_field("name");
    violation.set_value("nowhere");
    violation.set_rule("must be one of west, east");
  }
  return reply;
}

struct Result {
  int code;
  std::string out;
  std::string err;
};

Result run(const CommandLine& line, int requests = 1) {
  zmq::context_t context;
  FakeControl daemon(context, kEndpoint, requests, answer);
  ControlClient control(context, {.endpoint = kEndpoint, .timeout = std::chrono::milliseconds(kPatienceMs)});
  std::ostringstream out;
  std::ostringstream err;
  const int code = run_command(line, control, {out, err, Page(), false});
  return {code, out.str(), err.str()};
}

TEST(Commands, PolicySetSaysWhatChangedAndWhen) {
  CommandLine line{.verb = Verb::kPolicySet};
  line.request.mutable_set_policy()->set_text("sa_imm:cost=x");
  const Result result = run(line, 2);  // it asks for the old policy first
  EXPECT_EQ(result.out, "policy round_robin -> sa_imm:cost=x from scan 43\n");
  EXPECT_EQ(result.code, 0);
}

TEST(Commands, SayWhenTheyTakeEffect) {
  CommandLine line{.verb = Verb::kRadarDown};
  line.request.mutable_set_radar()->set_name("west");
  EXPECT_EQ(run(line).out, "radar west down from scan 43\n");
  line = {.verb = Verb::kPause};
  line.request.mutable_pause();
  EXPECT_EQ(run(line).out, "paused from scan 43\n");
}

TEST(Commands, ARefusalIsOneWithItsViolationsOnStandardError) {
  CommandLine line{.verb = Verb::kRadarUp};
  line.request.mutable_set_radar()->set_name("nowhere");
  const Result result = run(line);
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err, "refused: invalid\n  name = nowhere: must be one of west, east\n");
}

TEST(Commands, JsonIsTheReplyOnOneLine) {
  CommandLine line{.verb = Verb::kSnapshot};
  line.request.mutable_get_snapshot();
  line.json = true;
  const Result result = run(line);
  EXPECT_EQ(result.out.find('\n'), result.out.size() - 1);
  const auto parsed = nlohmann::json::parse(result.out);
  EXPECT_EQ(parsed.at("accepted").at("snapshot").at("track").size(), 2u);
  EXPECT_EQ(parsed.at("accepted").at("effective_scan"), "43");
}

TEST(Commands, AnAnswerWithoutItsContentIsAnError) {
  CommandLine line{.verb = Verb::kStatus};
  line.request.mutable_get_status();
  EXPECT_THROW(run(line), std::runtime_error);
}

}  // namespace
}  // namespace dwell::client
