// dwell-study: policies against each other on common random numbers.

#include <atomic>
#include <csignal>
#include <iostream>

#include <unistd.h>

#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include "daemon/config/config_reader.hpp"
#include "daemon/config/policy_reader.hpp"
#include "daemon/exit_code.hpp"
#include "daemon/study/report.hpp"

namespace dwell {
namespace {

struct Flags {
  std::string config;
  std::string policies;
  std::string format = "table";
  std::string out;
  StudyOptions study;
  std::optional<std::uint64_t> scans;
  std::optional<std::uint64_t> seed;
};

std::atomic<bool> interrupted{false};
void interrupt(int /*signal*/) { interrupted = true; }

void add_options(CLI::App& app, Flags& flags) {
  app.add_option("--config", flags.config, "scenario in protobuf text format")->required();
  app.add_option("--policies", flags.policies, "a,b:key=value,c; default: the config's");
  app.add_option("--runs", flags.study.runs, "Monte Carlo runs")->check(CLI::Range(1, 10'000'000));
  app.add_option("--seed", flags.seed, "of the first run; default: the config's");
  app.add_option("--scans", flags.scans, "of each run; default: the config's study_scans")->check(CLI::PositiveNumber);
  app.add_option("--threads", flags.study.threads, "they do not change the results")->check(CLI::Range(1, 256));
  app.add_option("--from-s", flags.study.window.first_s, "figures count from this stream time on");
  app.add_option("--to-s", flags.study.window.last_s, "and up to this one");
  app.add_option("--format", flags.format, "what is printed")->check(CLI::IsMember({"table", "json", "csv"}));
  app.add_option("--out", flags.out, "directory for results.json, results.csv, the config and the plots");
}

std::vector<NamedPolicy> read_policies(const Flags& flags, const DaemonConfig& config) {
  if (flags.policies.empty()) return {{policy_text(config.effective.policy()), config.engine.policy}};
  std::vector<NamedPolicy> policies;
  std::vector<Violation> violations;
  for (const std::string& text : CLI::detail::split(flags.policies, ',')) {
    auto message = parse_policy_text(text, violations);
    if (!message) continue;
    const auto settings = read_policy(*message, static_cast<int>(config.engine.sensors.size()), violations);
    if (settings) policies.push_back({text, *settings});
  }
  if (!violations.empty()) throw InvalidInput("--policies", violations);
  return policies;
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
    fmt::print(stderr, "\r{}/{} runs, {:.0f} s left \x1b[K{}", done, all, spent_s / done * (all - done),
               done == all ? "\r\x1b[K" : "");
    std::fflush(stderr);
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_{};
};

int run(Flags flags) {
  const DaemonConfig config = read_config_file(flags.config);
  const std::vector<NamedPolicy> policies = read_policies(flags, config);
  flags.study.seed = flags.seed.value_or(config.engine.seed);
  flags.study.scans = flags.scans.value_or(static_cast<std::uint64_t>(config.study_scans));
  std::signal(SIGINT, interrupt);
  Progress progress;
  const Study study = run_study(config.engine, policies, flags.study, interrupted, std::ref(progress));
  if (study.runs_done < flags.study.runs) {
    fmt::print(stderr, "\nended early: {} of {} runs\n", study.runs_done, flags.study.runs);
  }
  std::cout << (flags.format == "json"  ? study_json(study, true)
                : flags.format == "csv" ? study_csv(study)
                                        : study_table(study));
  if (!flags.out.empty()) write_study(study, config.effective, flags.out);
  return study.runs_done > 0 ? kDone : kFailed;
}

}  // namespace
}  // namespace dwell

int main(int argc, char** argv) {
  dwell::Flags flags;
  CLI::App app("Dwell: policies against each other by Monte Carlo, with honest intervals.", "dwell-study");
  dwell::add_options(app, flags);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? dwell::kDone : dwell::kBadCommandLine;
  }
  return dwell::report_errors("dwell-study", [&] { return dwell::run(flags); });
}
