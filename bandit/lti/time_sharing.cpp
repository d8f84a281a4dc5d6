#include "bandit/lti/time_sharing.hpp"

#include <algorithm>
#include <functional>
#include <limits>

#include "bandit/lti/simplex_descent.hpp"

namespace dwell::lti {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
// Of the shares, which need only be good: any give a bound.
constexpr DescentSettings kDescent{200, 1e-6};
constexpr int kPriceRounds = 3;
constexpr int kBudgetRounds = 8;

}  // namespace

double assignment_bound(const Eigen::MatrixXd& cost, const std::vector<double>& left) {
  const Eigen::Index columns = cost.cols();
  Eigen::VectorXd price = Eigen::VectorXd::Zero(cost.rows());
  std::vector<double> gain(static_cast<std::size_t>(columns));
  const bool limited =
      std::any_of(left.begin(), left.end(), [&](double l) { return l < static_cast<double>(columns); });
  for (int round = 0; limited && round < kPriceRounds; ++round) {
    for (Eigen::Index c = 0; c < cost.rows(); ++c) {
      const double available = left[static_cast<std::size_t>(c)];
      if (available >= static_cast<double>(columns)) continue;
      // At the best price the row is taken in the columns of its `available` largest gains over the other rows.
      price[c] = kUnlimited;
      for (Eigen::Index k = 0; k < columns; ++k) {
        gain[static_cast<std::size_t>(k)] = (cost.col(k) + price).minCoeff() - cost(c, k);
      }
      const auto next = gain.begin() + static_cast<std::ptrdiff_t>(available);
      std::nth_element(gain.begin(), next, gain.end(), std::greater<>());
      price[c] = std::max(0.0, *next);
    }
  }
  double bound = 0.0;
  for (Eigen::Index k = 0; k < columns; ++k) bound += (cost.col(k) + price).minCoeff();
  for (Eigen::Index c = 0; c < cost.rows(); ++c) {
    if (price[c] > 0.0) bound -= price[c] * left[static_cast<std::size_t>(c)];
  }
  return bound;
}

TimeSharing::TimeSharing(SearchTree& tree, const Node& node, int steps)
    : tree_(tree), first_choice_(tree.problem().allow_idle ? 0 : 1) {
  if (first_choice_ == 0) use_cost_.push_back(0.0);
  for (const Sensor& sensor : tree.problem().sensors) use_cost_.push_back(sensor.cost);
  aim(node, steps);
}

/// Infinite where there is no limit.
std::vector<double> TimeSharing::looks_left(const Node& node) const {
  std::vector<double> left(use_cost_.size(), kUnlimited);
  for (std::size_t j = 0; j < node.looks.size(); ++j) {
    const int limit = tree_.problem().sensors[j].max_looks;
    if (limit > 0) left[j + (first_choice_ == 0 ? 1 : 0)] = limit - node.looks[j];
  }
  return left;
}

/// Descends in the shares; budgets by an augmented Lagrangian with multipliers lambda and weight rho:
/// f(q) + sum_j (max(0, lambda_j + rho (sum_k q_kj - b_j))^2 - lambda_j^2) / (2 rho).
void TimeSharing::aim(const Node& node, int steps) {
  const std::vector<double> left = looks_left(node);
  const bool limited = std::any_of(left.begin(), left.end(), [&](double l) { return l < steps; });
  Eigen::MatrixXd q = Eigen::MatrixXd::Constant(choices(), steps, 1.0 / choices());
  share(q);
  cost(node.state, steps, gradient_);
  const double rho = gradient_.cwiseAbs().maxCoeff() / steps + std::numeric_limits<double>::min();
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(choices());
  for (int round = 0; round < (limited ? kBudgetRounds : 1); ++round) {
    const auto pressure = [&](const Eigen::MatrixXd& shares, int c) {
      return std::max(0.0, lambda[c] + rho * (shares.row(c).sum() - left[static_cast<std::size_t>(c)]));
    };
    q = descend(
        [&](const Eigen::MatrixXd& shares, Eigen::MatrixXd& gradient) {
          share(shares);
          double value = cost(node.state, steps, gradient);
          for (int c = 0; limited && c < choices(); ++c) {
            const double push = pressure(shares, c);
            value += 0.5 * (push * push - lambda[c] * lambda[c]) / rho;
            gradient.row(c).array() += push;
          }
          return value;
        },
        q, kDescent);
    for (int c = 0; c < choices(); ++c) lambda[c] = pressure(q, c);
  }
  share(q);
}

