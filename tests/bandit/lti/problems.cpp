#include "tests/bandit/lti/problems.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace dwell::lti {
namespace {

/// Nearly constant velocity in the plane, state [x y vx vy], step 0.2 s: (9) of Chung et al.
Problem vehicle(const Eigen::Matrix2d& q, double initial_variance, const std::vector<Eigen::Matrix2d>& noises) {
  constexpr double h = 0.2;
  Problem problem;
  problem.a = Eigen::Matrix4d::Identity();
  problem.a(0, 2) = problem.a(1, 3) = h;
  Eigen::Matrix<double, 4, 2> b;
  b << h * h / 2, 0, 0, h * h / 2, h, 0, 0, h;
  problem.w = b * q * b.transpose();
  problem.initial = initial_variance * Eigen::Matrix4d::Identity();
  for (const Eigen::Matrix2d& r : noises) problem.sensors.push_back({Eigen::MatrixXd::Identity(2, 4), r});
  return problem;
}

Eigen::MatrixXd normal_matrix(int rows, int cols, RandomStream& stream) {
  Eigen::MatrixXd m(rows, cols);
  for (double& entry : m.reshaped()) entry = stream.normal();
  return m;
}

int whole(int low, int high, RandomStream& stream) {
  return low + static_cast<int>(stream.uniform() * (high - low + 1));
}

Eigen::MatrixXd covariance_of_any_rank(int n, RandomStream& stream) {
  const int rank = whole(0, n, stream);
  const Eigen::MatrixXd root = normal_matrix(n, rank, stream);
  return root * root.transpose();
}

}  // namespace

Problem chung(double communication_noise) {
  const Eigen::Matrix2d q = Eigen::Vector2d(0.0100, 0.0262).asDiagonal();
  const Eigen::Matrix2d r1 = Eigen::Vector2d(0.0003, 0.0273).asDiagonal();
  const Eigen::Matrix2d r2 = Eigen::Vector2d(0.0110, 0.0018).asDiagonal();
  Problem problem = vehicle(q, 0.01, {r1, r2});
  problem.horizon = 20;
  problem.communication_noise = communication_noise;
  return problem;
}

Problem gupta(int horizon) {
  const Eigen::Matrix2d q{{1.0, 0.25}, {0.25, 1.0}};
  const Eigen::Matrix2d r1 = Eigen::Vector2d(3.24, 0.04).asDiagonal();
  const Eigen::Matrix2d r2 = Eigen::Vector2d(0.36, 2.25).asDiagonal();
  const Eigen::Matrix2d r3{{1.36, 1.20}, {1.20, 1.36}};
  Problem problem = vehicle(q, 1.0, {r1, r2, r3});
  problem.horizon = horizon;
  return problem;
}

Problem alriksson(double r, int horizon) {
  Problem problem;
  problem.horizon = horizon;
  problem.objective = Objective::kFinal;
  problem.a = Eigen::Matrix2d{{0.9, 0.009}, {0.009, 0.9}};
  problem.w = 10.0 * Eigen::Matrix2d::Identity();
  problem.initial = Eigen::Matrix2d::Identity();
  problem.sensors = {{Eigen::RowVector2d(1.0, 0.0), Eigen::MatrixXd::Constant(1, 1, 1.0)},
                     {Eigen::RowVector2d(0.0, 1.0), Eigen::MatrixXd::Constant(1, 1, r)}};
  return problem;
}

Problem random_problem(const RandomSize& size, RandomStream& stream) {
  const int n = size.states;
  Problem problem;
  problem.horizon = size.horizon;
  // Entries of variance 1/n: spectral radius about one, times 0.6 .. 1.4.
  problem.a = stream.uniform(0.6, 1.4) / std::sqrt(n) * normal_matrix(n, n, stream);
  problem.w = covariance_of_any_rank(n, stream);
  problem.initial = covariance_of_any_rank(n, stream);
  for (int j = 0; j < size.sensors; ++j) {
    const int rows = whole(1, n + 1, stream);
    const Eigen::MatrixXd root = normal_matrix(rows, rows, stream);
    const Eigen::MatrixXd noise = root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(rows, rows);
    problem.sensors.push_back({normal_matrix(rows, n, stream), stream.uniform(0.1, 4.0) * noise});
  }
  return problem;
}

