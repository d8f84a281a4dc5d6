#include "daemon/config/policy_text.hpp"

#include <algorithm>
#include <cctype>

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include "daemon/config/field_reader.hpp"

namespace dwell {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::TextFormat;

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

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool parse_policy(std::string_view text, Message& policy, std::vector<Violation>& violations) {
  const std::vector<std::string_view> parts = split(text, ':');
  const std::string name(parts.front());
  const FieldDescriptor* kind = policy.GetDescriptor()->FindFieldByName(name);
  if (kind == nullptr) {
    violations.push_back({"policy", shortened(name, 80), "must be one of: " + policy_names(policy)});
    return false;
  }
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
  return true;
}

std::string policy_text(const Message& policy) {
  const FieldDescriptor* kind = policy_kind(policy);
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

const FieldDescriptor* policy_kind(const Message& policy) {
  return policy.GetReflection()->GetOneofFieldDescriptor(policy, policy.GetDescriptor()->oneof_decl(0));
}

std::string policy_names(const Message& policy) { return field_names(*policy.GetDescriptor()); }

}  // namespace dwell
