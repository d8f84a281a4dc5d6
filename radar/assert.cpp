#include "radar/assert.hpp"

#include <cstdio>
#include <cstdlib>

namespace dwell::detail {

void invariant_broken(const char* expression, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: invariant broken: %s\n", file, line, expression);
  std::abort();
}

}  // namespace dwell::detail
