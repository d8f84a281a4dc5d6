#include "bandit/restless/problem.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "bandit/restless/covariance.hpp"

namespace dwell::restless {
namespace {

/// Rounding that a symmetric or semidefinite matrix may show, as a part of its largest element.
constexpr double kRounding = 1e-9;

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

class Checker {
 public:
  std::vector<Violation> violations;

  void refuse(const std::string& field, const std::string& value, const std::string& rule) {
    violations.push_back({field, value, rule});
  }

  void number(const std::string& field, double value, bool good, const std::string& rule) {
    if (!good || !std::isfinite(value)) refuse(field, text(value), rule);
  }

  bool size(const std::string& field, const Matrix& m, Eigen::Index rows, Eigen::Index columns) {
    if (m.rows() == rows && m.cols() == columns && m.allFinite()) return true;
    refuse(field, std::to_string(m.rows()) + " x " + std::to_string(m.cols()),
           "must be a finite matrix of " + std::to_string(rows) + " x " + std::to_string(columns));
    return false;
  }

  void semidefinite(const std::string& field, const Matrix& m, Eigen::Index n) {
    if (!symmetric(field, m, n)) return;
    const double least = least_eigenvalue(m);
    if (least >= -kRounding * m.cwiseAbs().maxCoeff()) return;
    refuse(field, "least eigenvalue " + text(least), "must be positive semidefinite");
  }

  void definite(const std::string& field, const Matrix& m, Eigen::Index n) {
    if (!symmetric(field, m, n) || m.llt().info() == Eigen::Success) return;
    refuse(field, "least eigenvalue " + text(least_eigenvalue(m)), "must be positive definite");
  }

 private:
  static double least_eigenvalue(const Matrix& m) {
    return Eigen::SelfAdjointEigenSolver<Matrix>(m, Eigen::EigenvaluesOnly).eigenvalues().minCoeff();
  }

  bool symmetric(const std::string& field, const Matrix& m, Eigen::Index n) {
    if (!size(field, m, n, n)) return false;
    const double apart = (m - m.transpose()).cwiseAbs().maxCoeff();
    if (apart <= kRounding * m.cwiseAbs().maxCoeff()) return true;
    refuse(field, "elements that differ by " + text(apart), "must be symmetric");
    return false;
  }
};

void check_arm(Checker& check, const std::string& name, const Arm& arm) {
  const Eigen::Index n = arm.f.rows();
  if (n < 1 || n > kMaximumStates) {
    check.refuse(name + ".f", std::to_string(n) + " rows",
                 "must have 1 to " + std::to_string(kMaximumStates) + " rows");
    return;
  }
  check.size(name + ".f", arm.f, n, n);
  check.semidefinite(name + ".q", arm.q, n);
  check.semidefinite(name + ".cost", arm.cost, n);
  check.semidefinite(name + ".p0", arm.p0, n);
  check.number(name + ".weight", arm.weight, arm.weight >= 0.0, "must be finite and >= 0");
  check.number(name + ".dwell", arm.dwell, arm.dwell > 0.0, "must be finite and > 0");
  if (arm.sensors.empty()) check.refuse(name + ".sensor", "", "one sensor at least is required");
  for (std::size_t s = 0; s < arm.sensors.size(); ++s) {
    const Sensor& sensor = arm.sensors[s];
    const std::string at = name + ".sensor[" + std::to_string(s + 1) + "]";
    if (sensor.h.rows() < 1) {
      check.refuse(at + ".h", "0 rows", "must have 1 to " + std::to_string(kMaximumStates) + " rows");
      continue;
    }
    check.size(at + ".h", sensor.h, sensor.h.rows(), n);
    check.definite(at + ".r", sensor.r, sensor.h.rows());
    check.number(at + ".p_detect", sensor.p_detect, sensor.p_detect > 0.0 && sensor.p_detect <= 1.0,
                 "must be above 0, at most 1");
  }
}

std::string name_of_arm(std::size_t i) { return "arm[" + std::to_string(i + 1) + "]"; }

void check_costs(Checker& check, const std::string& name, const Arm& arm, double discount) {
  double missed = 1.0;
  for (const Sensor& sensor : arm.sensors) missed = std::min(missed, 1.0 - sensor.p_detect);
  const double radius = spectral_radius(arm.f);
  if (discount * radius * radius * missed >= 1.0) {
    check.refuse(name + ".sensor", "largest p_detect " + text(1.0 - missed),
                 "must be above " + text(1.0 - 1.0 / (discount * radius * radius)) +
                     ": misses in a row grow f faster than they are rare, the expected cost is infinite");
    return;
  }
  const double memory = discount * all_looks(arm).memory;
  if (!(memory < 1.0 + kRounding)) {
    check.refuse(name + ".f", "spectral radius " + text(radius), "must be below 1 in what no sensor sees");
  } else if (memory > kMostMemory) {
    check.refuse(name + ".q", "",
                 "what no sensor sees must decay, and what neither grows nor decays needs process noise (some 1e-8 r): "
                 "else the arm never forgets where it started");
  } else if (arm.states() == 1 && missed > 0.0 && !(arm.q(0, 0) > 0.0)) {
    check.refuse(name + ".q", "0", "must be above 0 where looks may miss");
  }
}

}  // namespace

std::vector<Violation> validate(const Problem& problem) {
  Checker check;
  if (problem.discount) {
    check.number("discount", *problem.discount, *problem.discount > 0.0 && *problem.discount < 1.0,
                 "must be above 0, below 1; none for the average cost");
  }
  if (problem.arms.empty()) check.refuse("arm", "", "one arm at least is required");
  const auto arms = static_cast<int>(problem.arms.size());
  if (problem.looks_per_scan < 1 || problem.looks_per_scan > std::max(1, arms)) {
    check.refuse("looks_per_scan", std::to_string(problem.looks_per_scan), "must be from 1 to the number of arms");
  }
  for (std::size_t i = 0; i < problem.arms.size(); ++i) {
    check_arm(check, name_of_arm(i), problem.arms[i]);
  }
  return std::move(check.violations);
}

std::vector<Violation> validate_costs(const Problem& problem) {
  Checker check;
  for (std::size_t i = 0; i < problem.arms.size(); ++i) {
    check_costs(check, name_of_arm(i), problem.arms[i], problem.discount_or_one());
  }
  return std::move(check.violations);
}

}  // namespace dwell::restless
