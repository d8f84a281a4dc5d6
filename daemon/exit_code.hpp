#pragma once

#include <exception>
#include <iostream>

#include "radar/violation.hpp"

namespace dwell {

enum ExitCode { kDone = 0, kFailed = 1, kBadCommandLine = 2, kBadConfig = 78 };

/// Runs the body of a main(): what it throws is said on stderr, all violations of an input line by line, and becomes
/// the exit code.
template <class Body>
int report_errors(const char* program, const Body& body) {
  try {
    return body();
  } catch (const InvalidInput& error) {
    for (const Violation& violation : error.violations()) {
      std::cerr << to_string(error.source(), violation) << '\n';
    }
    return kBadConfig;
  } catch (const std::exception& error) {
    std::cerr << program << ": " << error.what() << '\n';
    return kFailed;
  }
}

}  // namespace dwell
