#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bandit/policy_settings.hpp"
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

/// Every policy that a run with so many sensors can have, in the order of dwell.v1.Policy. `classes`: whether it has
/// classes of targets, without which there are policies that do not stand.
std::vector<PolicyDescription> describe_policies(int sensors, bool classes = false);

/// Reads a dwell.v1.Policy, filling in defaults. Empty where it breaks a rule (noted in the reader's violations).
/// `sensors` bounds the number of a sensor.
std::optional<PolicySettings> read_policy(v1::Policy& policy, FieldReader& reader, int sensors, bool classes = false);

/// The same without a file, for commands. Violations are appended.
std::optional<PolicySettings> read_policy(v1::Policy& policy, int sensors, bool classes,
                                          std::vector<Violation>& violations);

/// "sa_imm:cost=x:nodes=7" to a message, by parse_policy; empty where the policy itself is unknown.
std::optional<v1::Policy> parse_policy_text(std::string_view text, std::vector<Violation>& violations);

}  // namespace dwell
