#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <google/protobuf/message.h>

#include "radar/violation.hpp"

namespace dwell {

/// Policies as text, "name:key=value:key=value". They are messages with one `oneof`: its fields are the policies, the
/// fields of those the parameters.

/// How the text spells the names of enums: in lower case.
std::string lower(std::string text);

/// Text to a message. Unknown names and values of the wrong type become violations that list what is valid, and are
/// left out of the message; false where the policy itself is unknown.
bool parse_policy(std::string_view text, google::protobuf::Message& policy, std::vector<Violation>& violations);

/// The message back to text, with the parameters that it has: "sa_imm:cost=x:beta=0:nodes=7".
std::string policy_text(const google::protobuf::Message& policy);

/// The field of the policy that is chosen, or null.
const google::protobuf::FieldDescriptor* policy_kind(const google::protobuf::Message& policy);

/// "round_robin, fixed, ...": all that may be chosen.
std::string policy_names(const google::protobuf::Message& policy);

}  // namespace dwell
