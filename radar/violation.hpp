#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace dwell {

/// One thing wrong with an input: what, which value, which rule, and where (line and column from 1; 0: unknown).
struct Violation {
  std::string field;
  std::string value;
  std::string rule;
  int line = 0;
  int column = 0;
};

/// Everything that is wrong with one input, found in one pass. The input is refused whole.
class InvalidInput : public std::runtime_error {
 public:
  InvalidInput(std::string source, std::vector<Violation> violations);

  const std::string& source() const { return source_; }
  const std::vector<Violation>& violations() const { return violations_; }

 private:
  std::string source_;
  std::vector<Violation> violations_;
};

/// "source:line:column: field = value: rule".
std::string to_string(const std::string& source, const Violation& violation);

}  // namespace dwell
