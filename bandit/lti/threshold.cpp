#include "bandit/lti/threshold.hpp"

namespace dwell::lti {
namespace {

class ThresholdPruning final : public Pruning {
 public:
  explicit ThresholdPruning(double f) : f_(f) {}

  void select(const Level& /*parents*/, const Level& children, std::vector<std::size_t>& kept) override {
    const double least = children[cheapest(children)].cost;
    for (std::size_t i = 0; i < children.size(); ++i) {
      if (children[i].cost <= f_ * least * (1.0 + kTie)) kept.push_back(i);
    }
  }

 private:
  double f_;
};

}  // namespace

Solution threshold(const Problem& problem, const ThresholdSettings& settings) {
  Riccati riccati(problem);
  SearchTree tree(problem, riccati);
  ThresholdPruning pruning(settings.f);
  const Level last = tree.grow(tree.root(), problem.horizon, pruning);
  return solution_of(tree, last);
}

}  // namespace dwell::lti
