// What calibration knows of a scenario's radars: `dwell-study --calibrate`.

#include <cmath>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "bandit/value_table.hpp"
#include "daemon/config/config_reader.hpp"
#include "daemon/config/policy_reader.hpp"
#include "daemon/journal.hpp"
#include "daemon/run.hpp"
#include "daemon/study/calibration_figures.hpp"
#include "daemon/study/problem_kinds.hpp"

namespace dwell {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kNames[kCorrectionSize] = {"log_range_noise_scale", "log_azimuth_noise_scale", "range_bias_m",
                                                 "azimuth_bias_deg", "time_bias_s"};
constexpr double kUnits[kCorrectionSize] = {1.0, 1.0, 1.0, kDegree, 1.0};

Json json_of(const CalibratedRadar& radar, int kind, int solved) {
  const CalibratedParameter& p = radar.parameters[kind];
  const double unit = kUnits[kind];
  return {{"radar", radar.name},
          {"parameter", kNames[kind]},
          {"truth", p.truth / unit},
          {"mean", p.mean / unit},
          {"rms_error", std::sqrt(p.squared_error) / unit},
          {"standard_error", p.standard_error / unit},
          {"bound", p.bound / unit},
          {"bound_error", p.bound_error / unit},
          {"misspecified", p.misspecified / unit},
          {"within_2", static_cast<double>(p.within_two) / solved},
          {"within_3", static_cast<double>(p.within_three) / solved},
          {"observable", static_cast<double>(p.observable) / solved}};
}

class CalibrationReport final : public StudyReport {
 public:
  CalibrationReport(CalibrationFigures figures, const CalibrationStudyOptions& options, v1::Config config)
      : figures_(std::move(figures)), options_(options), config_(std::move(config)) {}

  std::string table() const override {
    std::string text = fmt::format("{} runs of {} scans, seed {}, {}: {} with a result{}\n\n", figures_.runs,
                                   options_.scans, options_.seed, method(), figures_.solved,
                                   figures_.failure.empty() ? "" : " (" + figures_.failure + ")");
    text += fmt::format("{:<14} {:<24} {:>9} {:>9} {:>10} {:>9} {:>9} {:>8} {:>8}  {}\n", "radar", "parameter", "truth",
                        "mean", "rms error", "reported", "bound", "within 2", "within 3", "observable");
    for (const Json& row : rows()) {
      const double seen = row["observable"];
      text +=
          fmt::format("{:<14} {:<24} {:>9.4g} {:>9.4g} {:>10.3g} {:>9.3g} {:>9.3g} {:>8.3f} {:>8.3f}  {}\n",
                      row["radar"].get<std::string>(), row["parameter"].get<std::string>(), row["truth"].get<double>(),
                      row["mean"].get<double>(), row["rms_error"].get<double>(), row["standard_error"].get<double>(),
                      row["bound"].get<double>(), row["within_2"].get<double>(), row["within_3"].get<double>(),
                      seen == 1.0   ? "yes"
                      : seen == 0.0 ? "no"
                                    : fmt::format("in {:.0f} %", 100.0 * seen));
    }
    text += fmt::format("\n{:<14} {:>6} {:>11} {:>10} {:>15} {:>14}\n", "radar", "plots", "NIS before", "NIS after",
                        "in band before", "in band after");
    for (const CalibratedRadar& radar : figures_.radars) {
      text += fmt::format("{:<14} {:>6.0f} {:>11.2f} {:>10.2f} {:>15.2f} {:>14.2f}\n", radar.name, radar.plots,
                          radar.nis_before, radar.nis_after, share(radar.in_band_before), share(radar.in_band_after));
    }
    return text;
  }

  std::string json() const override {
    Json radars = Json::array();
    for (const CalibratedRadar& radar : figures_.radars) {
      radars.push_back({{"radar", radar.name},
                        {"plots", radar.plots},
                        {"nis_before", radar.nis_before},
                        {"nis_after", radar.nis_after},
                        {"in_band_before", share(radar.in_band_before)},
                        {"in_band_after", share(radar.in_band_after)}});
    }
    const Json all = {{"method", method()},      {"runs", figures_.runs},     {"seed", options_.seed},
                      {"scans", options_.scans}, {"solved", figures_.solved}, {"failure", figures_.failure},
                      {"parameters", rows()},    {"radars", radars}};
    return all.dump(2) + "\n";
  }

