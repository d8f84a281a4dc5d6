#include "daemon/config/config_reader.hpp"

#include <regex>
#include <set>

#include "daemon/config/policy_reader.hpp"
#include "daemon/config/sections.hpp"

namespace dwell {
namespace {

/// An endpoint that only this machine can reach: nobody is authenticated. By number, as libzmq binds no host names.
void read_endpoint(FieldReader in, std::string& endpoint) {
  in.text("bind", endpoint);
  static const std::regex path(R"(ipc://.+)");
  static const std::regex loopback(R"(tcp://127(?:\.[0-9]{1,3}){3}:(0|[1-9][0-9]{0,4}))");
  std::smatch match;
  if (std::regex_match(endpoint, path)) return;
  if (std::regex_match(endpoint, match, loopback) && std::stoi(match[1]) <= 65535) return;
  in.refuse("bind", in.value("bind"), "must be ipc://PATH or tcp://127.x.x.x:PORT: there is no authentication");
}

class ConfigReader {
 public:
  ConfigReader(DaemonConfig& config, const FieldReader::Locations* locations, const std::filesystem::path& directory)
      : config_(config), engine_(config.engine), top_(config.effective, locations, violations_), shelf_(directory) {}

  std::vector<Violation> read() {
    if (const std::string problem = problem_of(config_.effective); !problem.empty()) {
      top_.refuse(problem.c_str(), "", "is a problem for dwell-study, and no scenario");
      return std::move(violations_);
    }
    read_run();
    if (top_.has("classes")) engine_.tracker.classes = read_classes(top_.child("classes"));
    read_tracker(top_.child("tracker"), engine_);
    read_sensors();
    read_targets();
    read_calibration(top_.child("calibration"), engine_.calibration);
    FieldReader policy = top_.child("policy");
    if (config_.effective.policy().kind_case() == v1::Policy::KIND_NOT_SET) {
      config_.effective.mutable_policy()->mutable_sa_imm();
    }
    const bool has_classes = top_.has("classes");
    const auto settings =
        read_policy(*config_.effective.mutable_policy(), policy, static_cast<int>(engine_.sensors.size()), has_classes);
    if (settings) engine_.policy = *settings;
    FieldReader stream = top_.child("stream");
    read_endpoint(stream, config_.stream_bind);
    stream.integer("high_water_mark", 1, 100'000'000, config_.stream_high_water_mark);
    read_endpoint(top_.child("control"), config_.control_bind);
    return std::move(violations_);
  }

 private:
  void read_run() {
    double period_s = to_seconds(engine_.scan_period);
    top_.number("scan_period_s", within(1e-3, 3600.0), 1.0, period_s);
    engine_.scan_period = from_seconds(period_s);
    if (config_.effective.has_seed()) engine_.seed = config_.effective.seed();
    config_.effective.set_seed(engine_.seed);
    top_.integer("study_scans", 1, 1'000'000, config_.study_scans);
  }

  void read_sensors() {
    const int radars = top_.count("radar");
    const int linear = top_.count("linear_sensor");
    if (radars + linear == 0) top_.refuse("radar", "", "one radar or linear_sensor at least is required");
    std::set<std::string> names;
    const auto add = [&](const char* field, int index, SensorConfig sensor) {
      if (!sensor.name.empty() && !names.insert(sensor.name).second) {
        top_.element(field, index).refuse("name", "\"" + sensor.name + "\"", "must be unique among the sensors");
      }
      engine_.sensors.push_back(std::move(sensor));
    };
    const Duration period = engine_.scan_period;
    for (int i = 0; i < radars; ++i)
      add("radar", i, read_radar(top_.element("radar", i), period, engine_.tracker.classes));
    for (int i = 0; i < linear; ++i) {
      add("linear_sensor", i, read_linear_sensor(top_.element("linear_sensor", i), period, engine_.tracker.classes));
    }
    top_.integer("looks_per_scan", 1, std::max(1, radars + linear), engine_.looks_per_scan);
    top_.integer("max_wait_turns", 0, 1'000'000, engine_.max_wait_turns);
  }

  void read_targets() {
    if (top_.count("target") == 0) top_.refuse("target", "", "one target at least is required");
    std::set<std::string> names;
    for (int i = 0; i < top_.count("target"); ++i) {
      engine_.targets.push_back(read_target(top_.element("target", i), engine_, shelf_, violations_));
      const std::string& name = engine_.targets.back().name;
      if (!name.empty() && !names.insert(name).second) {
        top_.element("target", i).refuse("name", "\"" + name + "\"", "must be unique among the targets");
      }
    }
  }

  DaemonConfig& config_;
  EngineConfig& engine_;
  std::vector<Violation> violations_;
  FieldReader top_;
  RecordingShelf shelf_;
};

}  // namespace

DaemonConfig read_config(ParsedConfig parsed) {
  DaemonConfig config;
  config.effective = std::move(parsed.message);
  std::vector<Violation> violations = ConfigReader(config, parsed.locations.get(), parsed.directory).read();
  if (!violations.empty()) throw InvalidInput(parsed.source, std::move(violations));
  return config;
}

DaemonConfig read_config_file(const std::filesystem::path& file) { return read_config(parse_config_file(file)); }

DaemonConfig read_config_text(const std::string& text, const std::string& source,
                              const std::filesystem::path& directory) {
  return read_config(parse_config_text(text, source, directory));
}

DaemonConfig read_config(const v1::Config& config, const std::string& source, const std::filesystem::path& directory) {
  return read_config(ParsedConfig{config, nullptr, source, directory});
}

}  // namespace dwell
