#pragma once

#include <iosfwd>

#include "clients/command_line.hpp"
#include "clients/control_client.hpp"
#include "clients/text.hpp"

namespace dwell::client {

/// How the answers are shown.
struct Output {
  std::ostream& out;
  std::ostream& err;
  Page page;
  bool colour = false;
};

/// Every command but `watch`: asks, and prints the answer. Returns the exit code: 0, or 1 where the daemon
/// refused. Throws NoAnswer.
int run_command(const CommandLine& line, ControlClient& control, const Output& output);

}  // namespace dwell::client
