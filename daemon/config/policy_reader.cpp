#include "daemon/config/policy_reader.hpp"

#include <algorithm>
#include <cctype>

#include <google/protobuf/io/tokenizer.h>

namespace dwell {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::TextFormat;

PolicySettings read(FieldReader in, RoundRobinSettings settings, int /*sensors*/) {
  in.choice("order", settings.order);
  return settings;
}

PolicySettings read(FieldReader in, FixedSettings settings, int sensors) {
  in.integer("sensor", 1, std::max(sensors, 1), settings.sensor);
  return settings;
}

PolicySettings read(FieldReader /*in*/, LargestVarianceSettings settings, int /*sensors*/) { return settings; }

PolicySettings read(FieldReader in, SaImmSettings settings, int /*sensors*/) {
  in.choice("cost", settings.cost);
  in.number("beta", within(0.0, 1e12), 1.0, settings.beta);
  in.integer("nodes", 2, 32, settings.nodes);
  return settings;
}

PolicySettings read(FieldReader /*in*/, BhattacharyyaSettings settings, int /*sensors*/) { return settings; }

/// One row for each policy: the field of dwell.v1.Policy, what it does, and how its message is read.
struct Row {
  const char* field;
  const char* summary;
  PolicySettings (*read)(FieldReader in, int sensors);
};

template <class Settings>
PolicySettings read_row(FieldReader in, int sensors) {
  return read(std::move(in), Settings{}, sensors);
}

constexpr Row kRows[] = {
    {"round_robin", "sensors and tracks in turn", read_row<RoundRobinSettings>},
    {"fixed", "one sensor, its tracks in turn", read_row<FixedSettings>},
    {"largest_variance", "the largest predicted position variance, by the sensor that reduces it most",
     read_row<LargestVarianceSettings>},
    {"sa_imm", "the least expected cost one step ahead", read_row<SaImmSettings>},
    {"bhattacharyya", "the least bound on mode errors", read_row<BhattacharyyaSettings>},
};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

template <class Descriptor>
std::string field_names(const Descriptor& type) {
  std::string names;
  for (int i = 0; i < type.field_count(); ++i) names += (i == 0 ? "" : ", ") + type.field(i)->name();
  return names.empty() ? "nothing: it has no parameters" : names;
}

const FieldDescriptor* chosen_kind(const v1::Policy& policy) {
  return policy.GetReflection()->GetOneofFieldDescriptor(policy, v1::Policy::descriptor()->oneof_decl(0));
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

/// Sets one parameter from its text; false where the value does not fit the field's type.
bool set_parameter(Message& message, const FieldDescriptor& field, const std::string& value) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || c == '+' || c == '-' || c == '.' || c == '_'; };
  if (value.empty() || !std::all_of(value.begin(), value.end(), plain)) return false;
  const bool is_enum = field.cpp_type() == FieldDescriptor::CPPTYPE_ENUM;
  TextFormat::Parser parser;
  struct Silent : google::protobuf::io::ErrorCollector {
    void AddError(int, google::protobuf::io::ColumnNumber, const std::string&) override {}
  } silent;
  parser.RecordErrorsTo(&silent);
  return parser.ParseFieldValueFromString(is_enum ? upper(value) : value, &field, &message);
}

std::string type_rule(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_ENUM: {
      std::string names;
      for (int i = 0; i < field.enum_type()->value_count(); ++i) {
        names += (i == 0 ? "" : ", ") + lower(field.enum_type()->value(i)->name());
      }
      return "must be one of: " + names;
    }
    case FieldDescriptor::CPPTYPE_UINT32:
      return "must be a whole number";
    case FieldDescriptor::CPPTYPE_BOOL:
      return "must be true or false";
    default:
      return "must be a number";
  }
}

}  // namespace

std::vector<PolicyDescription> describe_policies(int sensors) {
  std::vector<PolicyDescription> all;
  for (const Row& row : kRows) {
    v1::Policy policy;
    std::vector<Violation> none;
    PolicyDescription description{row.field, row.summary, {}};
    FieldReader in = FieldReader(policy, nullptr, none).child(row.field);
    in.describe_into(&description.parameters);
    row.read(in, sensors);
    for (FieldDescription& parameter : description.parameters) {
      parameter.rule = lower(parameter.rule);  // as parse_policy_text takes the names of enums
      parameter.default_value = lower(parameter.default_value);
    }
    all.push_back(std::move(description));
  }
  return all;
}

std::optional<PolicySettings> read_policy(v1::Policy& policy, FieldReader& reader, int sensors) {
  const FieldDescriptor* kind = chosen_kind(policy);
  if (kind == nullptr) {
    reader.refuse(v1::Policy::descriptor()->field(0)->name().c_str(), "",
                  "policy must be one of: " + field_names(*v1::Policy::descriptor()));
    return std::nullopt;
  }
  for (const Row& row : kRows) {
    if (kind->name() == row.field) return row.read(reader.child(row.field), sensors);
  }
  return std::nullopt;
}

std::optional<PolicySettings> read_policy(v1::Policy& policy, int sensors, std::vector<Violation>& violations) {
  if (chosen_kind(policy) == nullptr) {
    violations.push_back({"policy", "", "must be one of: " + field_names(*v1::Policy::descriptor())});
    return std::nullopt;
  }
  const std::size_t before = violations.size();
  FieldReader reader(policy, nullptr, violations);
  auto settings = read_policy(policy, reader, sensors);
  return violations.size() == before ? settings : std::nullopt;
}

std::optional<v1::Policy> parse_policy_text(std::string_view text, std::vector<Violation>& violations) {
  const std::vector<std::string_view> parts = split(text, ':');
  const std::string name(parts.front());
  const FieldDescriptor* kind = v1::Policy::descriptor()->FindFieldByName(name);
  if (kind == nullptr) {
    violations.push_back({"policy", shortened(name, 80), "must be one of: " + field_names(*v1::Policy::descriptor())});
    return std::nullopt;
  }
  v1::Policy policy;
  Message& message = *policy.GetReflection()->MutableMessage(&policy, kind);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::size_t equals = parts[i].find('=');
    const std::string key(parts[i].substr(0, equals));
    const std::string value(equals == std::string_view::npos ? "" : parts[i].substr(equals + 1));
    const FieldDescriptor* field = kind->message_type()->FindFieldByName(key);
    if (field == nullptr) {
      violations.push_back({name + "." + shortened(key, 80), shortened(value, 80),
                            "unknown parameter; known: " + field_names(*kind->message_type())});
    } else if (message.GetReflection()->HasField(message, field)) {
      violations.push_back({name + "." + key, shortened(value, 80), "is given twice"});
    } else if (!set_parameter(message, *field, value)) {
      violations.push_back({name + "." + key, shortened(value, 80), type_rule(*field)});
    }
  }
  return policy;
}

std::string policy_text(const v1::Policy& policy) {
  const FieldDescriptor* kind = chosen_kind(policy);
  if (kind == nullptr) return "";
  std::string text = kind->name();
  const Message& message = policy.GetReflection()->GetMessage(policy, kind);
  for (int i = 0; i < kind->message_type()->field_count(); ++i) {
    const FieldDescriptor* field = kind->message_type()->field(i);
    if (!message.GetReflection()->HasField(message, field)) continue;
    std::string value;
    TextFormat::PrintFieldValueToString(message, field, -1, &value);
    text += ":" + field->name() + "=" + lower(value);
  }
  return text;
}

}  // namespace dwell
