#include "tracker/mode_bank.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "radar/assert.hpp"
#include "tracker/normal_orthant.hpp"

namespace dwell {

namespace {

Eigen::MatrixXd whole_power(const Eigen::MatrixXd& m, double exponent) {
  Eigen::MatrixXd power = Eigen::MatrixXd::Identity(m.rows(), m.cols());
  for (long i = 0; i < static_cast<long>(exponent); ++i) power = power * m;
  return power;
}

/// The principal square root, by the iteration of Denman and Beavers (1976); empty where it does not converge: an
/// eigenvalue is zero or negative.
std::optional<Eigen::MatrixXd> square_root(const Eigen::MatrixXd& m) {
  constexpr int kMost = 50;            // it doubles the digits
  constexpr double kConverged = 1e-9;  // far above rounding, far below any probability that matters
  Eigen::MatrixXd root = m;
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(m.rows(), m.cols());
  for (int i = 0; i < kMost; ++i) {
    const Eigen::MatrixXd next = 0.5 * (root + inverse.inverse());
    inverse = (0.5 * (inverse + root.inverse())).eval();
    const double change = (next - root).cwiseAbs().maxCoeff();
    root = next;
    if (!(change > 1e-15)) break;
  }
  if (!((root * root - m).cwiseAbs().maxCoeff() <= kConverged)) return std::nullopt;
  return root;
}

}  // namespace

std::optional<Eigen::MatrixXd> transition_over(const Eigen::MatrixXd& transition, double ratio) {
  constexpr double kRounding = 1e-12;  // of the roots' product, with room
  const double whole = std::round(ratio);
  if (std::abs(ratio - whole) < kRounding * std::max(1.0, whole)) return whole_power(transition, whole);
  Eigen::MatrixXd result = whole_power(transition, std::floor(ratio));
  Eigen::MatrixXd root = transition;
  // The fraction in binary: its digits are square roots of square roots.
  for (double fraction = ratio - std::floor(ratio); fraction > 0.0;) {
    const auto next = square_root(root);
    if (!next) return std::nullopt;
    root = *next;
    fraction *= 2.0;
    if (fraction < 1.0) continue;
    result = (result * root).eval();
    fraction -= 1.0;
  }
  if (!result.allFinite() || result.minCoeff() < -kRounding) return std::nullopt;
  result = result.cwiseMax(0.0);
  const Eigen::VectorXd sums = result.rowwise().sum();
  return Eigen::MatrixXd(sums.cwiseInverse().asDiagonal() * result);
}

Eigen::MatrixXd transition_at(const DiscreteBank& bank, std::span<const Gaussian> modes) {
  Eigen::MatrixXd guarded = Eigen::MatrixXd::Zero(bank.size(), bank.size());
  for (const Guard& guard : bank.guards) {
    const Gaussian& belief = modes[static_cast<std::size_t>(guard.from)];
    const Eigen::MatrixXd covariance =
        guard.l * belief.covariance * guard.l.transpose() + guard.noise_root * guard.noise_root.transpose();
    guarded(guard.from, guard.to) += normal_orthant(guard.l * belief.mean + guard.b, covariance);
  }
  for (Eigen::Index i = 0; i < guarded.rows(); ++i) {
    if (const double sum = guarded.row(i).sum(); sum > 1.0) guarded.row(i) /= sum;
  }
  const Eigen::VectorXd none = (1.0 - guarded.rowwise().sum().array()).cwiseMax(0.0);
  return guarded + none.asDiagonal() * bank.transition;
}

namespace {

/// F and Q of [x vx y vy] alone, from a standstill with trailing states of mean 0 and their start covariance.
void discretise_seen(const TrailingMotion& motion, DiscreteBank& discrete) {
  const Moved& moved = discrete.from_rest[discrete.f.size()];
  const Eigen::Matrix<double, kStateSize, 2> spreads = moved.f.topRightCorner<kStateSize, 2>();
  discrete.f.push_back(moved.f.topLeftCorner<kStateSize, kStateSize>());
  discrete.q.push_back(symmetric_part(moved.q.topLeftCorner<kStateSize, kStateSize>() +
                                      spreads * start_sigma(motion).cwiseAbs2().asDiagonal() * spreads.transpose()));
}

}  // namespace

std::optional<DiscreteBank> discretise(const ModeBank& bank, double dt_s) {
  auto transition_matrix = transition_over(bank.transition, dt_s / bank.transition_interval_s);
  if (!transition_matrix) return std::nullopt;
  DiscreteBank discrete;
  discrete.transition = std::move(*transition_matrix);
  discrete.guards = bank.guards;
  discrete.interval_s = dt_s;
  const auto has_trailing = [](const Mode& mode) { return mode.trailing.has_value(); };
  if (std::any_of(bank.modes.begin(), bank.modes.end(), has_trailing)) {
    for (const Mode& mode : bank.modes) {
      discrete.trailing.push_back(mode.trailing);
      discrete.from_rest.push_back(mode.trailing ? move(*mode.trailing, dt_s, FullState::Zero()) : Moved{});
    }
  }
  for (const Mode& mode : bank.modes) {
    if (mode.trailing) {
      discretise_seen(*mode.trailing, discrete);
      continue;
    }
    DWELL_ASSERT(divides(mode.noise, dt_s));
    discrete.f.push_back(transition(mode.motion, dt_s));
    discrete.q.push_back(process_noise(mode.motion, mode.noise, dt_s));
  }
  return discrete;
}

}  // namespace dwell
