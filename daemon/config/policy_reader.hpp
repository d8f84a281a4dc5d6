#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bandit/catalogue.hpp"
#include "daemon/config/field_reader.hpp"
#include "daemon/config/policy_text.hpp"
#include "dwell/v1/config.pb.h"

namespace dwell {

/// A policy as a user sees it.
struct PolicyDescription {
  std::string name;
  std::string summary;
  std::vector<FieldDescription> parameters;
};

/// Every policy there is, in the order of dwell.v1.Policy, for a run with so many sensors.
std::vector<PolicyDescription> describe_policies(int sensors);

/// Reads a dwell.v1.Policy, filling in defaults. Empty where it breaks a rule (noted in the reader's violations).
/// `sensors` bounds the number of a sensor.
std::optional<PolicySettings> read_policy(v1::Policy& policy, FieldReader& reader, int sensors);

/// The same without a file, for commands. Violations are appended.
std::optional<PolicySettings> read_policy(v1::Policy& policy, int sensors, std::vector<Violation>& violations);

/// "sa_imm:cost=x:nodes=7" to a message, by parse_policy; empty where the policy itself is unknown.
std::optional<v1::Policy> parse_policy_text(std::string_view text, std::vector<Violation>& violations);

}  // namespace dwell
