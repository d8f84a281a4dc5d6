#include "tracker/mode_bank.hpp"

#include <cmath>
#include <utility>

#include <unsupported/Eigen/MatrixFunctions>

#include "radar/assert.hpp"

namespace dwell {

std::optional<Eigen::MatrixXd> transition_over(const Eigen::MatrixXd& transition, double ratio) {
  const double whole = std::round(ratio);
  if (std::abs(ratio - whole) < 1e-12 * std::max(1.0, whole)) {
    Eigen::MatrixXd power = Eigen::MatrixXd::Identity(transition.rows(), transition.cols());
    for (long i = 0; i < static_cast<long>(whole); ++i) power = power * transition;
    return power;
  }
  constexpr double kRounding = 1e-12;  // of the exponential, with room
  constexpr double kSameChain = 1e-9;  // far above the logarithm's rounding, far below any probability that matters
  const Eigen::MatrixXd generator = transition.log();
  // A negative eigenvalue has a complex logarithm, whose real part generates another chain.
  if ((generator.exp() - transition).cwiseAbs().maxCoeff() > kSameChain) return std::nullopt;
  Eigen::MatrixXd result = (ratio * generator).exp();
  if (!result.allFinite() || result.minCoeff() < -kRounding) return std::nullopt;
  result = result.cwiseMax(0.0);
  const Eigen::VectorXd sums = result.rowwise().sum();
  return Eigen::MatrixXd(sums.cwiseInverse().asDiagonal() * result);
}

std::optional<DiscreteBank> discretise(const ModeBank& bank, double dt_s) {
  auto transition_matrix = transition_over(bank.transition, dt_s / bank.transition_interval_s);
  if (!transition_matrix) return std::nullopt;
  DiscreteBank discrete;
  discrete.transition = std::move(*transition_matrix);
  for (const Mode& mode : bank.modes) {
    DWELL_ASSERT(divides(mode.noise, dt_s));
    discrete.f.push_back(transition(mode.motion, dt_s));
    discrete.q.push_back(process_noise(mode.motion, mode.noise, dt_s));
  }
  return discrete;
}

}  // namespace dwell
