// dwelld: the daemon. Composition only: flags, config, journal, sockets, signals, then the service's loop.

#include <chrono>
#include <csignal>
#include <cstdio>
#include <iostream>

#include <sys/signalfd.h>
#include <unistd.h>

#include <google/protobuf/stubs/logging.h>
#include <google/protobuf/text_format.h>
#include <spdlog/async.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "bandit/value_table.hpp"
#include "daemon/config/config_reader.hpp"
#include "daemon/exit_code.hpp"
#include "daemon/flags.hpp"
#include "daemon/service.hpp"
#include "daemon/summary.hpp"
#include "daemon/value_builder.hpp"

namespace dwell {
namespace {

struct Flags {
  std::string config;
  std::string record;
  std::string replay;
  bool fast = false;
  bool check_config = false;
  std::optional<std::uint64_t> scans;
  std::optional<std::uint64_t> seed;
  int wait_subscribers = 0;
};

void add_options(CLI::App& app, Flags& flags) {
  auto* config = app.add_option("--config", flags.config, "scenario in protobuf text format");
  auto* fast = app.add_flag("--fast", flags.fast, "as fast as possible instead of one scan per scan period");
  app.add_option("--scans", flags.scans, "end after so many scans")->check(whole_number(1));
  auto* seed = app.add_option("--seed", flags.seed, "instead of the config's")->check(whole_number(0));
  app.add_option("--wait-subscribers", flags.wait_subscribers,
                 "hold the first scan until so many subscriptions are there")
      ->check(whole_number(0, 1'000'000));
  auto* check = app.add_flag("--check-config", flags.check_config, "print the effective config and end");
  auto* record = app.add_option("--record", flags.record, "write a journal of the run to a new file");
  auto* replay = app.add_option("--replay", flags.replay, "repeat the run of a journal, as fast as possible");
  replay->excludes(config)->excludes(record)->excludes(seed)->excludes(check)->excludes(fast);
}

/// A descriptor that becomes readable on the first SIGTERM or SIGINT; a second one ends the process at once.
int catch_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  sigprocmask(SIG_BLOCK, &set, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
}

void release_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  sigprocmask(SIG_UNBLOCK, &set, nullptr);
}

/// The run that the flags ask for: from a config file, or from a journal.
struct Plan {
  DaemonConfig config;
  std::filesystem::path directory;
  ServiceOptions options;
};

Plan plan_replay(const Flags& flags) {
  Journal journal = read_journal(flags.replay);
  Plan plan;
  plan.directory = journal.header.config_directory();
  plan.config = read_config(journal.header.config(), flags.replay, plan.directory);
  plan.options.fast = true;
  plan.options.replaying = true;
  plan.options.replay = std::move(journal.requests);
  plan.options.late = std::move(journal.late);
  plan.options.scans = flags.scans;
  if (!flags.scans && journal.end) plan.options.scans = journal.end->scan();
  if (journal.end && plan.options.scans == journal.end->scan()) plan.options.end_reason = journal.end->reason();
  if (!plan.options.scans) {
    throw InvalidInput(flags.replay, {{"end", "", "is missing, the run was cut off: say how many --scans to repeat"}});
  }
  return plan;
}

Plan make_plan(const Flags& flags) {
  Plan plan;
  if (!flags.replay.empty()) {
    plan = plan_replay(flags);
  } else {
    plan.config = read_config_file(flags.config);
    plan.directory = std::filesystem::absolute(flags.config).parent_path();
    plan.options.fast = flags.fast;
    plan.options.scans = flags.scans;
    if (flags.seed) {
      plan.config.engine.seed = *flags.seed;
      plan.config.effective.set_seed(*flags.seed);
    }
  }
  plan.options.wait_subscribers = flags.wait_subscribers;
  const auto on_due = plan.options.fast ? ValueTable::OnDue::kBuild : ValueTable::OnDue::kGoOn;
  plan.config.engine.value_table = std::make_shared<ValueTable>(on_due);
  return plan;
}

std::unique_ptr<JournalWriter> open_journal(const Flags& flags, const Plan& plan) {
  if (flags.record.empty()) return nullptr;
  v1::JournalHeader header;
  *header.mutable_config() = plan.config.effective;
  header.set_config_directory(plan.directory.string());
  return std::make_unique<JournalWriter>(flags.record, header);
}

/// Different at every start, and growing: nanoseconds since 1970.
std::uint64_t new_epoch() {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
          .count());
}

void print(const std::string& text) {
  if (!(std::cout << text << std::flush)) throw std::runtime_error("cannot write to standard output");
}

void serve(const Flags& flags, const Plan& plan, int signals) {
  zmq::context_t context;
  Publisher publisher(context, plan.config.stream_bind, plan.config.stream_high_water_mark);
  ControlSocket control(context, plan.config.control_bind);
  const auto journal = open_journal(flags, plan);
  Run run(plan.config, publisher, new_epoch(), journal.get());
  Service service(run, publisher, control, signals, plan.options);
  spdlog::info("stream {}, control {}, {} sensors, {} targets, policy {}", publisher.endpoint(), control.endpoint(),
               plan.config.engine.sensors.size(), plan.config.engine.targets.size(), run.engine().policy_name());
  const ValueBuilder builder(*plan.config.engine.value_table);
  Summary summary;
  service.loop([&](const Engine& engine) { summary.add(engine); });
  release_signals();
  print(summary.text(run.engine()));
}

int run(const Flags& flags, int signals) {
  const Plan plan = make_plan(flags);
  if (flags.check_config) {
    std::string text;
    google::protobuf::TextFormat::PrintToString(plan.config.effective, &text);
    print(text);
    return kDone;
  }
  serve(flags, plan, signals);
  return kDone;
}

}  // namespace
}  // namespace dwell

int main(int argc, char** argv) {
  using namespace dwell;
  Flags flags;
  CLI::App app("Dwell: chooses which radar looks at which target, tracks, and streams both.", "dwelld");
  add_options(app, flags);
  try {
    app.parse(argc, argv);
    if (flags.config.empty() && flags.replay.empty()) throw CLI::RequiredError("--config or --replay");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kBadCommandLine;
  }
  const int signals = catch_signals();  // before any thread starts: they inherit what is blocked
  // Garbage on the control port is counted, not printed line by line.
  google::protobuf::SetLogHandler(nullptr);
  spdlog::set_default_logger(spdlog::create_async<spdlog::sinks::stderr_color_sink_mt>("dwelld"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
  const int code = report_errors("dwelld", [&] { return run(flags, signals); });
  spdlog::shutdown();
  return code;
}
