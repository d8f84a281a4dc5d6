#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace dwell::restless {

/// Strongly connected components of a graph in which each node leads to two, in such an order that what a component
/// leads to comes before it.
struct Components {
  std::vector<std::size_t> order;  ///< nodes, component by component
  std::vector<std::size_t> ends;   ///< of each component, in `order`
};

/// `successors` of each node; a node may lead to itself, or twice to one.
/// Within one component, what was found last comes first.
/// Source   Tarjan (1972), SIAM J. Comput. 1(2); without recursion.
Components strongly_connected(const std::vector<std::array<std::size_t, 2>>& successors);

}  // namespace dwell::restless
