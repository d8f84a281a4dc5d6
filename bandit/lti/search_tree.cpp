#include "bandit/lti/search_tree.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "radar/assert.hpp"

namespace dwell::lti {

Node Level::operator[](std::size_t i) const {
  const Head& head = heads_[i];
  return {covariances_.data() + i * stride_,
          head.cost,
          std::span(looks_).subspan(i * sensors_, sensors_),
          head.parent,
          head.choice,
          head.link};
}

void Level::add(const Node& node) {
  heads_.push_back({node.cost, node.parent, node.link, node.choice});
  covariances_.insert(covariances_.end(), node.covariance, node.covariance + stride_);
  looks_.insert(looks_.end(), node.looks.begin(), node.looks.end());
}

std::size_t Level::bytes() const {
  return size() * (sizeof(Head) + stride_ * sizeof(double) + sensors_ * sizeof(std::uint16_t));
}

double trace_weight(const Problem& problem) {
  const bool summed = problem.objective == Objective::kSum && problem.communication_noise == 0.0;
  return summed ? problem.sensor_count() : 1.0;
}

bool feasible(const Problem& problem, std::span<const std::uint16_t> looks, int step, int choice) {
  if (choice == 0) return problem.allow_idle;
  return looks[static_cast<std::size_t>(choice - 1)] < looks_by(problem, choice, step);
}

bool no_more_looks(const Problem& problem, std::span<const std::uint16_t> a, std::span<const std::uint16_t> b) {
  for (std::size_t j = 0; j < a.size(); ++j) {
    if (problem.sensors[j].max_looks > 0 && a[j] > b[j]) return false;
  }
  return true;
}

SearchTree::SearchTree(const Problem& problem, Riccati& riccati, std::size_t maximum_bytes)
    : problem_(problem), riccati_(riccati), trace_weight_(lti::trace_weight(problem)), maximum_bytes_(maximum_bytes) {}

Level SearchTree::root() {
  const std::vector<double> covariance = riccati_.initial();
  Level level(riccati_.size(), problem_.sensors.size(), 0);
  const bool counts = problem_.objective == Objective::kSum && problem_.covariance == CovarianceKind::kPredicted;
  const double cost = counts ? trace_weight_ * riccati_.trace(covariance.data()) : 0.0;
  const std::vector<std::uint16_t> no_looks(problem_.sensors.size(), 0);
  links_.assign(1, {0, 0});
  level.add({covariance.data(), cost, no_looks, 0, 0, 0});
  return level;
}

Level SearchTree::root(std::span<const double> covariance, std::span<const std::uint16_t> looks, int depth) {
  Level level(riccati_.size(), problem_.sensors.size(), depth);
  links_.assign(1, {0, 0});
  level.add({covariance.data(), 0.0, looks, 0, 0, 0});
  return level;
}

double SearchTree::cost_after(double cost, int choice, const double* covariance) const {
  const double now = trace_weight_ * riccati_.trace(covariance);
  if (problem_.objective == Objective::kFinal) return now;
  return cost + now + (choice == 0 ? 0.0 : problem_.sensors[static_cast<std::size_t>(choice - 1)].cost);
}

void SearchTree::check_steps() const {
  if (riccati_.steps() > kMaximumSteps) {
    throw std::length_error(
        "the search takes more than 100 million Riccati steps: take a shorter horizon or window, "
        "beam or relaxed_dp");
  }
}

Level SearchTree::grow(const Level& level, Pruning& pruning) {
  const int step = level.depth() + 1;
  Level children(riccati_.size(), problem_.sensors.size(), step);
  std::vector<double> covariance(riccati_.size());
  std::vector<std::uint16_t> looks;
  for (std::size_t i = 0; i < level.size(); ++i) {
    const Node node = level[i];
    for (int choice = 0; choice <= problem_.sensor_count(); ++choice) {
      if (!feasible(problem_, node.looks, step, choice)) continue;
      riccati_.step(node.covariance, choice, covariance.data());
      looks.assign(node.looks.begin(), node.looks.end());
      if (choice > 0) ++looks[static_cast<std::size_t>(choice - 1)];
      const Node child{covariance.data(),
                       cost_after(node.cost, choice, covariance.data()),
                       looks,
                       static_cast<std::uint32_t>(i),
                       choice,
                       0};
      if (pruning.admits(child)) children.add(child);
    }
    check_steps();
    if (children.bytes() > maximum_bytes_) {
      throw std::length_error(
          "more than " + std::to_string(children.size()) +
          " schedules in one step of the search: take a shorter horizon or window, beam or relaxed_dp");
    }
  }
  std::vector<std::size_t> kept;
  pruning.select(level, children, kept);
  Level next(riccati_.size(), problem_.sensors.size(), step);
  for (const std::size_t place : kept) {
    Node child = children[place];
    DWELL_ASSERT(links_.size() < std::numeric_limits<std::uint32_t>::max());
    child.link = static_cast<std::uint32_t>(links_.size());
    links_.push_back({level[child.parent].link, child.choice});
    next.add(child);
  }
  return next;
}

Level SearchTree::grow(Level level, int steps, Pruning& pruning) {
  for (int step = 0; step < steps; ++step) level = grow(level, pruning);
  return level;
}

std::vector<int> SearchTree::schedule(const Node& node) const {
  std::vector<int> schedule;
  for (std::uint32_t link = node.link; link != 0; link = links_[link].parent) schedule.push_back(links_[link].choice);
  std::reverse(schedule.begin(), schedule.end());
  return schedule;
}

std::size_t cheapest(const Level& level) {
  DWELL_ASSERT(level.size() > 0);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < level.size(); ++i) least = std::min(least, level[i].cost);
  std::size_t first = 0;
  while (first + 1 < level.size() && !(level[first].cost <= least * (1.0 + kTie))) ++first;
  return first;
}

Solution solution_of(SearchTree& tree, const Level& last) {
  Solution solution = evaluate(tree.problem(), tree.schedule(last[cheapest(last)]));
  solution.expanded = tree.riccati().steps();
  return solution;
}

}  // namespace dwell::lti
