#include "bandit/lti/relaxed_dp.hpp"

#include <algorithm>
#include <numeric>

#include "bandit/lti/loewner_cover.hpp"
#include "bandit/lti/optimum.hpp"
#include "bandit/lti/search_tree.hpp"

namespace dwell::lti {
namespace {

constexpr double kCoverTolerance = 1e-9;
/// Grown by the Riccati steps of `lo`.
class RelaxedPruning final : public Pruning {
 public:
  RelaxedPruning(const Problem& problem, double alpha)
      : problem_(problem),
        upper_(problem, alpha),
        block_sizes_(static_cast<std::size_t>(upper_.blocks()), problem.states()),
        budgets_(std::any_of(problem.sensors.begin(), problem.sensors.end(),
                             [](const Sensor& sensor) { return sensor.max_looks > 0; })) {}

  void select(const Level& parents, const Level& children, std::vector<std::size_t>& kept) override {
    std::vector<std::vector<double>> up(children.size(), std::vector<double>(upper_.size()));
    std::vector<double> trace(children.size());
    for (std::size_t i = 0; i < children.size(); ++i) {
      upper_.step(parents[children[i].parent].state, children[i].choice, up[i].data());
      trace[i] = upper_.trace(up[i].data());
    }
    std::vector<std::size_t> order(children.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return trace[i] < trace[j]; });
    LoewnerCover cover(block_sizes_);
    for (const std::size_t i : order) {
      const bool superfluous =
          budgets_ ? covered_within_budgets(children, kept, i, up[i]) : cover.covers(up[i], kCoverTolerance);
      if (superfluous) continue;
      kept.push_back(i);
      cover.add(std::span(children[i].state, up[i].size()));
      if (kept.size() > kMaximumSet) break;
    }
    std::sort(kept.begin(), kept.end());
    set_sizes_.push_back(kept.size());
  }

  std::uint64_t steps() const { return upper_.steps(); }
  const std::vector<std::size_t>& set_sizes() const { return set_sizes_; }

 private:
  /// By those that have used no more looks of any limited sensor.
  bool covered_within_budgets(const Level& children, const std::vector<std::size_t>& kept, std::size_t candidate,
                              std::span<const double> up) const {
    LoewnerCover cover(block_sizes_);
    for (const std::size_t i : kept) {
      if (no_more_looks(problem_, children[i].looks, children[candidate].looks)) {
        cover.add(std::span(children[i].state, up.size()));
      }
    }
    return cover.covers(up, kCoverTolerance);
  }

  const Problem& problem_;
  Riccati upper_;
  std::vector<int> block_sizes_;
  bool budgets_;
  std::vector<std::size_t> set_sizes_;
};

/// By the true trace.
Solution best_of(const SearchTree& tree, const Level& last) {
  Solution best = evaluate(tree.problem(), tree.schedule(last[0]));
  for (std::size_t i = 1; i < last.size(); ++i) {
    Solution other = evaluate(tree.problem(), tree.schedule(last[i]));
    if (other.final_trace < best.final_trace * (1.0 - kTie)) best = std::move(other);
  }
  return best;
}

/// `problem` may have another objective, and uses may cost.
Solution least_final_trace(const Problem& problem) {
  Problem of_final = problem;
  of_final.objective = Objective::kFinal;
  const Solution exact = optimum(of_final);
  Solution best = evaluate(problem, exact.schedule);
  best.expanded = exact.expanded;
  return best;
}

}  // namespace

Solution relaxed_dp(const Problem& problem, const RelaxedDpSettings& settings) {
  Riccati lower(problem, 1.0 / settings.alpha);
  SearchTree tree(problem, lower);
  RelaxedPruning pruning(problem, settings.alpha);
  Level level = tree.root();
  for (int step = 0; step < problem.horizon && level.size() <= kMaximumSet; ++step) level = tree.grow(level, pruning);
  Solution best = level.size() > kMaximumSet ? least_final_trace(problem) : best_of(tree, level);
  best.expanded += lower.steps() + pruning.steps();
  best.set_sizes = pruning.set_sizes();
  return best;
}

}  // namespace dwell::lti
