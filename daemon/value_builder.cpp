#include "daemon/value_builder.hpp"

#include <sys/resource.h>
#include <unistd.h>

namespace dwell {
namespace {

constexpr int kNice = 10;

void build(ValueTable& table) {
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);  // of this thread; without it all goes on
  while (table.build_next()) {
  }
}

}  // namespace

ValueBuilder::ValueBuilder(ValueTable& table) : table_(table), thread_([&table] { build(table); }) {}

ValueBuilder::~ValueBuilder() {
  table_.stop();
  thread_.join();
}

}  // namespace dwell
