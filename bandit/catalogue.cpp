#include "bandit/catalogue.hpp"

namespace dwell {
namespace {

struct Make {
  std::unique_ptr<Policy> operator()(const SaImmSettings& s) const { return std::make_unique<SaImm>(s); }
  std::unique_ptr<Policy> operator()(const RoundRobinSettings& s) const { return std::make_unique<RoundRobin>(s); }
  std::unique_ptr<Policy> operator()(const FixedSettings& s) const { return std::make_unique<Fixed>(s); }
  std::unique_ptr<Policy> operator()(const LargestVarianceSettings& s) const {
    return std::make_unique<LargestVariance>(s);
  }
  std::unique_ptr<Policy> operator()(const BhattacharyyaSettings& s) const {
    return std::make_unique<Bhattacharyya>(s);
  }
};

}  // namespace

std::unique_ptr<Policy> make_policy(const PolicySettings& settings) { return std::visit(Make{}, settings); }

}  // namespace dwell
