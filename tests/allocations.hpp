#pragma once

namespace dwell::testing {

/// How often this thread has asked for memory, counted at malloc: under operator new and Eigen alike.
/// Link tests/allocations.cpp.
long allocations();

}  // namespace dwell::testing
