#include "bandit/lti/problem.hpp"

#include <cmath>
#include <cstdio>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace dwell::lti {
namespace {

// Entries that were typed with a few digits: what a round trip through text leaves of symmetry, and of an eigenvalue
// that is zero on paper. Relative to the largest entry.
constexpr double kTyped = 1e-9;

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

std::string shape(const Eigen::MatrixXd& m) { return std::to_string(m.rows()) + " x " + std::to_string(m.cols()); }

class Check {
 public:
  void that(bool good, const std::string& field, const std::string& value, const std::string& rule) {
    if (!good) violations_.push_back({field, value, rule});
  }

  /// Finite and rows x cols; false where it is not.
  bool matrix(const std::string& field, const Eigen::MatrixXd& m, Eigen::Index rows, Eigen::Index cols) {
    const std::string wanted = std::to_string(rows) + " x " + std::to_string(cols);
    const bool fits = m.rows() == rows && m.cols() == cols;
    that(fits, field, shape(m), "must be " + wanted);
    that(m.allFinite(), field, "", "every entry must be finite");
    return fits && m.allFinite();
  }

  void covariance(const std::string& field, const Eigen::MatrixXd& m, Eigen::Index size, bool definite) {
    if (!matrix(field, m, size, size) || size == 0) return;
    const double scale = m.cwiseAbs().maxCoeff();
    const double asymmetry = (m - m.transpose()).cwiseAbs().maxCoeff();
    if (asymmetry > kTyped * scale) {
      that(false, field, "", "must be symmetric, but entries differ by " + text(asymmetry));
      return;
    }
    const Eigen::MatrixXd symmetric = 0.5 * (m + m.transpose());
    if (definite) {
      const Eigen::LLT<Eigen::MatrixXd> root(symmetric);
      that(root.info() == Eigen::Success, field, "", "must be positive definite");
    } else {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric, Eigen::EigenvaluesOnly);
      const double smallest = solver.eigenvalues()[0];
      that(smallest >= -kTyped * scale, field, "smallest eigenvalue " + text(smallest),
           "must be positive semidefinite");
    }
  }

  std::vector<Violation> take() { return std::move(violations_); }

 private:
  std::vector<Violation> violations_;
};

void check_sensor(Check& check, const Problem& problem, std::size_t index) {
  const Sensor& sensor = problem.sensors[index];
  const std::string field = "sensor[" + std::to_string(index + 1) + "].";
  check.that(sensor.c.rows() >= 1, field + "c", shape(sensor.c), "must have at least one row");
  check.matrix(field + "c", sensor.c, sensor.c.rows(), problem.states());
  check.covariance(field + "r", sensor.r, sensor.c.rows(), true);
  check.that(std::isfinite(sensor.cost) && sensor.cost >= 0.0, field + "cost", text(sensor.cost),
             "must be >= 0 and finite");
  check.that(problem.objective == Objective::kSum || sensor.cost == 0.0, field + "cost", text(sensor.cost),
             "must be 0 where the objective is the final trace");
  check.that(sensor.max_looks >= 0, field + "max_looks", std::to_string(sensor.max_looks), "must be >= 0");
}

}  // namespace

int looks_by(const Problem& problem, int sensor, int step) {
  const int limit = problem.sensors[static_cast<std::size_t>(sensor - 1)].max_looks;
  if (limit == 0) return std::numeric_limits<int>::max();
  if (!problem.spread) return limit;
  const auto share = static_cast<long long>(step) * limit;
  return static_cast<int>((share + problem.horizon - 1) / problem.horizon);
}

std::vector<Violation> validate(const Problem& problem) {
  Check check;
  const int n = problem.states();
  check.that(problem.horizon >= 1 && problem.horizon <= kMaximumHorizon, "horizon", std::to_string(problem.horizon),
             "must be from 1 to " + std::to_string(kMaximumHorizon));
  check.that(n >= 1 && n <= kMaximumStates, "a", shape(problem.a),
             "must have 1 to " + std::to_string(kMaximumStates) + " states");
  check.matrix("a", problem.a, n, n);
  check.covariance("w", problem.w, n, false);
  check.covariance("initial_covariance", problem.initial, n, false);
  check.that(problem.sensor_count() >= 1 && problem.sensor_count() <= std::numeric_limits<unsigned char>::max(),
             "sensor", std::to_string(problem.sensor_count()), "there must be 1 to 255 sensors");
  long looks = 0;
  bool limited = !problem.allow_idle;
  for (std::size_t j = 0; j < problem.sensors.size(); ++j) {
    check_sensor(check, problem, j);
    limited = limited && problem.sensors[j].max_looks > 0;
    looks += problem.sensors[j].max_looks;
  }
  check.that(!limited || problem.sensors.empty() || looks >= problem.horizon, "horizon",
             std::to_string(problem.horizon),
             "must not exceed the sum of max_looks, " + std::to_string(looks) + ", unless idle is allowed");
  check.that(std::isfinite(problem.communication_noise) && problem.communication_noise >= 0.0, "communication_noise",
             text(problem.communication_noise), "must be >= 0 and finite");
  return check.take();
}

}  // namespace dwell::lti
