#include "radar/calibration/trajectory_chain.hpp"

#include <Eigen/Cholesky>

namespace dwell::calibration {

TrajectoryChain::TrajectoryChain(std::size_t states, Eigen::Index biases)
    : own(states, StateMatrix::Zero()),
      next(states, StateMatrix::Zero()),
      coupling(states, BiasMatrix::Zero(kStateSize, biases)),
      bias(Eigen::MatrixXd::Zero(biases, biases)) {}

/// Block elimination forward, P_i+1 = A_i+1,i+1 - A_i,i+1' P_i^-1 A_i,i+1, and substitution back.
bool TrajectoryChain::factor() {
  const std::size_t states = own.size();
  std::vector<Eigen::LLT<StateMatrix>> pivots(states);
  gain_ = coupling;
  inverse_.resize(states);
  inverse_next_.resize(states);
  for (std::size_t i = 0; i < states; ++i) {
    StateMatrix pivot = own[i];
    if (i > 0) {
      const StateMatrix across = pivots[i - 1].solve(next[i - 1]);
      pivot -= next[i - 1].transpose() * across;
      gain_[i] -= across.transpose() * gain_[i - 1];
    }
    pivots[i].compute(0.5 * (pivot + pivot.transpose()));
    if (pivots[i].info() != Eigen::Success) return false;
  }
  for (std::size_t i = states; i-- > 0;) {
    const StateMatrix alone = pivots[i].solve(StateMatrix::Identity());
    inverse_[i] = alone;
    if (i + 1 < states) {
      const StateMatrix across = pivots[i].solve(next[i]);
      inverse_next_[i] = -across * inverse_[i + 1];
      inverse_[i] -= inverse_next_[i] * across.transpose();
      gain_[i] -= next[i] * gain_[i + 1];
    }
    gain_[i] = pivots[i].solve(gain_[i]).eval();
  }
  Eigen::MatrixXd complement = bias;
  for (std::size_t i = 0; i < states; ++i) complement -= coupling[i].transpose() * gain_[i];
  const Eigen::LLT<Eigen::MatrixXd> root(Eigen::MatrixXd(0.5 * (complement + complement.transpose())));
  if (!complement.allFinite() || root.info() != Eigen::Success) return false;
  bias_covariance_ = root.solve(Eigen::MatrixXd::Identity(bias.rows(), bias.cols()));
  return true;
}

StateMatrix TrajectoryChain::state_covariance(std::size_t i) const {
  return inverse_[i] + gain_[i] * bias_covariance_ * gain_[i].transpose();
}

StateMatrix TrajectoryChain::next_covariance(std::size_t i) const {
  return inverse_next_[i] + gain_[i] * bias_covariance_ * gain_[i + 1].transpose();
}

}  // namespace dwell::calibration
