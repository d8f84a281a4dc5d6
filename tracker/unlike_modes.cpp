#include "tracker/unlike_modes.hpp"

#include <cmath>

namespace dwell {
namespace {

TrailingKind kind_of(const DiscreteBank& bank, std::size_t mode) {
  return bank.trailing[mode] ? trailing_kind(*bank.trailing[mode]) : TrailingKind::kNone;
}

FullGaussian full_state(const DiscreteBank& bank, const ImmEstimate& estimate, std::size_t mode) {
  if (!bank.trailing[mode]) return join(estimate.modes[mode], {});
  if (!estimate.trailing.empty()) return join(estimate.modes[mode], estimate.trailing[mode]);
  Trailing start;
  start.c = start_covariance(*bank.trailing[mode]);
  return join(estimate.modes[mode], start);
}

/// The kinematic states of one, and the trailing states of the other.
FullGaussian with_trailing_of(const FullGaussian& one, const FullGaussian& other) {
  FullGaussian made;
  made.mean << one.mean.head<kStateSize>(), other.mean.tail<2>();
  made.covariance.topLeftCorner<kStateSize, kStateSize>() = one.covariance.topLeftCorner<kStateSize, kStateSize>();
  made.covariance.bottomRightCorner<2, 2>() = other.covariance.bottomRightCorner<2, 2>();
  return made;
}

FullGaussian moment_match(const std::vector<FullGaussian>& parts, const Eigen::VectorXd& weight) {
  FullGaussian matched;
  for (std::size_t i = 0; i < parts.size(); ++i) matched.mean += weight[static_cast<Eigen::Index>(i)] * parts[i].mean;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const FullState spread = parts[i].mean - matched.mean;
    matched.covariance += weight[static_cast<Eigen::Index>(i)] * (parts[i].covariance + spread * spread.transpose());
  }
  return matched;
}

/// One interval on by mode j.
FullGaussian moved_on(const DiscreteBank& bank, std::size_t j, const FullGaussian& mixed) {
  FullGaussian next;
  if (bank.trailing[j]) {
    Moved moved = bank.from_rest[j];
    if (is_linear(*bank.trailing[j])) {
      moved.mean = moved.f * mixed.mean;
    } else {
      moved = move(*bank.trailing[j], bank.interval_s, mixed.mean);
    }
    next.mean = moved.mean;
    next.covariance = moved.f * mixed.covariance * moved.f.transpose() + moved.q;
  } else {
    const Gaussian kinematic = kinematic_part(mixed);
    next.mean.head<kStateSize>() = bank.f[j] * kinematic.mean;
    next.covariance.topLeftCorner<kStateSize, kStateSize>() =
        bank.f[j] * kinematic.covariance * bank.f[j].transpose() + bank.q[j];
  }
  next.covariance = (0.5 * (next.covariance + next.covariance.transpose())).eval();
  return next;
}

}  // namespace

Numerics predict_unlike(const DiscreteBank& bank, const Eigen::MatrixXd& transition, const ImmEstimate& estimate,
                        ImmEstimate& predicted) {
  const auto count = estimate.modes.size();
  predicted.trailing.resize(count);
  std::vector<FullGaussian> full(count);
  for (std::size_t i = 0; i < count; ++i) full[i] = full_state(bank, estimate, i);
  std::vector<FullGaussian> parts(count);
  for (std::size_t j = 0; j < count; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const Eigen::VectorXd reached = estimate.probability.cwiseProduct(transition.col(column));
    const double c = reached.sum();
    for (std::size_t i = 0; i < count; ++i) {
      parts[i] = kind_of(bank, i) == kind_of(bank, j) ? full[i] : with_trailing_of(full[i], full[j]);
    }
    const FullGaussian next = moved_on(bank, j, c > 0.0 ? moment_match(parts, reached / c) : full[j]);
    if (!next.mean.allFinite() || !next.covariance.allFinite() || !std::isfinite(c)) return Numerics::kNotFinite;
    predicted.modes[j] = kinematic_part(next);
    predicted.probability[column] = c;
    if (!bank.trailing[j]) continue;
    if (const Numerics split = trailing_part(next, predicted.trailing[j]); split != Numerics::kOk) return split;
  }
  return Numerics::kOk;
}

}  // namespace dwell
