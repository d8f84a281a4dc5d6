#include "bandit/catalogue.hpp"

#include "bandit/beam.hpp"
#include "bandit/bhattacharyya.hpp"
#include "bandit/fixed.hpp"
#include "bandit/gittins_hmm.hpp"
#include "bandit/index.hpp"
#include "bandit/largest_variance.hpp"
#include "bandit/look_ahead.hpp"
#include "bandit/optimum.hpp"
#include "bandit/orbit.hpp"
#include "bandit/random_choice.hpp"
#include "bandit/relaxed_dp.hpp"
#include "bandit/round_robin.hpp"
#include "bandit/sa_imm.hpp"
#include "bandit/threshold.hpp"
#include "bandit/window.hpp"

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
  std::unique_ptr<Policy> operator()(const RandomSettings& s) const { return std::make_unique<RandomChoice>(s); }
  std::unique_ptr<Policy> operator()(const WindowSettings& s) const { return std::make_unique<Window>(s); }
  std::unique_ptr<Policy> operator()(const ThresholdSettings& s) const { return std::make_unique<Threshold>(s); }
  std::unique_ptr<Policy> operator()(const RelaxedDpSettings& s) const { return std::make_unique<RelaxedDp>(s); }
  std::unique_ptr<Policy> operator()(const BeamSettings& s) const { return std::make_unique<Beam>(s); }
  std::unique_ptr<Policy> operator()(const OptimumSettings& s) const { return std::make_unique<Optimum>(s); }
  std::unique_ptr<Policy> operator()(const LookAheadSettings& s) const { return std::make_unique<LookAhead>(s); }
  std::unique_ptr<Policy> operator()(const OrbitSettings& s) const { return std::make_unique<OrbitPolicy>(s); }
  std::unique_ptr<Policy> operator()(const IndexSettings& s) const { return std::make_unique<Index>(s); }
  std::unique_ptr<Policy> operator()(const GittinsHmmSettings& s) const { return std::make_unique<GittinsHmm>(s); }
};

}  // namespace

std::unique_ptr<Policy> make_policy(const PolicySettings& settings) { return std::visit(Make{}, settings); }

}  // namespace dwell
