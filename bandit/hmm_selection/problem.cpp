#include "bandit/hmm_selection/problem.hpp"

#include <cmath>
#include <cstdio>

namespace dwell::hmm_selection {
namespace {

constexpr double kTyped = 1e-9;  // of a sum of probabilities that were typed

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

class Check {
 public:
  void that(bool good, const std::string& field, const std::string& value, const std::string& rule) {
    if (!good) violations_.push_back({field, value, rule});
  }

  /// `rows` rows, each a distribution.
  void distributions(const std::string& field, const Eigen::MatrixXd& m, Eigen::Index rows) {
    that(m.rows() == rows && m.cols() >= 1, field, std::to_string(m.rows()) + " x " + std::to_string(m.cols()),
         "must have " + std::to_string(rows) + " rows, one a state");
    for (Eigen::Index i = 0; i < m.rows() && m.cols() >= 1; ++i) {
      const bool good = m.row(i).allFinite() && m.row(i).minCoeff() >= 0.0 && std::abs(m.row(i).sum() - 1.0) <= kTyped;
      that(good, field, "row " + std::to_string(i + 1) + " sums to " + text(m.row(i).sum()),
           "must be probabilities that sum to one");
    }
  }

  std::vector<Violation> take() { return std::move(violations_); }

 private:
  std::vector<Violation> violations_;
};

}  // namespace

std::vector<Violation> validate(const Problem& problem) {
  Check check;
  const Eigen::Index s = problem.transition.rows();
  check.that(s >= 1 && s <= kMaximumStates && problem.transition.cols() == s, "transition",
             std::to_string(s) + " x " + std::to_string(problem.transition.cols()),
             "must be square, 1 to " + std::to_string(kMaximumStates) + " states");
  check.distributions("transition", problem.transition, s);
  check.that(problem.belief.size() == s, "belief", std::to_string(problem.belief.size()) + " entries",
             "must have one entry a state");
  check.distributions("belief", problem.belief.transpose(), 1);
  check.that(problem.horizon >= 1 && problem.horizon <= kMaximumHorizon, "horizon", std::to_string(problem.horizon),
             "must be from 1 to " + std::to_string(kMaximumHorizon));
  check.that(std::isfinite(problem.beta) && problem.beta > 0.0, "beta", text(problem.beta), "must be > 0 and finite");
  check.that(!problem.sensors.empty(), "sensor", "0", "there must be at least one sensor");
  for (std::size_t u = 0; u < problem.sensors.size(); ++u) {
    const Sensor& sensor = problem.sensors[u];
    const std::string field = "sensor[" + std::to_string(u + 1) + "].";
    check.distributions(field + "emission", sensor.emission, s);
    check.that(std::isfinite(sensor.cost) && sensor.cost >= 0.0, field + "cost", text(sensor.cost),
               "must be >= 0 and finite");
  }
  return check.take();
}

}  // namespace dwell::hmm_selection
