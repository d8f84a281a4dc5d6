#include "bandit/lti/catalogue.hpp"

#include <cmath>
#include <string>

namespace dwell::lti {
namespace {

struct Validate {
  const Problem& problem;

  std::vector<Violation> operator()(const RoundRobinSettings&) const { return {}; }
  std::vector<Violation> operator()(const OptimumSettings&) const { return {}; }
  std::vector<Violation> operator()(const RandomSettings&) const { return {}; }
  std::vector<Violation> operator()(const FixedSettings& s) const {
    if (s.sensor >= 1 && s.sensor <= problem.sensor_count()) return {};
    return {{"sensor", std::to_string(s.sensor), "must be from 1 to " + std::to_string(problem.sensor_count())}};
  }
  std::vector<Violation> operator()(const WindowSettings& s) const { return at_least_one("d", s.d); }
  std::vector<Violation> operator()(const ThresholdSettings& s) const { return at_least_one("f", s.f); }
  std::vector<Violation> operator()(const BeamSettings& s) const { return at_least_one("width", s.width); }
  std::vector<Violation> operator()(const RelaxedDpSettings& s) const { return at_least_one("alpha", s.alpha); }

  template <class Number>
  static std::vector<Violation> at_least_one(const char* field, Number value) {
    if (value >= 1 && std::isfinite(static_cast<double>(value))) return {};
    return {{field, std::to_string(value), "must be >= 1 and finite"}};
  }
};

struct Solve {
  const Problem& problem;
  const RandomStream& stream;

  Solution operator()(const WindowSettings& s) const { return window(problem, s); }
  Solution operator()(const RoundRobinSettings&) const { return round_robin(problem); }
  Solution operator()(const FixedSettings& s) const { return fixed(problem, s); }
  Solution operator()(const RandomSettings& s) const { return random_choice(problem, s, stream); }
  Solution operator()(const ThresholdSettings& s) const { return threshold(problem, s); }
  Solution operator()(const BeamSettings& s) const { return beam(problem, s); }
  Solution operator()(const RelaxedDpSettings& s) const { return relaxed_dp(problem, s); }
  Solution operator()(const OptimumSettings&) const { return optimum(problem); }
};

}  // namespace

std::vector<Violation> validate(const PolicySettings& settings, const Problem& problem) {
  return std::visit(Validate{problem}, settings);
}

Solution solve(const Problem& problem, const Policy& policy, const RandomStream& stream) {
  Problem posed = problem;
  posed.spread = problem.spread || policy.spread;
  return std::visit(Solve{posed, stream}, policy.settings);
}

}  // namespace dwell::lti
