#include "bandit/lti/averaged_riccati.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "bandit/lti/simplex_descent.hpp"

namespace dwell::lti {
namespace {

constexpr double kLargest = 1e12;  // times the start: taken for divergence
constexpr int kNewtonSteps = 100;
constexpr double kConverged = 1e-11;   // change of X, relative; the next would be its square
constexpr double kFinestScale = 1e-6;  // of A, on the way back up
constexpr double kCorner = 0.9;        // how near a corner a descent starts

/// Y -> sum_i q_i f_i Y f_i' over symmetric Y, as a matrix on the entries (r, c), r >= c.
Eigen::MatrixXd second_moment_map(const std::vector<Matrix>& f, const Eigen::VectorXd& q, bool transposed) {
  const Eigen::Index n = f.front().rows();
  Eigen::MatrixXd map(n * (n + 1) / 2, n * (n + 1) / 2);
  Eigen::Index column = 0;
  for (Eigen::Index c = 0; c < n; ++c) {
    for (Eigen::Index r = c; r < n; ++r, ++column) {
      Matrix image = Matrix::Zero(n, n);
      for (std::size_t i = 0; i < f.size(); ++i) {
        const Matrix g = transposed ? Matrix(f[i].transpose()) : f[i];
        const Matrix product = q[static_cast<Eigen::Index>(i)] * g.col(r) * g.col(c).transpose();
        image += product;
        if (r != c) image += product.transpose();
      }
      Eigen::Index row = 0;
      for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index i = j; i < n; ++i, ++row) map(row, column) = image(i, j);
      }
    }
  }
  return map;
}

/// Solves Y - map(Y) = right.
class Lyapunov {
 public:
  Lyapunov(const std::vector<Matrix>& f, const Eigen::VectorXd& q, bool transposed)
      : lu_(Eigen::MatrixXd::Identity(size(f), size(f)) - second_moment_map(f, q, transposed)) {}

  Matrix solve(const Matrix& right) const {
    const Eigen::Index n = right.rows();
    Eigen::VectorXd entries(n * (n + 1) / 2);
    Eigen::Index row = 0;
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = j; i < n; ++i) entries[row++] = right(i, j);
    }
    entries = lu_.solve(entries).eval();
    Matrix y(n, n);
    row = 0;
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = j; i < n; ++i) y(i, j) = y(j, i) = entries[row++];
    }
    return y;
  }

 private:
  static Eigen::Index size(const std::vector<Matrix>& f) { return f.front().rows() * (f.front().rows() + 1) / 2; }
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
};

Problem scaled(Problem problem, double a_scale) {
  problem.a *= a_scale;
  return problem;
}

}  // namespace

struct AveragedRiccati::Average {
  Matrix next;             // sum_i q_i F_i(X)
  std::vector<Matrix> of;  // F_i(X)
  std::vector<Matrix> f;   // dF_i = f_i dX f_i'
};

AveragedRiccati::AveragedRiccati(const Problem& problem, double a_scale) : riccati_(scaled(problem, a_scale)) {
  // Above P[0] in every direction, so that the limit is the largest fixed point.
  const Eigen::Index n = problem.states();
  const double level = problem.initial.trace() + problem.w.trace();
  start_ = problem.initial + problem.w + (level > 0.0 ? level : 1.0) * Eigen::MatrixXd::Identity(n, n);
  last_.assign(static_cast<std::size_t>(riccati_.blocks()), start_);
}

AveragedRiccati::Average AveragedRiccati::average(int block, const Matrix& x, const Eigen::VectorXd& q) {
  Average average{Matrix::Zero(x.rows(), x.cols()), {}, {}};
  Sensitivity sensitivity;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    average.of.push_back(riccati_.step(x, riccati_.root(block, static_cast<int>(i) + 1), &sensitivity));
    average.f.push_back(sensitivity.f);
    average.next += q[i] * average.of.back();
  }
  return average;
}

