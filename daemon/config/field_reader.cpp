#include "daemon/config/field_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <spdlog/fmt/fmt.h>

#include "radar/assert.hpp"

namespace dwell {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargest = std::numeric_limits<double>::max();

/// Without the last digit's noise that a change of units leaves.
double rounded(double value) { return std::stod(number_text(value)); }

std::string enum_names(const google::protobuf::EnumDescriptor& type) {
  std::string names;
  for (int i = 0; i < type.value_count(); ++i) names += (i == 0 ? "" : ", ") + type.value(i)->name();
  return names;
}

}  // namespace

std::string number_text(double value) { return fmt::format("{:.15g}", value); }

std::string shortened(const std::string& text, std::size_t most) {
  const auto continues = [&](std::size_t place) { return (static_cast<unsigned char>(text[place]) & 0xC0U) == 0x80U; };
  if (text.size() > most) {
    while (most > 0 && continues(most)) --most;
  }
  return text.substr(0, most);
}

Range positive_or_infinite() { return {0.0, kInfinity, false, true}; }
Range non_negative() { return {0.0, kLargest}; }
Range within(double low, double high) { return {low, high}; }
Range above(double low, double high) { return {low, high, false, true}; }
Range between(double low, double high) { return {low, high, false, false}; }

bool Range::contains(double value) const {
  const bool above_low = low_included ? value >= low : value > low;
  const bool below_high = high_included ? value <= high : value < high;
  return above_low && below_high;  // false for NaN
}

std::string Range::rule() const {
  const std::string finite = high == kLargest ? " and finite" : "";
  if (high >= kLargest) return fmt::format("must be {} {}{}", low_included ? ">=" : ">", number_text(low), finite);
  return fmt::format("must be in {}{}, {}{}", low_included ? '[' : '(', number_text(low), number_text(high),
                     high_included ? ']' : ')');
}

FieldReader::FieldReader(google::protobuf::Message& message, const Locations* locations,
                         std::vector<Violation>& violations)
    : message_(&message), locations_(locations), violations_(&violations) {}

const FieldReader::Field* FieldReader::field(const char* name) const {
  const Field* field = message_->GetDescriptor()->FindFieldByName(name);
  DWELL_ASSERT(field != nullptr);
  return field;
}

bool FieldReader::has(const char* name) const { return message_->GetReflection()->HasField(*message_, field(name)); }

int FieldReader::count(const char* name) const { return message_->GetReflection()->FieldSize(*message_, field(name)); }

FieldReader FieldReader::child(const char* name) {
  FieldReader reader(*message_->GetReflection()->MutableMessage(message_, field(name)),
                     locations_ == nullptr ? nullptr : locations_->GetTreeForNested(field(name), -1), *violations_);
  reader.prefix_ = prefix_ + name + ".";
  reader.place_ = place_of(field(name), -1);
  return reader;
}

FieldReader FieldReader::element(const char* name, int index) {
  FieldReader reader(*message_->GetReflection()->MutableRepeatedMessage(message_, field(name), index),
                     locations_ == nullptr ? nullptr : locations_->GetTreeForNested(field(name), index), *violations_);
  reader.prefix_ = fmt::format("{}{}[{}].", prefix_, name, index + 1);
  reader.place_ = place_of(field(name), index);
  return reader;
}

void FieldReader::number(const char* name, const Range& range, double unit, double& target) {
  const auto* reflection = message_->GetReflection();
  describe(field(name), range.rule());
  if (!has(name)) {
    // A default of a oneof is no choice of it: absent stays absent there.
    if (field(name)->real_containing_oneof() == nullptr) {
      const double written = rounded(target / unit);
      reflection->SetDouble(message_, field(name), written);
      target = written * unit;
    }
  } else if (const double value = reflection->GetDouble(*message_, field(name)); range.contains(value)) {
    target = value * unit;
  } else {
    refuse_at(field(name), -1, number_text(value), range.rule());
  }
  if (descriptions_ != nullptr) descriptions_->back().default_value = number_text(target / unit);
}

void FieldReader::decibel(const char* name, const Range& range, double& target) {
  double value_db = 10.0 * std::log10(target);
  number(name, range, 1.0, value_db);
  target = std::pow(10.0, value_db / 10.0);
}

std::vector<double> FieldReader::numbers(const char* name, const Range& range, std::initializer_list<int> sizes) {
  std::vector<double> values;
  const int size = count(name);
  bool all_good = true;
  for (int i = 0; i < size; ++i) {
    const double value = message_->GetReflection()->GetRepeatedDouble(*message_, field(name), i);
    if (!range.contains(value)) {
      refuse_at(field(name), i, number_text(value), range.rule());
      all_good = false;
    }
    values.push_back(value);
  }
  if (size > 0 && sizes.size() > 0 && std::find(sizes.begin(), sizes.end(), size) == sizes.end()) {
    std::string wanted;
    for (const int good : sizes) wanted += (wanted.empty() ? "" : " or ") + std::to_string(good);
    refuse_at(field(name), 0, fmt::format("{} values", size), "must have " + wanted + " values");
    all_good = false;
  }
  if (!all_good) values.clear();
  return values;
}

