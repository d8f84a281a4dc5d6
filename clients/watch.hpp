#pragma once

#include <string>
#include <zmq.hpp>

#include "clients/control_client.hpp"

namespace dwell::client {

/// Follows the stream until it ends, the user ends it, or, at the start, nobody is there.
/// On a terminal a live table; into a pipe one line a track and scan; with `json` every message as a line.
/// What goes wrong is said in the table's head, or else on standard error. Returns the exit code.
int watch(zmq::context_t& context, const std::string& stream, const ControlOptions& control, bool json);

}  // namespace dwell::client
