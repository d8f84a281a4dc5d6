#pragma once

namespace dwell::detail {
[[noreturn]] void invariant_broken(const char* expression, const char* file, int line);
}

/// A broken invariant of our own: stays on in every build, prints what and where, aborts.
#define DWELL_ASSERT(expression) \
  ((expression) ? void(0) : ::dwell::detail::invariant_broken(#expression, __FILE__, __LINE__))
