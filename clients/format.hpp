#pragma once

#include <cstdint>
#include <string>

#include "clients/text.hpp"
#include "dwell/v1/control.pb.h"

// From messages to text: pure functions, one for each answer of the daemon.
namespace dwell::client {

/// As `policy set` takes it: "sa_imm:cost=x:nodes=7". Only the parameters that the message holds.
std::string policy_text(const v1::Policy& policy);

/// "running  scan 412  t 412.0 s  radars 2/3 up  tracks 12 (2 coasting)  lost 1": short, so that 80 columns
/// hold it
std::string headline(const v1::Status& status, std::int64_t time_ns);

Lines format_status(const v1::Status& status);
Lines format_policies(const v1::PolicyList& policies, const Page& page);
Lines format_radars(const v1::RadarList& radars, const Page& page);
/// One row a parameter: value, standard error, and what is not observable.
Lines format_calibration(const v1::RadarList& radars, const Page& page);
Lines format_snapshot(const v1::Snapshot& snapshot, const Page& page);

/// The reason, and each violation on a line of its own: field, value, rule.
Lines format_refusal(const v1::Refused& refused);

/// One line of JSON, as protobuf defines it, with the names of the .proto files; see README.md.
std::string json(const google::protobuf::Message& message);

}  // namespace dwell::client
