#pragma once

#include <thread>

#include "bandit/value_table.hpp"

namespace dwell {

/// Builds the value sets that scans ask for, in a thread of its own, when the processor has nothing better to do.
class ValueBuilder {
 public:
  explicit ValueBuilder(ValueTable& table);
  ~ValueBuilder();
  ValueBuilder(const ValueBuilder&) = delete;
  ValueBuilder& operator=(const ValueBuilder&) = delete;

 private:
  ValueTable& table_;
  std::thread thread_;
};

}  // namespace dwell
