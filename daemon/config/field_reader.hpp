#pragma once

#include <span>
#include <string>
#include <vector>

#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

#include "radar/violation.hpp"

namespace dwell {

/// Which values of a number are good, in the field's own unit. NaN never is.
struct Range {
  double low;
  double high;
  bool low_included = true;
  bool high_included = true;

  bool contains(double value) const;
  /// "must be > 0", "must be in [0, 90]", ...
  std::string rule() const;
};

Range positive_or_infinite();            ///< > 0
Range non_negative();                    ///< finite, >= 0
Range within(double low, double high);   ///< ends included
Range above(double low, double high);    ///< low excluded, high included
Range between(double low, double high);  ///< ends excluded

/// One parameter as a user may set it.
struct FieldDescription {
  std::string name;
  std::string rule;
  std::string default_value;
};

/// Reads the fields of one message into domain variables, by name, checking each against its rule.
///
/// A field that is present and good is converted into the target; one that is bad leaves the target alone and becomes
/// a violation; one that is absent is filled with the target's value, to 15 digits, and the target with what stands
/// there: afterwards the message is the effective configuration, and reading it again gives the same bits.
/// Lines and columns come from the parser's location tree where there is one; of a field that is absent they are those
/// of its message.
class FieldReader {
 public:
  using Locations = google::protobuf::TextFormat::ParseInfoTree;

  /// `locations` may be null. `message` and `violations` outlive the reader.
  FieldReader(google::protobuf::Message& message, const Locations* locations, std::vector<Violation>& violations);

  bool has(const char* field) const;
  int count(const char* field) const;
  /// The reader of a sub-message, created where absent.
  FieldReader child(const char* field);
  FieldReader element(const char* field, int index);

  /// target = value x unit.
  void number(const char* field, const Range& range, double unit, double& target);
  /// target = 10^(value / 10).
  void decibel(const char* field, const Range& range, double& target);
  /// The values of a list that has one of the given sizes (none given: any); empty where it is absent or refused.
  std::vector<double> numbers(const char* field, const Range& range, std::initializer_list<int> sizes);
  /// Writes out the default of a list that is absent.
  void fill_in(const char* field, std::span<const double> values);
  void integer(const char* field, int low, int high, int& target);
  void flag(const char* field, bool& target);
  /// At most 200 characters.
  void text(const char* field, std::string& target);
  void required(const char* field);

  /// An enum whose numbers are those of the domain's enum.
  template <class Enum>
  void choice(const char* field, Enum& target) {
    target = static_cast<Enum>(enum_number(field, static_cast<int>(target)));
  }

  /// A rule over more than one field.
  void refuse(const char* field, const std::string& value, const std::string& rule);
  /// What the domain says of a field by its path from here, as "sensor[2].r"; not again where it was refused already.
  void refuse(const Violation& violation);
  /// By any reader of the same list of violations.
  bool refused_any() const { return !violations_->empty(); }
  std::string path(const char* field) const;
  /// The value as the text format writes it; empty where absent, and of a message.
  std::string value(const char* field) const;

  /// From now on also notes each field that is read.
  void describe_into(std::vector<FieldDescription>* descriptions) { descriptions_ = descriptions; }

 private:
  using Field = google::protobuf::FieldDescriptor;
  const Field* field(const char* name) const;
  int enum_number(const char* name, int fallback);
  void describe(const Field* field, const std::string& rule);
  google::protobuf::TextFormat::ParseLocation place_of(const Field* field, int index) const;
  void refuse_at(const Field* field, int index, const std::string& value, const std::string& rule);

  google::protobuf::Message* message_;
  const Locations* locations_;
  std::vector<Violation>* violations_;
  std::string prefix_;                                 // path of the message, with its dot
  google::protobuf::TextFormat::ParseLocation place_;  // of the message; from 0, -1 unknown
  std::vector<FieldDescription>* descriptions_ = nullptr;
};

/// The value as the text format prints it, at most 15 significant digits.
std::string number_text(double value);

/// The first `most` bytes, or up to 3 less: UTF-8 is not cut inside a character.
std::string shortened(const std::string& text, std::size_t most);

}  // namespace dwell
