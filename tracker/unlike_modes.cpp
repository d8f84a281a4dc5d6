#include "tracker/unlike_modes.hpp"

#include <cmath>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace dwell {
namespace {

TrailingKind kind_of(const DiscreteBank& bank, std::size_t mode) {
  return bank.trailing[mode] ? trailing_kind(*bank.trailing[mode]) : TrailingKind::kNone;
}

/// Of a Gaussian over all states: A with A A' its covariance. What a mode does not have is zero.
constexpr int kColumns = kMostStates + kStateSize;
using Root = Eigen::Matrix<double, kMostStates, kColumns>;
struct Rooted {
  FullState mean = FullState::Zero();
  Root root = Root::Zero();
};

/// [L 0; G L  B], L L' = P.
Numerics rooted(const Gaussian& kinematic, const Trailing& trailing, Rooted& out) {
  const Eigen::LLT<StateMatrix> factor(kinematic.covariance);
  if (factor.info() != Eigen::Success) return Numerics::kNotPositiveDefinite;
  out.mean << kinematic.mean, trailing.a + trailing.g * kinematic.mean;
  out.root.topLeftCorner<kStateSize, kStateSize>() = factor.matrixL();
  out.root.bottomLeftCorner<2, kStateSize>() = trailing.g * out.root.topLeftCorner<kStateSize, kStateSize>();
  out.root.block<2, 2>(kStateSize, kStateSize) = trailing.b;
  return Numerics::kOk;
}

Trailing trailing_of(const DiscreteBank& bank, const ImmEstimate& estimate, std::size_t mode) {
  if (!bank.trailing[mode]) return {};
  if (!estimate.trailing.empty()) return estimate.trailing[mode];
  return {.b = start_sigma(*bank.trailing[mode]).asDiagonal()};
}

/// The kinematic states of one, and the trailing states of the other.
Rooted with_trailing_of(const Rooted& one, const Rooted& other) {
  Rooted made;
  made.mean << one.mean.head<kStateSize>(), other.mean.tail<2>();
  made.root.topLeftCorner<kStateSize, kStateSize>() = one.root.topLeftCorner<kStateSize, kStateSize>();
  made.root.bottomRightCorner<2, kMostStates>() = other.root.bottomLeftCorner<2, kMostStates>();
  return made;
}

/// A with A A' = Q, of a positive semidefinite Q whatever its units.
FullMatrix root_of(const FullMatrix& q) {
  const FullState sigma = q.diagonal().cwiseSqrt();
  const FullState unit = sigma.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  const Eigen::LDLT<FullMatrix> factor(FullMatrix(unit.asDiagonal() * q * unit.asDiagonal()));
  const FullMatrix root = FullMatrix(factor.matrixL()) * factor.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return sigma.asDiagonal() * FullMatrix(factor.transpositionsP().transpose() * root);
}

/// Mode j over one interval from a mean.
Moved moved_by(const DiscreteBank& bank, std::size_t j, const FullState& mean) {
  Moved moved;
  if (!bank.trailing[j]) {
    moved.f.setZero();
    moved.f.topLeftCorner<kStateSize, kStateSize>() = bank.f[j];
    moved.q.topLeftCorner<kStateSize, kStateSize>() = bank.q[j];
  } else if (is_linear(*bank.trailing[j])) {
    moved = bank.from_rest[j];
  } else {
    return move(*bank.trailing[j], bank.interval_s, mean);
  }
  moved.mean = moved.f * mean;
  return moved;
}

/// The lower triangular L of L L' = sum_i weight_i F (P_i + d_i d_i') F' + Q, d_i from the mixed mean: of the columns
/// of all the roots, by QR. Nothing is subtracted.
FullMatrix moved_root(std::span<const Rooted> parts, const Eigen::VectorXd& weight, const FullState& mean,
                      const Moved& moved) {
  constexpr int kEach = kColumns + 1;
  const auto rows = static_cast<Eigen::Index>(parts.size()) * kEach + kMostStates;
  Eigen::Matrix<double, Eigen::Dynamic, kMostStates> stacked(rows, kMostStates);
  stacked.bottomRows<kMostStates>() = root_of(moved.q).transpose();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    Eigen::Matrix<double, kMostStates, kEach> columns;
    columns << parts[i].root, parts[i].mean - mean;
    stacked.middleRows<kEach>(index * kEach) = std::sqrt(weight[index]) * (moved.f * columns).transpose();
  }
  const Eigen::HouseholderQR<Eigen::Matrix<double, Eigen::Dynamic, kMostStates>> factor(stacked);
  return FullMatrix(factor.matrixQR().topRows<kMostStates>().triangularView<Eigen::Upper>()).transpose();
}

}  // namespace

Numerics predict_unlike(const DiscreteBank& bank, const Eigen::MatrixXd& transition, const ImmEstimate& estimate,
                        ImmEstimate& predicted) {
  const auto count = estimate.modes.size();
  predicted.trailing.resize(count);
  std::vector<Rooted> full(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Numerics made = rooted(estimate.modes[i], trailing_of(bank, estimate, i), full[i]);
    if (made != Numerics::kOk) return made;
  }
  std::vector<Rooted> parts(count);
  for (std::size_t j = 0; j < count; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    Eigen::VectorXd weight = estimate.probability.cwiseProduct(transition.col(column));
    const double c = weight.sum();
    if (c > 0.0) {
      weight /= c;
    } else {
      weight = Eigen::VectorXd::Unit(estimate.size(), column);
    }
    FullState mean = FullState::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      parts[i] = kind_of(bank, i) == kind_of(bank, j) ? full[i] : with_trailing_of(full[i], full[j]);
      mean += weight[static_cast<Eigen::Index>(i)] * parts[i].mean;
    }
    const Moved moved = moved_by(bank, j, mean);
    const FullMatrix root = moved_root(parts, weight, mean, moved);
    if (!moved.mean.allFinite() || !root.allFinite() || !std::isfinite(c)) return Numerics::kNotFinite;
    const StateMatrix kinematic = root.topLeftCorner<kStateSize, kStateSize>();
    predicted.modes[j].mean = moved.mean.head<kStateSize>();
    predicted.modes[j].covariance = symmetric_part(kinematic * kinematic.transpose());
    predicted.probability[column] = c;
    if (!bank.trailing[j]) continue;
    if (!(kinematic.diagonal().cwiseAbs().minCoeff() > 0.0)) return Numerics::kNotPositiveDefinite;
    Trailing& trailing = predicted.trailing[j];  // G = L_ex L^-1
    const Eigen::Matrix<double, kStateSize, 2> cross = root.bottomLeftCorner<2, kStateSize>().transpose();
    trailing.g = kinematic.transpose().triangularView<Eigen::Upper>().solve(cross).transpose();
    trailing.a = moved.mean.tail<2>() - trailing.g * predicted.modes[j].mean;
    trailing.b = root.bottomRightCorner<2, 2>();
  }
  return Numerics::kOk;
}

}  // namespace dwell