  std::string csv() const override {
    std::string text;
    for (const Json& row : rows()) {
      std::string names;
      std::string values;
      for (const auto& [name, value] : row.items()) {
        names += (names.empty() ? "" : ",") + name;
        values += (values.empty() ? "" : ",") + (value.is_string() ? value.get<std::string>() : value.dump());
      }
      if (text.empty()) text = names + "\n";
      text += values + "\n";
    }
    return text;
  }

  void write(const std::filesystem::path& directory) const override {
    std::filesystem::create_directories(directory);
    write_file(directory / "results.json", json());
    write_file(directory / "results.csv", csv());
    write_config(directory, config_);
  }

  bool complete() const override { return figures_.solved > 0; }

 private:
  const char* method() const { return options_.joint ? "joint" : "innovations"; }
  double share(int count) const { return figures_.solved > 0 ? static_cast<double>(count) / figures_.solved : 0.0; }

  std::vector<Json> rows() const {
    std::vector<Json> all;
    for (const CalibratedRadar& radar : figures_.radars) {
      for (int kind = 0; kind < kCorrectionSize && figures_.solved > 0; ++kind) {
        all.push_back(json_of(radar, kind, figures_.solved));
      }
    }
    return all;
  }

  CalibrationFigures figures_;
  CalibrationStudyOptions options_;
  v1::Config config_;
};

void know_flights(EngineConfig& config) {
  for (TargetConfig& target : config.targets) target.calibration_flight = true;
}

class Nowhere final : public Sink {
 public:
  void send(std::string_view /*topic*/, std::string_view /*envelope*/) override {}
};

/// The config of a journal, such that its run comes out the same. A run that applied what it had learned depends on its
/// window and on what it was told of the flights; one that did not may keep all plots.
DaemonConfig config_of(const Journal& journal, const std::string& file, std::uint64_t scans, bool known_flights) {
  DaemonConfig config = read_config(journal.header.config(), file, journal.header.config_directory());
  CalibrationSettings& calibration = config.engine.calibration;
  if (calibration.mode != CalibrationMode::kApply) {
    calibration.mode = CalibrationMode::kObserve;
    calibration.window_plots = window_of(config.engine, scans);
    if (known_flights) know_flights(config.engine);
  } else if (known_flights) {
    throw InvalidInput(file, {{"calibration.mode", "APPLY", "must be OBSERVE or OFF with --known-flights"}});
  }
  config.engine.value_table = std::make_shared<ValueTable>(ValueTable::OnDue::kBuild);
  return config;
}

}  // namespace

std::unique_ptr<StudyReport> study_journal(const std::string& file, const StudyRequest& request,
                                           const StudyWatch& watch) {
  Journal journal = read_journal(file);
  CalibrationStudyOptions options;
  options.runs = 1;
  options.joint = *request.calibrate == "joint";
  if (!request.scans && !journal.end) {
    throw InvalidInput(file, {{"end", "", "is missing, the run was cut off: say how many --scans to repeat"}});
  }
  options.scans = request.scans ? *request.scans : journal.end->scan();
  const DaemonConfig config = config_of(journal, file, options.scans, request.known_flights);
  options.seed = config.engine.seed;
  Nowhere nowhere;
  Run run(config, nowhere, 0, nullptr);
  run.set_replaying(std::move(journal.late));
  for (std::size_t next = 0; run.scans() < options.scans && !watch.stop;) {
    for (; next < journal.requests.size() && journal.requests[next].scan() <= run.scans() + 1; ++next) {
      (void)run.replay(journal.requests[next].request());  // what the run refused it refuses again
    }
    run.scan();
    watch.progress(static_cast<int>(run.scans()), static_cast<int>(options.scans));
  }
  options.scans = run.scans();
  return std::make_unique<CalibrationReport>(calibration_of(run.engine(), options.joint), options, config.effective);
}

std::unique_ptr<StudyReport> study_calibration_of(DaemonConfig config, const StudyRequest& request,
                                                  const StudyWatch& watch) {
  if (request.policies.size() > 1) {
    throw InvalidInput("--policies",
                       {{"policies", std::to_string(request.policies.size()), "must be one at most with --calibrate"}});
  }
  if (request.known_flights) know_flights(config.engine);
  CalibrationStudyOptions options;
  options.runs = request.runs;
  options.seed = request.seed.value_or(config.engine.seed);
  options.scans = request.scans.value_or(static_cast<std::uint64_t>(config.study_scans));
  options.threads = request.threads;
  options.joint = *request.calibrate == "joint";
  return std::make_unique<CalibrationReport>(study_calibration(config.engine, options, watch.stop, watch.progress),
                                             options, config.effective);
}

}  // namespace dwell
