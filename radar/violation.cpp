#include "radar/violation.hpp"

namespace dwell {
namespace {

std::string join(const std::string& source, const std::vector<Violation>& violations) {
  std::string text;
  for (const Violation& violation : violations) {
    if (!text.empty()) text += '\n';
    text += to_string(source, violation);
  }
  return text;
}

}  // namespace

InvalidInput::InvalidInput(std::string source, std::vector<Violation> violations)
    : std::runtime_error(join(source, violations)), source_(std::move(source)), violations_(std::move(violations)) {}

std::string to_string(const std::string& source, const Violation& violation) {
  std::string text = source;
  if (violation.line > 0) text += ':' + std::to_string(violation.line);
  if (violation.line > 0 && violation.column > 0) text += ':' + std::to_string(violation.column);
  if (!text.empty()) text += ": ";
  text += violation.field;
  if (!violation.value.empty()) text += " = " + violation.value;
  return text + ": " + violation.rule;
}

}  // namespace dwell
