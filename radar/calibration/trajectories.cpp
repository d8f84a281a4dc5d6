#include "radar/calibration/trajectories.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "radar/calibration/innovations.hpp"

namespace dwell::calibration {
namespace {

using Eigen::VectorXd;

/// Added to every process noise, 1 cm and 1 cm/s: what moves without noise keeps an inverse.
constexpr double kLeastProcessNoise = 1e-4;

using Across = Eigen::Matrix<double, kStateSize, 2 * kStateSize>;

/// x' - F x as a matrix of [x; x'].
Across across(const StateMatrix& f) {
  Across m;
  m << -f, StateMatrix::Identity();
  return m;
}

Eigen::LLT<StateMatrix> root_of(const StateMatrix& q) {
  return Eigen::LLT<StateMatrix>(StateMatrix(q + kLeastProcessNoise * StateMatrix::Identity()));
}

void begin_with_average(const VectorXd& probability, Gap& gap) {
  StateMatrix f = StateMatrix::Zero();
  StateMatrix q = StateMatrix::Zero();
  for (std::size_t j = 0; j < gap.step->f.size(); ++j) {
    f += probability[static_cast<Eigen::Index>(j)] * gap.step->f[j];
    q += probability[static_cast<Eigen::Index>(j)] * gap.step->q[j];
  }
  const Across m = across(f);
  gap.information = m.transpose() * root_of(q).solve(m);
}

/// A gap's states about their present mean: without the gap's factor, and under each mode.
struct Tilted {
  PairVector mean;
  PairMatrix cavity;  // information
  PairVector cavity_pull;
  std::vector<PairVector> mode_mean;
  std::vector<PairMatrix> mode_covariance;
  VectorXd likelihood;  // of the modes, largest 1
  bool good = false;    // else the gap stays as it is
};

double log_determinant(const auto& root) { return 2.0 * root.matrixLLT().diagonal().array().log().sum(); }

Tilted tilt(const Gap& gap, const Trajectories& trajectories, const TrajectoryChain& chain) {
  Tilted out;
  out.mean << trajectories.x[gap.from], trajectories.x[gap.from + 1];
  const StateMatrix next = chain.next_covariance(gap.from);
  PairMatrix covariance;
  covariance << chain.state_covariance(gap.from), next, next.transpose(), chain.state_covariance(gap.from + 1);
  out.cavity = Eigen::LLT<PairMatrix>(covariance).solve(PairMatrix::Identity()) - gap.information;
  out.cavity_pull = gap.information * out.mean - gap.pull;
  const auto modes = static_cast<Eigen::Index>(gap.step->f.size());
  out.likelihood = VectorXd::Ones(modes);
  VectorXd log_evidence(modes);
  for (Eigen::Index j = 0; j < modes; ++j) {
    const Across m = across(gap.step->f[j]);
    const Eigen::LLT<StateMatrix> q = root_of(gap.step->q[j]);
    const State r = m * out.mean;
    const Across weighted = q.solve(m);
    const Eigen::LLT<PairMatrix> information(PairMatrix(out.cavity + m.transpose() * weighted));
    const PairVector pull = out.cavity_pull - weighted.transpose() * r;
    out.mode_mean.push_back(information.solve(pull));
    out.mode_covariance.push_back(information.solve(PairMatrix::Identity()));
    log_evidence[j] =
        0.5 * (pull.dot(out.mode_mean.back()) - r.dot(q.solve(r)) - log_determinant(q) - log_determinant(information));
    if (information.info() != Eigen::Success || !std::isfinite(log_evidence[j])) return out;
  }
  out.likelihood = (log_evidence.array() - log_evidence.maxCoeff()).exp();
  out.good = true;
  return out;
}

/// The factor that makes of the cavity the mixture's mean and covariance.
void match(const Tilted& at, const VectorXd& probability, double step, Gap& gap) {
  PairVector mean = PairVector::Zero();
  for (std::size_t j = 0; j < at.mode_mean.size(); ++j) {
    mean += probability[static_cast<Eigen::Index>(j)] * at.mode_mean[j];
  }
  PairMatrix covariance = PairMatrix::Zero();
  for (std::size_t j = 0; j < at.mode_mean.size(); ++j) {
    const PairVector spread = at.mode_mean[j] - mean;
    covariance += probability[static_cast<Eigen::Index>(j)] * (at.mode_covariance[j] + spread * spread.transpose());
  }
  const Eigen::LLT<PairMatrix> root(covariance);
  const PairMatrix wanted = root.solve(PairMatrix::Identity()) - at.cavity;
  const Eigen::SelfAdjointEigenSolver<PairMatrix> solver(PairMatrix(0.5 * (wanted + wanted.transpose())));
  if (root.info() != Eigen::Success || solver.info() != Eigen::Success) return;
  const PairVector values = solver.eigenvalues().cwiseMax(0.0);
  const PairMatrix& axes = solver.eigenvectors();
  const PairVector kept = (values.array() > 0.0).cast<double>();
  const PairMatrix information = axes * values.asDiagonal() * axes.transpose();
  const PairVector pull = axes * kept.asDiagonal() * axes.transpose() * (root.solve(mean) - at.cavity_pull);
  gap.information += step * (information - gap.information);
  gap.pull += step * (pull + information * at.mean - gap.pull);
}

}  // namespace

Trajectories lay_out(const CalibrationWindow& window, const MotionPrior& motion) {
  Trajectories all;
  for (std::size_t i = 0; i < window.plots.size(); ++i) {
    const CalibrationPlot& plot = window.plots[i];
    all.state_of_plot.push_back(plot.truth ? -1 : static_cast<int>(all.x.size()));
    if (plot.truth) continue;
    const CalibrationPlot* before = i > 0 && !window.plots[i - 1].truth ? &window.plots[i - 1] : nullptr;
    const bool follows =
        before != nullptr && before->track == plot.track && plot.scan - before->scan < motion.steps.size();
    if (follows) {
      const std::size_t from = all.x.size() - 1;
      const bool first = all.heads.back() == from;
      all.gaps.push_back({from, &motion.steps[plot.scan - before->scan], first});
      begin_with_average(motion.initial_probability, all.gaps.back());
    } else {
      all.heads.push_back(all.x.size());
      all.head_mean.push_back(plot.predicted);
    }
    all.x.push_back(plot.predicted);
  }
  return all;
}

State start_sigma() { return make_state({kStartSigma_m, kStartSigma_m}, {kStartSpeedSigma_mps, kStartSpeedSigma_mps}); }

void add_motion(const Trajectories& trajectories, TrajectoryChain& chain) {
  const StateMatrix start = start_sigma().cwiseAbs2().cwiseInverse().asDiagonal();
  for (const std::size_t head : trajectories.heads) chain.own[head] += start;
  for (const Gap& gap : trajectories.gaps) {
    chain.own[gap.from] += gap.information.topLeftCorner<kStateSize, kStateSize>();
    chain.next[gap.from] += gap.information.topRightCorner<kStateSize, kStateSize>();
    chain.own[gap.from + 1] += gap.information.bottomRightCorner<kStateSize, kStateSize>();
  }
}

void update_motion(const MotionPrior& motion, const TrajectoryChain& chain, double step, Trajectories& trajectories) {
  std::vector<Gap>& gaps = trajectories.gaps;
  std::vector<Tilted> tilted;
  std::vector<VectorXd> forward;
  for (std::size_t n = 0; n < gaps.size(); ++n) {
    tilted.push_back(tilt(gaps[n], trajectories, chain));
    const VectorXd& before = gaps[n].first ? motion.initial_probability : forward.back();
    const VectorXd p = tilted[n].likelihood.cwiseProduct(gaps[n].step->transition.transpose() * before);
    forward.push_back(p / p.sum());
  }
  VectorXd backward;
  for (std::size_t n = gaps.size(); n-- > 0;) {
    const bool last = n + 1 == gaps.size() || gaps[n + 1].first;
    backward = last ? VectorXd(VectorXd::Ones(forward[n].size()))
                    : VectorXd(gaps[n + 1].step->transition * tilted[n + 1].likelihood.cwiseProduct(backward));
    backward /= backward.sum();
    const VectorXd p = forward[n].cwiseProduct(backward);
    if (tilted[n].good) match(tilted[n], p / p.sum(), step, gaps[n]);
  }
}

}  // namespace dwell::calibration