std::optional<Matrix> AveragedRiccati::solve_block(int block, const Eigen::VectorXd& q) {
  const Matrix identity = Matrix::Identity(start_.rows(), start_.cols());
  Matrix x = last_[static_cast<std::size_t>(block)];
  int plain = 1;  // plain steps between two tries of Newton's, doubled each time
  for (int newton = 0; newton < kNewtonSteps;) {
    const Average now = average(block, x, q);
    const Lyapunov lyapunov(now.f, q, false);
    if (Eigen::LLT<Matrix>(lyapunov.solve(identity)).info() == Eigen::Success) {
      const Matrix change = lyapunov.solve(now.next - x);
      x += change;
      if (change.norm() <= kConverged * (x.norm() + kConverged * start_.norm())) break;
      ++newton;
      continue;
    }
    if (newton > 0 || plain == 1) x = start_;
    for (int step = 0; step < plain; ++step) x = average(block, x, q).next;
    if (plain > (1 << 14) || !(x.norm() <= kLargest * start_.norm())) return std::nullopt;
    newton = 0;
    plain *= 2;
  }
  last_[static_cast<std::size_t>(block)] = x;
  return x;
}

std::optional<AveragedRiccati::FixedPoint> AveragedRiccati::fixed_point(const Eigen::VectorXd& q) {
  FixedPoint result{0.0, Eigen::VectorXd::Zero(q.size())};
  for (int block = 0; block < riccati_.blocks(); ++block) {
    const std::optional<Matrix> x = solve_block(block, q);
    if (!x) return std::nullopt;
    const Average at = average(block, *x, q);
    const Matrix adjoint = Lyapunov(at.f, q, true).solve(Matrix::Identity(x->rows(), x->cols()));
    result.trace += x->trace();
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      result.gradient[i] += adjoint.cwiseProduct(at.of[static_cast<std::size_t>(i)]).sum();
    }
  }
  return result;
}

namespace {

Eigen::VectorXd middle(const Problem& problem) {
  return Eigen::VectorXd::Constant(problem.sensor_count(), 1.0 / problem.sensor_count());
}

Eigen::VectorXd descend_from(AveragedRiccati& averaged, const Eigen::VectorXd& start) {
  const SimplexFunction trace = [&](const Eigen::MatrixXd& q, Eigen::MatrixXd& gradient) {
    const auto at = averaged.fixed_point(q.col(0));
    if (!at) return std::numeric_limits<double>::infinity();
    gradient = at->gradient;
    return at->trace;
  };
  return descend(trace, start, DescentSettings{});
}

/// A q with a fixed point, or none.
std::optional<Eigen::VectorXd> with_fixed_point(const Problem& problem, std::uint64_t& steps) {
  Eigen::VectorXd q = middle(problem);
  const double radius = Eigen::EigenSolver<Eigen::MatrixXd>(problem.a, false).eigenvalues().cwiseAbs().maxCoeff();
  for (double good = std::min(1.0, 0.99 / radius), next = 1.0; next - good > kFinestScale || next == 1.0;) {
    AveragedRiccati averaged(problem, next);
    const bool exists = averaged.fixed_point(q).has_value();
    steps += averaged.steps();
    if (exists && next == 1.0) return q;
    if (exists) {
      q = descend_from(averaged, q);
      good = next;
      next = 1.0;
    } else {
      next = 0.5 * (good + next);
      if (next - good <= kFinestScale) break;
    }
  }
  return std::nullopt;
}

}  // namespace

Probabilities uniform_probabilities(const Problem& problem) {
  AveragedRiccati averaged(problem, 1.0);
  Probabilities result{middle(problem), std::nullopt, 0};
  if (const auto at = averaged.fixed_point(result.q)) result.bound = at->trace;
  result.steps = averaged.steps();
  return result;
}

Probabilities optimal_probabilities(const Problem& problem) {
  Probabilities best{middle(problem), std::nullopt, 0};
  const std::optional<Eigen::VectorXd> first = with_fixed_point(problem, best.steps);
  if (!first) return best;
  std::vector<Eigen::VectorXd> starts{*first};
  for (int i = 0; i < problem.sensor_count(); ++i) {
    starts.emplace_back(kCorner * Eigen::VectorXd::Unit(problem.sensor_count(), i) + (1.0 - kCorner) * *first);
  }
  for (const Eigen::VectorXd& start : starts) {
    AveragedRiccati averaged(problem, 1.0);
    const Eigen::VectorXd q = descend_from(averaged, start);
    if (const auto at = averaged.fixed_point(q); at && (!best.bound || at->trace < *best.bound * (1.0 - 1e-12))) {
      best.q = q;
      best.bound = at->trace;
    }
    best.steps += averaged.steps();
  }
  return best;
}

}  // namespace dwell::lti
