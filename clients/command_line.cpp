#include "clients/command_line.hpp"

#include <CLI/CLI.hpp>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

namespace dwell::client {
namespace {

constexpr int kBadCommandLine = 2;

/// The values that are not flags of their own, as CLI11 fills them in.
struct Values {
  double timeout_s = 2;
  std::uint32_t scans = 1;
  std::string radar;
  std::string policy;
  std::vector<std::string> parameters;
};

const CLI::Validator kEndpoint(
    [](const std::string& text) {
      const bool known = text.starts_with("tcp://") || text.starts_with("ipc://");
      return known && text.size() > 6 ? std::string() : "'" + text + "' is not tcp://HOST:PORT or ipc://PATH";
    },
    "");

// CLI::Range lets what is not a number through.
const CLI::Validator kTimeout(
    [](const std::string& text) {
      double seconds = 0;
      const bool good = CLI::detail::lexical_cast(text, seconds) && seconds >= 0.001 && seconds <= 3600;
      return good ? std::string() : "'" + text + "' is not in 0.001 .. 3600";
    },
    "");

const CLI::Validator kParameter(
    [](const std::string& text) {
      const std::size_t equals = text.find('=');
      const bool good = equals != std::string::npos && equals > 0 && equals + 1 < text.size() &&
                        text.find_first_of(":,") == std::string::npos;
      return good ? std::string() : "'" + text + "' is not key=value";
    },
    "");

void add_options(CLI::App& app, CommandLine& line, Values& values) {
  app.add_option("--control", line.control.endpoint, "Endpoint of the daemon's commands")
      ->check(kEndpoint)
      ->type_name("ENDPOINT")
      ->capture_default_str();
  app.add_option("--stream", line.stream, "Endpoint of the daemon's stream")
      ->check(kEndpoint)
      ->type_name("ENDPOINT")
      ->capture_default_str();
  app.add_flag("--json", line.json, "Print the answer as JSON; watch: each message of the stream on a line");
  app.add_option("--timeout", values.timeout_s, "Seconds to wait for an answer, each of three times")
      ->check(kTimeout)
      ->type_name("S")
      ->capture_default_str();
}

/// `fill` makes the request; it is called when the whole command line has been read.
CLI::App* add_verb(CLI::App& parent, const char* name, const char* what, CommandLine& line, Verb verb,
                   std::function<void(v1::Request&)> fill) {
  CLI::App* sub = parent.add_subcommand(name, what);
  sub->fallthrough();  // so that --json may stand behind the command too
  sub->callback([&line, verb, fill = std::move(fill)] {
    line.verb = verb;
    fill(line.request);
  });
  return sub;
}

void ask_snapshot(v1::Request& request) { request.mutable_get_snapshot(); }

void add_verbs(CLI::App& app, CommandLine& line, Values& values) {
  add_verb(app, "status", "What the daemon is doing", line, Verb::kStatus,
           [](v1::Request& request) { request.mutable_get_status(); });
  add_verb(app, "watch", "Follow the tracks and decisions; q or Ctrl-C ends it", line, Verb::kWatch, ask_snapshot);
  add_verb(app, "explain", "Why the last scan looked where it looked", line, Verb::kExplain, ask_snapshot);
  add_verb(app, "snapshot", "All tracks as they are now", line, Verb::kSnapshot, ask_snapshot);
  add_verb(app, "pause", "Stop before the next scan", line, Verb::kPause,
           [](v1::Request& request) { request.mutable_pause(); });
  add_verb(app, "resume", "Go on after a pause", line, Verb::kResume,
           [](v1::Request& request) { request.mutable_resume(); });
  add_verb(app, "step", "Run scans while paused", line, Verb::kStep,
           [&values](v1::Request& request) { request.mutable_step()->set_scans(values.scans); })
      ->add_option("N", values.scans, "How many")
      ->check(CLI::Range(1u, 1'000'000u))
      ->capture_default_str();
  add_verb(app, "calibrate", "Solve for trajectories, noise and biases jointly now; show what is known", line,
           Verb::kCalibrate, [](v1::Request& request) { request.mutable_calibrate(); });
  add_verb(app, "stop", "End the run and the daemon", line, Verb::kStop,
           [](v1::Request& request) { request.mutable_stop(); });
}

void add_policy_verbs(CLI::App& app, CommandLine& line, Values& values) {
  CLI::App* policy = app.add_subcommand("policy", "List, show or change the policy")->fallthrough();
  policy->require_subcommand(1);
  add_verb(*policy, "list", "The policies and their parameters", line, Verb::kPolicyList,
           [](v1::Request& request) { request.mutable_list_policies(); });
  add_verb(*policy, "get", "The policy in use", line, Verb::kPolicyGet,
           [](v1::Request& request) { request.mutable_get_policy(); });
  CLI::App* set = add_verb(*policy, "set", "Use another policy from the next scan on", line, Verb::kPolicySet,
                           [&values](v1::Request& request) {
                             std::string text = values.policy;
                             for (const std::string& parameter : values.parameters) text += ":" + parameter;
                             request.mutable_set_policy()->set_text(text);
                           });
  set->add_option("NAME", values.policy, "As `policy list` names it")->required();
  set->add_option("PARAMETER", values.parameters, "key=value ...")->check(kParameter);
}

void add_radar_verbs(CLI::App& app, CommandLine& line, Values& values) {
  CLI::App* radar = app.add_subcommand("radar", "List the radars, take one out of use or back")->fallthrough();
  radar->require_subcommand(1);
  add_verb(*radar, "list", "The radars and how often they looked", line, Verb::kRadarList,
           [](v1::Request& request) { request.mutable_list_radars(); });
  const auto set = [&](const char* name, const char* what, Verb verb, bool up) {
    add_verb(*radar, name, what, line, verb,
             [&values, up](v1::Request& request) {
               request.mutable_set_radar()->set_name(values.radar);
               request.mutable_set_radar()->set_up(up);
             })
        ->add_option("NAME", values.radar, "As `radar list` names it")
        ->required();
  };
  set("down", "Take a radar out of use", Verb::kRadarDown, false);
  set("up", "Take a radar back into use", Verb::kRadarUp, true);
}

}  // namespace

std::variant<CommandLine, int> parse_command_line(int argc, const char* const* argv) {
  CommandLine line;
  Values values;
  CLI::App app("Commands dwelld, the radar resource manager, and shows what it does.", "dwellctl");
  app.require_subcommand(1);
  add_options(app, line, values);
  add_verbs(app, line, values);
  add_policy_verbs(app, line, values);
  add_radar_verbs(app, line, values);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RequiredError& error) {
    // CLI11 says that a command is missing where an unknown one was given.
    const std::vector<std::string> unknown = app.remaining(true);
    if (unknown.empty()) return app.exit(error), kBadCommandLine;
    std::cerr << "there is no command '" << unknown.front() << "' here\nRun with --help for more information.\n";
    return kBadCommandLine;
  } catch (const CLI::ParseError& error) {
    // CLI11 prints the help or the error; its own codes say which, ours only whether.
    return app.exit(error) == 0 ? 0 : kBadCommandLine;
  }
  line.control.timeout = std::chrono::milliseconds(std::lround(std::ceil(values.timeout_s * 1e3)));
  return line;
}

}  // namespace dwell::client
