#include "bandit/restless/components.hpp"

#include <algorithm>
#include <limits>

namespace dwell::restless {

Components strongly_connected(const std::vector<std::array<std::size_t, 2>>& successors) {
  Components components;
  const std::size_t count = successors.size();
  constexpr int kUnseen = 0, kDone = std::numeric_limits<int>::max();
  std::vector<int> lowest(count, kUnseen);  // of the nodes on the stack that it leads to
  std::vector<int> found(count, kUnseen);
  std::vector<std::size_t> stack;
  struct Visit {
    std::size_t node;
    std::size_t next;  // of its two successors
  };
  std::vector<Visit> open;
  int entered = 0;
  const auto enter = [&](std::size_t k) {
    lowest[k] = found[k] = ++entered;
    stack.push_back(k);
    open.push_back({k, 0});
  };
  for (std::size_t start = 0; start < count; ++start) {
    if (found[start] != kUnseen) continue;
    enter(start);
    while (!open.empty()) {
      Visit& visit = open.back();
      const std::size_t k = visit.node;
      if (visit.next < 2) {
        const std::size_t to = successors[k][visit.next++];
        if (found[to] == kUnseen) {
          enter(to);
        } else {
          lowest[k] = std::min(lowest[k], lowest[to]);
        }
        continue;
      }
      open.pop_back();
      if (!open.empty()) lowest[open.back().node] = std::min(lowest[open.back().node], lowest[k]);
      if (lowest[k] != found[k]) continue;
      std::size_t member;
      do {
        member = stack.back();
        stack.pop_back();
        lowest[member] = kDone;
        components.order.push_back(member);
      } while (member != k);
      components.ends.push_back(components.order.size());
    }
  }
  return components;
}

}  // namespace dwell::restless
