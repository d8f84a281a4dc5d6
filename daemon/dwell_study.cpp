// dwell-study: policies against each other on one problem, on common random numbers.

#include <atomic>
#include <csignal>
#include <iostream>

#include <unistd.h>

#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include "daemon/exit_code.hpp"
#include "daemon/flags.hpp"
#include "daemon/study/problem_kinds.hpp"

namespace dwell {
namespace {

struct Flags {
  std::string config;
  std::string replay;
  std::string policies;
  std::string format = "table";
  std::string out;
  StudyRequest request;
};

std::atomic<bool> interrupted{false};
/// The first asks for what is finished, the second ends the program.
void interrupt(int signal) {
  interrupted = true;
  std::signal(signal, SIG_DFL);
}

void add_options(CLI::App& app, Flags& flags) {
  StudyRequest& request = flags.request;
  auto* config = app.add_option("--config", flags.config, "scenario or scheduling problem in protobuf text format");
  auto* replay =
      app.add_option("--replay", flags.replay, "the run of a journal, in the place of a config: --calibrate");
  auto* policies = app.add_option("--policies", flags.policies, "a,b:key=value,c; default: the config's")
                       ->check([](const std::string& text) {
                         return text.empty() ? std::string("must name a policy, or be left out") : std::string();
                       });
  auto* seed =
      app.add_option("--seed", request.seed, "of the first run; default: the config's")->check(whole_number(0));
  app.add_option("--runs", request.runs, "Monte Carlo runs")->check(whole_number(1, 10'000'000))->capture_default_str();
  app.add_option("--scans", request.scans, "of each run of a scenario; default: the config's study_scans")
      ->check(whole_number(1));
  app.add_option("--threads", request.threads, "of a scenario; they do not change the results")
      ->check(whole_number(1, 256));
  app.add_option("--from-s", request.window.first_s, "figures of a scenario count from this stream time on");
  app.add_option("--to-s", request.window.last_s, "and up to this one");
  auto* calibrate = app.add_option("--calibrate", request.calibrate,
                                   "what calibration knows of a scenario's radars, against their truth")
                        ->check(CLI::IsMember({"joint", "innovations"}));
  app.add_flag("--known-flights", request.known_flights, "every target is a calibration flight")->needs(calibrate);
  replay->needs(calibrate)->excludes(config)->excludes(policies)->excludes(seed);
  app.add_option("--format", flags.format, "what is printed")->check(CLI::IsMember({"table", "json", "csv"}));
  app.add_option("--out", flags.out, "directory for results.json, results.csv, the config and the plots");
}

/// One line, redrawn, with the time that is left; nothing where nobody looks.
class Progress {
 public:
  void operator()(int done, int all) {
    if (isatty(STDERR_FILENO) == 0) return;
    const auto now = std::chrono::steady_clock::now();
    if (done < all && now - last_ < std::chrono::milliseconds(200)) return;
    last_ = now;
    const double spent_s = std::chrono::duration<double>(now - start_).count();
    fmt::print(stderr, "\r{}/{}, {:.0f} s left \x1b[K{}", done, all, spent_s / done * (all - done),
               done == all ? "\r\x1b[K" : "");
    std::fflush(stderr);
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_{};
};

int run(Flags flags) {
  if (!flags.policies.empty()) flags.request.policies = CLI::detail::split(flags.policies, ',');
  std::signal(SIGINT, interrupt);
  const StudyWatch watch{interrupted, Progress()};
  std::unique_ptr<StudyReport> report;
  if (flags.replay.empty()) {
    ParsedConfig config = parse_config_file(flags.config);
    const ProblemKind& kind = kind_of(config.message);
    report = kind.study(std::move(config), flags.request, watch);
  } else {
    report = study_journal(flags.replay, flags.request, watch);
  }
  std::cout << (flags.format == "json" ? report->json() : flags.format == "csv" ? report->csv() : report->table());
  if (!std::cout.flush()) throw std::runtime_error("cannot write to standard output");
  if (!flags.out.empty()) report->write(flags.out);
  return report->complete() ? kDone : kFailed;
}

}  // namespace
}  // namespace dwell

int main(int argc, char** argv) {
  dwell::Flags flags;
  CLI::App app("Dwell: policies against each other on a scenario or a scheduling problem.", "dwell-study");
  dwell::add_options(app, flags);
  try {
    app.parse(argc, argv);
    if (flags.config.empty() && flags.replay.empty()) throw CLI::RequiredError("--config or --replay");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? dwell::kDone : dwell::kBadCommandLine;
  }
  return dwell::report_errors("dwell-study", [&] { return dwell::run(flags); });
}