void TimeSharing::share(const Eigen::MatrixXd& shares) {
  shares_ = shares.cwiseMax(0.0);
  roots_.clear();
  std::vector<Matrix> of_sensor(use_cost_.size());
  for (Eigen::Index k = 0; k < shares_.cols(); ++k) {
    for (int block = 0; block < tree_.riccati().blocks(); ++block) {
      for (int c = 0; c < choices(); ++c) {
        of_sensor[static_cast<std::size_t>(c)] = tree_.riccati().root(block, first_choice_ + c);
      }
      roots_.push_back(joint_root(of_sensor, std::span(shares_.col(k).data(), use_cost_.size())));
    }
  }
}

/// f of the last `steps` columns of the shares, and its gradient.
double TimeSharing::cost(const double* covariance, int steps, Eigen::MatrixXd& gradient) {
  gradient.resize(choices(), steps);
  double value = 0.0;
  for (int c = 0; c < choices(); ++c) {
    gradient.row(c).setConstant(use_cost_[static_cast<std::size_t>(c)]);
    value += use_cost_[static_cast<std::size_t>(c)] * shares_.row(c).tail(steps).sum();
  }
  for (int block = 0; block < tree_.riccati().blocks(); ++block) {
    value += cost_of_block(block, covariance + static_cast<std::size_t>(block) * tree_.riccati().block_size(), steps,
                           gradient);
  }
  return value;
}

/// Forward: the covariances. Backward: L_k = dcost/dP[k], and with dP+ = F dP F' - B d(H'H) B'
///   L_k = weight I + F' L_{k+1} F,      dcost/dq_kj = -tr(B' L_{k+1} B M_j) = -sum of H_j (B' L B) o H_j.
double TimeSharing::cost_of_block(int block, const double* covariance, int steps, Eigen::MatrixXd& gradient) {
  Riccati& riccati = tree_.riccati();
  const int n = riccati.states();
  const auto first = static_cast<std::size_t>(shares_.cols() - steps);
  sensitivity_.resize(static_cast<std::size_t>(steps));
  double value = 0.0;
  Matrix p = Eigen::Map<const Eigen::MatrixXd>(covariance, n, n);
  for (std::size_t k = 0; k < sensitivity_.size(); ++k) {
    const std::size_t root = (first + k) * static_cast<std::size_t>(riccati.blocks()) + static_cast<std::size_t>(block);
    p = riccati.step(p, roots_[root], &sensitivity_[k]);
    value += tree_.trace_weight() * p.trace();
  }
  Matrix adjoint = Matrix::Zero(n, n);
  for (int k = steps - 1; k >= 0; --k) {
    const auto& [f, b] = sensitivity_[static_cast<std::size_t>(k)];
    adjoint.diagonal().array() += tree_.trace_weight();
    const Matrix adjoint_b = adjoint * b;
    const Matrix told = b.transpose() * adjoint_b;
    for (int c = 0; c < choices(); ++c) {
      const Matrix& h = riccati.root(block, first_choice_ + c);
      const Matrix h_told = h * told;
      gradient(c, k) -= h_told.cwiseProduct(h).sum();
    }
    const Matrix adjoint_f = adjoint * f;
    adjoint.noalias() = f.transpose() * adjoint_f;
  }
  return value;
}

double TimeSharing::bound(const Node& node, int steps) {
  if (steps == 0) return 0.0;
  const double value = cost(node.state, steps, gradient_);
  const double at_shares = gradient_.cwiseProduct(shares_.rightCols(steps)).sum();
  return value - at_shares + assignment_bound(gradient_, looks_left(node));
}

}  // namespace dwell::lti
