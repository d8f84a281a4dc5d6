#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/config/config_reader.hpp"
#include "daemon/run.hpp"

namespace dwell::testing {

inline const std::string kScenarios = std::string(DWELL_SOURCE_DIR) + "/daemon/scenarios/";

inline DaemonConfig config_of(const std::string& text) { return read_config_text(text, "test", kScenarios); }

inline std::vector<Violation> violations_of(const std::string& text) {
  try {
    (void)config_of(text);
  } catch (const InvalidInput& error) {
    return error.violations();
  }
  return {};
}

/// The violations, one a line, as a user sees them.
inline std::string refusal_of(const std::string& text) {
  try {
    (void)config_of(text);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream input(path, std::ios::binary);
  std::ostringstream text;
  text << input.rdbuf();
  return text.str();
}

inline void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// An empty directory of this test's own, removed at its end.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "dwell_test.XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
    path_ = name;
  }
  ~TemporaryDirectory() { std::filesystem::remove_all(path_); }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Keeps what a stream sends.
class Recorder final : public Sink {
 public:
  void send(std::string_view topic, std::string_view envelope) override {
    topics.emplace_back(topic);
    envelopes.emplace_back();
    ASSERT_TRUE(envelopes.back().ParseFromArray(envelope.data(), static_cast<int>(envelope.size())));
    bytes.append(topic).append(envelope);
  }

  std::vector<std::string> topics;
  std::vector<v1::Envelope> envelopes;
  std::string bytes;  ///< of everything
};

/// A run of a config that nobody listens to but the test.
struct RecordedRun {
  explicit RecordedRun(const DaemonConfig& daemon_config, JournalWriter* journal = nullptr)
      : config(daemon_config), run(config, stream, 1, journal) {}

  void scan(int count) {
    for (int i = 0; i < count; ++i) run.scan();
  }

  DaemonConfig config;
  Recorder stream;
  Run run;
};

/// Three radars, two targets, all of it with chance: clutter, missed plots, manoeuvres.
inline const std::string kBusy = R"(
seed: 11
radar { name: "west"  x_m: -40e3 beamwidth_deg: 0.7 false_alarm_probability: 1e-6 clutter_density: 2e-4 }
radar { name: "east"  x_m: 40e3  detection_probability: 0.8 clutter_density: 1e-4 }
radar { name: "south" y_m: -30e3 beamwidth_deg: 0.2 detection_probability: 0.9 }
target { name: "one" x_m: 10e3 y_m: 20e3 vx_mps: 150 vy_mps: 20 jump_markov { area { radius_m: 50e3 } } }
target { name: "two" x_m: -20e3 y_m: 30e3 vx_mps: 30 vy_mps: -200 jump_markov { area { radius_m: 50e3 } } }
)";

}  // namespace dwell::testing
