#pragma once

#include "clients/text.hpp"
#include "dwell/v1/control.pb.h"

namespace dwell::client {

/// Why the last scan looked where it looked: the policy, what was chosen, what came of it, the reason in a
/// sentence, and every candidate, the best score first.
Lines explain(const v1::Snapshot& snapshot, const Page& page);

}  // namespace dwell::client