Problem random_variant(RandomStream& stream) {
  const int states = whole(1, 4, stream);
  const int sensors = whole(1, 3, stream);
  Problem problem = random_problem({states, sensors, whole(1, 6, stream)}, stream);
  const auto sometimes = [&] { return stream.uniform() < 0.4; };
  if (sometimes()) problem.covariance = CovarianceKind::kFiltered;
  if (sometimes()) problem.objective = Objective::kFinal;
  if (sometimes()) problem.allow_idle = true;
  if (sometimes()) problem.communication_noise = stream.uniform(0.01, 2.0);
  const double scale = problem.w.trace() + problem.initial.trace();
  for (Sensor& sensor : problem.sensors) {
    if (sometimes()) sensor.max_looks = whole(1, problem.horizon, stream);
    if (sometimes() && problem.objective == Objective::kSum) sensor.cost = scale * stream.uniform();
  }
  problem.spread = sometimes();
  // One sensor without a limit: every step has something to do.
  problem.sensors.back().max_looks = 0;
  return problem;
}

std::vector<std::vector<int>> all_schedules(const Problem& problem) {
  std::vector<std::vector<int>> schedules(1);
  for (int k = 0; k < problem.horizon; ++k) {
    std::vector<std::vector<int>> longer;
    for (const std::vector<int>& schedule : schedules) {
      for (int choice = problem.allow_idle ? 0 : 1; choice <= problem.sensor_count(); ++choice) {
        const int limit = choice == 0 ? 0 : problem.sensors[static_cast<std::size_t>(choice - 1)].max_looks;
        const double share = problem.spread ? (k + 1.0) / problem.horizon : 1.0;
        const auto taken = static_cast<double>(std::count(schedule.begin(), schedule.end(), choice));
        // Whole numbers of looks, but for rounding.
        if (limit > 0 && taken + 1.0 > std::ceil(limit * share - 1e-9)) continue;
        longer.push_back(schedule);
        longer.back().push_back(choice);
      }
    }
    schedules = std::move(longer);
  }
  return schedules;
}

Cost textbook_cost(const Problem& problem, const std::vector<int>& schedule) {
  const int blocks = problem.communication_noise > 0.0 ? problem.sensor_count() : 1;
  const bool filtered = problem.covariance == CovarianceKind::kFiltered;
  const double counts = blocks > 1 ? 1.0 : problem.sensor_count();
  Cost cost{0.0, 0.0};
  for (int block = 0; block < blocks; ++block) {
    Eigen::MatrixXd p = problem.initial;
    if (!filtered) cost.objective += counts * p.trace();
    for (const int choice : schedule) {
      if (filtered) p = problem.a * p * problem.a.transpose() + problem.w;
      if (choice > 0) {
        const Sensor& sensor = problem.sensors[static_cast<std::size_t>(choice - 1)];
        Eigen::MatrixXd s = sensor.c * p * sensor.c.transpose() + sensor.r;
        if (choice - 1 != block) s.diagonal().array() += problem.communication_noise;
        p -= p * sensor.c.transpose() * s.ldlt().solve(sensor.c * p);
      }
      if (!filtered) p = problem.a * p * problem.a.transpose() + problem.w;
      cost.objective += counts * p.trace();
    }
    cost.final_trace += p.trace();
  }
  for (const int choice : schedule) {
    if (choice > 0) cost.objective += problem.sensors[static_cast<std::size_t>(choice - 1)].cost;
  }
  if (problem.objective == Objective::kFinal) cost.objective = cost.final_trace;
  return cost;
}

Cost enumerated_minimum(const Problem& problem) {
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  Cost least{kNothing, kNothing};
  for (const std::vector<int>& schedule : all_schedules(problem)) {
    const Cost cost = textbook_cost(problem, schedule);
    least.objective = std::min(least.objective, cost.objective);
    least.final_trace = std::min(least.final_trace, cost.final_trace);
  }
  return least;
}

std::vector<int> schedule_of(const std::string& digits) {
  std::vector<int> schedule;
  for (const char digit : digits) schedule.push_back(digit - '0');
  return schedule;
}

std::string digits_of(const std::vector<int>& schedule) {
  std::string digits;
  for (const int choice : schedule) digits += static_cast<char>('0' + choice);
  return digits;
}

}  // namespace dwell::lti
