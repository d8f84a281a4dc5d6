#include "bandit/lti/simplex_descent.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace dwell::lti {
namespace {

Eigen::MatrixXd projected(Eigen::MatrixXd q) {
  for (Eigen::Index column = 0; column < q.cols(); ++column) q.col(column) = nearest_on_simplex(q.col(column));
  return q;
}

}  // namespace

Eigen::VectorXd nearest_on_simplex(const Eigen::VectorXd& point) {
  std::vector<double> sorted(point.data(), point.data() + point.size());
  std::sort(sorted.begin(), sorted.end(), std::greater<>());
  double sum = 0.0;
  double shift = 0.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    sum += sorted[i];
    const double candidate = (sum - 1.0) / static_cast<double>(i + 1);
    if (sorted[i] > candidate) shift = candidate;
  }
  return (point.array() - shift).max(0.0);
}

Eigen::MatrixXd descend(const SimplexFunction& function, Eigen::MatrixXd q, const DescentSettings& settings) {
  constexpr double kSufficient = 1e-4;  // Armijo's part of the first-order decrease
  constexpr std::size_t kMemory = 10;   // values that a new one may not exceed all of
  constexpr int kShortenings = 60;      // halvings, down to rounding
  Eigen::MatrixXd gradient(q.rows(), q.cols());
  Eigen::MatrixXd new_gradient(q.rows(), q.cols());
  std::vector<double> values(1, function(q, gradient));
  if (!std::isfinite(values.front())) return q;
  const double scale = gradient.cwiseAbs().maxCoeff();
  if (scale == 0.0) return q;
  double length = 1.0 / scale;
  Eigen::MatrixXd best = q;
  double best_value = values.front();
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    if ((projected(q - gradient / scale) - q).cwiseAbs().maxCoeff() <= settings.tolerance) break;
    const Eigen::MatrixXd direction = projected(q - length * gradient) - q;
    const double slope = gradient.cwiseProduct(direction).sum();
    const double reference =
        *std::max_element(values.end() - static_cast<std::ptrdiff_t>(std::min(kMemory, values.size())), values.end());
    double part = 1.0;
    double value = 0.0;
    int shortenings = 0;
    for (;; part *= 0.5, ++shortenings) {
      value = function(q + part * direction, new_gradient);
      if (value <= reference + kSufficient * part * slope || shortenings == kShortenings) break;
    }
    if (shortenings == kShortenings) break;
    const Eigen::MatrixXd moved = part * direction;
    const double bend = moved.cwiseProduct(new_gradient - gradient).sum();
    length = bend > 0.0 ? std::clamp(moved.squaredNorm() / bend, 1e-10 / scale, 1e10 / scale) : 1e10 / scale;
    q += moved;
    gradient = new_gradient;
    values.push_back(value);
    if (value < best_value) {
      best_value = value;
      best = q;
    }
  }
  return best;
}

}  // namespace dwell::lti
