#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config_reader.hpp"
#include "daemon/config/parsed_config.hpp"
#include "daemon/study/run_metrics.hpp"
#include "daemon/study/study_report.hpp"

namespace dwell {

/// What the command line asks for. A kind of problem takes what it has a use for.
struct StudyRequest {
  std::vector<std::string> policies;  ///< as given; none: the config's
  int runs = 100;
  int threads = 1;
  std::optional<std::uint64_t> seed;   ///< none: the config's
  std::optional<std::uint64_t> scans;  ///< of each run; none: the config's
  TimeWindow window;
  std::optional<std::string> calibrate;  ///< "joint", "innovations": what calibration knows of a scenario's radars
  bool known_flights = false;            ///< with it: every target is a calibration flight
};

/// Who looks on: may cut a study short, and is told (done, of all), from any thread, one at a time.
struct StudyWatch {
  const std::atomic<bool>& stop;
  std::function<void(int, int)> progress;
};

/// One kind of problem: the field of `Config.problem` that poses it ("" is the scenario), and how it is studied.
struct ProblemKind {
  const char* name;
  std::unique_ptr<StudyReport> (*study)(ParsedConfig config, const StudyRequest& request, const StudyWatch& watch);
};

/// The kind of a config. A new kind is its message in problem.proto, its reader in daemon/config/, its file here with a
/// `study` function, and its row in problem_kinds.cpp.
/// Errors of its `study`   InvalidInput with all that is wrong with the config and the policies.
const ProblemKind& kind_of(const v1::Config& config);

std::unique_ptr<StudyReport> study_scenario(ParsedConfig config, const StudyRequest& request, const StudyWatch& watch);
/// The same scenario's radars: calibration against their truth, under one policy.
std::unique_ptr<StudyReport> study_calibration_of(DaemonConfig config, const StudyRequest& request,
                                                  const StudyWatch& watch);
/// Of the radars of a run that dwelld has recorded: what its plots say. Requires `calibrate`.
/// Errors   InvalidInput of a journal that cannot be repeated.
std::unique_ptr<StudyReport> study_journal(const std::string& file, const StudyRequest& request,
                                           const StudyWatch& watch);
std::unique_ptr<StudyReport> study_lti(ParsedConfig config, const StudyRequest& request, const StudyWatch& watch);
std::unique_ptr<StudyReport> study_hmm_selection(ParsedConfig config, const StudyRequest& request,
                                                 const StudyWatch& watch);
std::unique_ptr<StudyReport> study_restless(ParsedConfig config, const StudyRequest& request, const StudyWatch& watch);
std::unique_ptr<StudyReport> study_hmm_bandit(ParsedConfig config, const StudyRequest& request,
                                              const StudyWatch& watch);

}  // namespace dwell