void FieldReader::fill_in(const char* name, std::span<const double> values) {
  if (count(name) > 0) return;
  for (const double value : values) message_->GetReflection()->AddDouble(message_, field(name), value);
}

void FieldReader::integer(const char* name, int low, int high, int& target) {
  const auto* reflection = message_->GetReflection();
  const std::string rule = fmt::format("must be a whole number from {} to {}", low, high);
  describe(field(name), rule);
  if (!has(name)) {
    reflection->SetUInt32(message_, field(name), static_cast<std::uint32_t>(target));
  } else if (const std::uint32_t value = reflection->GetUInt32(*message_, field(name));
             value >= static_cast<std::uint32_t>(low) && value <= static_cast<std::uint32_t>(high)) {
    target = static_cast<int>(value);
  } else {
    refuse_at(field(name), -1, std::to_string(value), rule);
  }
  if (descriptions_ != nullptr) descriptions_->back().default_value = std::to_string(target);
}

void FieldReader::flag(const char* name, bool& target) {
  const auto* reflection = message_->GetReflection();
  describe(field(name), "must be true or false");
  if (has(name)) {
    target = reflection->GetBool(*message_, field(name));
  } else {
    reflection->SetBool(message_, field(name), target);
  }
  if (descriptions_ != nullptr) descriptions_->back().default_value = target ? "true" : "false";
}

void FieldReader::text(const char* name, std::string& target) {
  constexpr std::size_t kLongest = 200;
  const auto* reflection = message_->GetReflection();
  if (!has(name)) {
    if (!target.empty()) reflection->SetString(message_, field(name), target);
    return;
  }
  const std::string value = reflection->GetString(*message_, field(name));
  const bool printable = std::none_of(value.begin(), value.end(), [](unsigned char c) { return c < 0x20; });
  if (!value.empty() && value.size() <= kLongest && printable) {
    target = value;
  } else {
    refuse_at(field(name), -1, this->value(name), "must be 1 to 200 printable characters");
  }
}

void FieldReader::required(const char* name) {
  if (!has(name)) refuse_at(field(name), -1, "", "is required");
}

int FieldReader::enum_number(const char* name, int fallback) {
  const auto* reflection = message_->GetReflection();
  const auto* type = field(name)->enum_type();
  const std::string rule = "must be one of: " + enum_names(*type);
  describe(field(name), rule);
  if (descriptions_ != nullptr) descriptions_->back().default_value = type->FindValueByNumber(fallback)->name();
  if (!has(name)) {
    reflection->SetEnumValue(message_, field(name), fallback);
    return fallback;
  }
  const int value = reflection->GetEnumValue(*message_, field(name));
  if (type->FindValueByNumber(value) != nullptr) return value;
  refuse_at(field(name), -1, std::to_string(value), rule);
  return fallback;
}

void FieldReader::refuse(const char* name, const std::string& value, const std::string& rule) {
  refuse_at(field(name), field(name)->is_repeated() ? 0 : -1, value, rule);
}

void FieldReader::refuse(const Violation& violation) {
  const std::size_t dot = violation.field.find('.');
  if (dot == std::string::npos) {
    const std::string path = prefix_ + violation.field;
    const bool refused = std::any_of(violations_->begin(), violations_->end(),
                                     [&](const Violation& other) { return other.field == path; });
    if (!refused) refuse(violation.field.c_str(), violation.value, violation.rule);
    return;
  }
  const std::size_t bracket = violation.field.find('[');
  const Violation rest{violation.field.substr(dot + 1), violation.value, violation.rule};
  if (bracket > dot) {
    child(violation.field.substr(0, dot).c_str()).refuse(rest);
  } else {
    const int number = std::stoi(violation.field.substr(bracket + 1));
    element(violation.field.substr(0, bracket).c_str(), number - 1).refuse(rest);
  }
}

std::string FieldReader::path(const char* name) const { return prefix_ + name; }

std::string FieldReader::value(const char* name) const {
  if (!has(name) || field(name)->cpp_type() == Field::CPPTYPE_MESSAGE) return "";
  std::string text;
  google::protobuf::TextFormat::PrintFieldValueToString(*message_, field(name), -1, &text);
  return text;
}

void FieldReader::describe(const Field* field, const std::string& rule) {
  if (descriptions_ != nullptr) descriptions_->push_back({field->name(), rule, ""});
}

void FieldReader::refuse_at(const Field* field, int index, const std::string& value, const std::string& rule) {
  const auto place = place_of(field, index);
  violations_->push_back({prefix_ + field->name(), value, rule, place.line + 1, place.column + 1});
}

/// Of a list in brackets the parser knows one place, that of its first element.
google::protobuf::TextFormat::ParseLocation FieldReader::place_of(const Field* field, int index) const {
  if (locations_ == nullptr) return place_;
  auto place = locations_->GetLocation(field, index);
  if (place.line < 0 && index > 0) place = locations_->GetLocation(field, 0);
  return place.line < 0 ? place_ : place;
}

}  // namespace dwell
