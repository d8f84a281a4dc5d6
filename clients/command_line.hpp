#pragma once

#include <string>
#include <variant>

#include "clients/control_client.hpp"
#include "dwell/v1/control.pb.h"

namespace dwell::client {

enum class Verb {
  kStatus,
  kWatch,
  kExplain,
  kPolicyList,
  kPolicyGet,
  kPolicySet,
  kPause,
  kResume,
  kStep,
  kRadarList,
  kRadarDown,
  kRadarUp,
  kSnapshot,
  kCalibrate,
  kStop
};

struct CommandLine {
  Verb verb = Verb::kStatus;
  v1::Request request{};  // what the verb asks of the daemon; `watch` asks for a snapshot
  ControlOptions control{};
  std::string stream = "tcp://127.0.0.1:5556";
  bool json = false;
};

/// What to do; or, where that is nothing, the exit code: 0 after --help, 2 after a bad command line. The text
/// that goes with it has then been printed.
std::variant<CommandLine, int> parse_command_line(int argc, const char* const* argv);

}  // namespace dwell::client
