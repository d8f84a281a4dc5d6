// A scenario: policies against each other by Monte Carlo over the engine.

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "daemon/config/config_reader.hpp"
#include "daemon/config/policy_reader.hpp"
#include "daemon/study/problem_kinds.hpp"
#include "daemon/study/report.hpp"

namespace dwell {
namespace {

std::vector<NamedPolicy> read_policies(const std::vector<std::string>& texts, const DaemonConfig& config) {
  if (texts.empty()) return {{policy_text(config.effective.policy()), config.engine.policy}};
  std::vector<NamedPolicy> policies;
  std::vector<Violation> violations;
  for (const std::string& text : texts) {
    auto message = parse_policy_text(text, violations);
    if (!message) continue;
    const auto settings = read_policy(*message, static_cast<int>(config.engine.sensors.size()),
                                      config.engine.tracker.classes.size() > 0, violations);
    if (settings) policies.push_back({text, *settings});
  }
  if (!violations.empty()) throw InvalidInput("--policies", violations);
  return policies;
}

/// Errors  InvalidInput where no scan is in the window.
void check_window(const TimeWindow& window, std::uint64_t scans, double period_s) {
  const double end_s = static_cast<double>(scans) * period_s;
  const double first_scan_s = std::max(1.0, std::ceil(window.first_s / period_s)) * period_s;
  if (window.first_s <= window.last_s && first_scan_s <= std::min(window.last_s, end_s)) return;  // false for NaN
  throw InvalidInput("--from-s, --to-s", {{"window", fmt::format("{} .. {}", window.first_s, window.last_s),
                                           fmt::format("must hold a scan: there are {} of {} s", scans, period_s)}});
}

class ScenarioReport final : public StudyReport {
 public:
  ScenarioReport(Study study, v1::Config config) : study_(std::move(study)), config_(std::move(config)) {}

  std::string table() const override { return study_table(study_); }
  std::string json() const override { return study_json(study_, true); }
  std::string csv() const override { return study_csv(study_); }
  void write(const std::filesystem::path& directory) const override { write_study(study_, config_, directory); }
  bool complete() const override { return study_.runs_done > 0; }

 private:
  Study study_;
  v1::Config config_;
};

}  // namespace

std::unique_ptr<StudyReport> study_scenario(ParsedConfig parsed, const StudyRequest& request, const StudyWatch& watch) {
  DaemonConfig config = read_config(std::move(parsed));
  const std::vector<NamedPolicy> policies = read_policies(request.policies, config);
  if (request.calibrate) {
    config.engine.policy = policies.front().settings;
    return study_calibration_of(std::move(config), request, watch);
  }
  StudyOptions options;
  options.runs = request.runs;
  options.seed = request.seed.value_or(config.engine.seed);
  options.scans = request.scans.value_or(static_cast<std::uint64_t>(config.study_scans));
  options.threads = request.threads;
  options.window = request.window;
  check_window(options.window, options.scans, to_seconds(config.engine.scan_period));
  config.effective.set_seed(options.seed);
  config.effective.set_study_scans(static_cast<std::uint32_t>(options.scans));
  Study study = run_study(config.engine, policies, options, watch.stop, watch.progress);
  if (study.runs_done < options.runs) {
    fmt::print(stderr, "\nended early: {} of {} runs\n", study.runs_done, options.runs);
  }
  return std::make_unique<ScenarioReport>(std::move(study), config.effective);
}

}  // namespace dwell
