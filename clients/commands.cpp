#include "clients/commands.hpp"

#include <fmt/format.h>

#include <ostream>
#include <stdexcept>
#include <string>

#include "clients/explain.hpp"
#include "clients/format.hpp"

namespace dwell::client {
namespace {

constexpr int kFailed = 1;

void require(bool held) {
  if (!held) throw std::runtime_error("the daemon's answer does not hold what was asked for; is it another version?");
}

std::string active_policy(ControlClient& control) {
  v1::Request request;
  request.mutable_get_policy();
  const v1::Reply reply = control.ask(std::move(request));
  return reply.accepted().has_policy() ? policy_text(reply.accepted().policy()) : "unknown";
}

Lines policy_set_lines(const v1::Accepted& accepted, const CommandLine& line, const std::string& before) {
  // The daemon's own reading of the policy, where it sends it, with the defaults filled in.
  const std::string after = accepted.has_policy() ? policy_text(accepted.policy()) : line.request.set_policy().text();
  return {{fmt::format("policy {} -> {} from scan {}", before, after, accepted.effective_scan())}};
}

/// The answer to a command that has no more to say than when it takes effect.
std::string done_text(const CommandLine& line) {
  switch (line.verb) {
    case Verb::kPause:
      return "paused";
    case Verb::kResume:
      return "running";
    case Verb::kStep:
      return fmt::format("{} scan{} to run,", line.request.step().scans(), line.request.step().scans() == 1 ? "" : "s");
    case Verb::kRadarDown:
    case Verb::kRadarUp:
      return fmt::format("radar {} {}", line.request.set_radar().name(), line.verb == Verb::kRadarUp ? "up" : "down");
    default:
      return "stopping";
  }
}

Lines answer_lines(const CommandLine& line, const v1::Accepted& accepted, const std::string& before, const Page& page) {
  switch (line.verb) {
    case Verb::kStatus:
      require(accepted.has_status());
      return format_status(accepted.status());
    case Verb::kExplain:
      require(accepted.has_snapshot());
      return explain(accepted.snapshot(), page);
    case Verb::kSnapshot:
      require(accepted.has_snapshot());
      return format_snapshot(accepted.snapshot(), page);
    case Verb::kPolicyList:
      require(accepted.has_policy_list());
      return format_policies(accepted.policy_list(), page);
    case Verb::kPolicyGet:
      require(accepted.has_policy());
      return {{policy_text(accepted.policy())}};
    case Verb::kPolicySet:
      return policy_set_lines(accepted, line, before);
    case Verb::kCalibrate: {
      require(accepted.has_radar_list());
      Lines lines = format_calibration(accepted.radar_list(), page);
      lines.push_back({fmt::format("a solve has begun; it takes effect at scan {}", accepted.effective_scan())});
      return lines;
    }
    case Verb::kRadarList:
      require(accepted.has_radar_list());
      return format_radars(accepted.radar_list(), page);
    default:
      return {{fmt::format("{} from scan {}", done_text(line), accepted.effective_scan())}};
  }
}

}  // namespace

int run_command(const CommandLine& line, ControlClient& control, const Output& output) {
  const std::string before = line.verb == Verb::kPolicySet && !line.json ? active_policy(control) : "";
  const v1::Reply reply = control.ask(line.request);
  if (line.json) output.out << json(reply) << "\n";
  if (!reply.has_accepted()) {
    for (const Line& refusal : format_refusal(reply.refused())) output.err << refusal.text << "\n";
    return kFailed;
  }
  if (line.json) return 0;
  for (const Line& text : answer_lines(line, reply.accepted(), before, output.page)) {
    output.out << paint(text, output.page.columns, output.colour) << "\n";
  }
  return 0;
}

}  // namespace dwell::client
