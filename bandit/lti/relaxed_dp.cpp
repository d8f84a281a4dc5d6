#include "bandit/lti/relaxed_dp.hpp"

#include <algorithm>
#include <numeric>

#include "bandit/lti/loewner_cover.hpp"
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
        block_sizes_(static_cast<std::size_t>(upper_.blocks()), problem.states()) {}

  void select(const Level& parents, const Level& children, std::vector<std::size_t>& kept) override {
    std::vector<std::vector<double>> up(children.size(), std::vector<double>(upper_.size()));
    std::vector<double> trace(children.size());
    for (std::size_t i = 0; i < children.size(); ++i) {
      upper_.step(parents[children[i].parent].covariance, children[i].choice, up[i].data());
      trace[i] = upper_.trace(up[i].data());
    }
    std::vector<std::size_t> order(children.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return trace[i] < trace[j]; });
    for (const std::size_t i : order) {
      if (!covered(children, kept, i, up[i])) kept.push_back(i);
    }
    std::sort(kept.begin(), kept.end());
    set_sizes_.push_back(kept.size());
  }

  std::uint64_t steps() const { return upper_.steps(); }
  const std::vector<std::size_t>& set_sizes() const { return set_sizes_; }

 private:
  bool covered(const Level& children, const std::vector<std::size_t>& kept, std::size_t candidate,
               std::span<const double> up) const {
    LoewnerCover cover(block_sizes_);
    for (const std::size_t i : kept) {
      if (no_more_looks(problem_, children[i].looks, children[candidate].looks)) {
        cover.add(std::span(children[i].covariance, up.size()));
      }
    }
    return cover.covers(up, kCoverTolerance);
  }

  const Problem& problem_;
  Riccati upper_;
  std::vector<int> block_sizes_;
  std::vector<std::size_t> set_sizes_;
};

}  // namespace

Solution relaxed_dp(const Problem& problem, const RelaxedDpSettings& settings) {
  Riccati lower(problem, 1.0 / settings.alpha);
  SearchTree tree(problem, lower);
  RelaxedPruning pruning(problem, settings.alpha);
  const Level last = tree.grow(tree.root(), problem.horizon, pruning);
  Solution best = evaluate(problem, tree.schedule(last[0]));
  for (std::size_t i = 1; i < last.size(); ++i) {
    Solution other = evaluate(problem, tree.schedule(last[i]));
    if (other.final_trace < best.final_trace * (1.0 - kTie)) best = std::move(other);
  }
  best.expanded = lower.steps() + pruning.steps();
  best.set_sizes = pruning.set_sizes();
  return best;
}

}  // namespace dwell::lti
