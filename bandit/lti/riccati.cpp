#include "bandit/lti/riccati.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace dwell::lti {
namespace {

/// The triangular factor of tall `h`, or `h` itself where it is wide: the same h'h.
Matrix compressed(const Eigen::MatrixXd& h) {
  if (h.rows() <= h.cols()) return h;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(h);
  return qr.matrixQR().topRows(h.cols()).triangularView<Eigen::Upper>();
}

Matrix symmetric_part(const Eigen::MatrixXd& m) { return 0.5 * (m + m.transpose()); }

}  // namespace

Matrix information_root(const Eigen::MatrixXd& c, const Eigen::MatrixXd& r) {
  const Eigen::LLT<Eigen::MatrixXd> noise_root(0.5 * (r + r.transpose()));
  return compressed(noise_root.matrixL().solve(c));
}

Matrix joint_root(std::span<const Matrix> roots, std::span<const double> weights) {
  Eigen::Index rows = 0;
  for (const Matrix& root : roots) rows += root.rows();
  Eigen::MatrixXd stacked(rows, roots.front().cols());
  rows = 0;
  for (std::size_t j = 0; j < roots.size(); ++j) {
    stacked.middleRows(rows, roots[j].rows()) = std::sqrt(weights[j]) * roots[j];
    rows += roots[j].rows();
  }
  return compressed(stacked);
}

Matrix riccati_step(const Matrix& a, const Matrix& w, const Matrix& root, CovarianceKind kind, const Matrix& p,
                    Sensitivity* sensitivity) {
  const Eigen::Index n = p.rows();
  const bool predict_first = kind == CovarianceKind::kFiltered;
  Matrix m = p;  // the covariance that the look meets
  if (predict_first) {
    const Matrix ap = a * p;
    m.noalias() = ap * a.transpose();
    m += w;
  }
  const Matrix hm = root * m;
  Matrix s = hm * root.transpose();
  s.diagonal().array() += 1.0;
  Matrix k = Eigen::LLT<Matrix>(s).solve(hm).transpose();
  Matrix f = Matrix::Identity(n, n);
  if (!predict_first) {
    k = (a * k).eval();
    f = a;
  }
  f.noalias() -= k * root;
  const Matrix fm = f * m;
  Matrix next = fm * f.transpose();
  next.noalias() += k * k.transpose();
  if (!predict_first) next += w;
  next = (0.5 * (next + next.transpose())).eval();
  if (sensitivity != nullptr) *sensitivity = predict_first ? Sensitivity{f * a, next} : Sensitivity{f, fm};
  return next;
}

Riccati::Riccati(const Problem& problem, double scale)
    : kind_(problem.covariance),
      sensors_(problem.sensor_count()),
      blocks_(problem.communication_noise > 0.0 ? sensors_ : 1),
      a_(problem.a),
      w_(scale * symmetric_part(problem.w)),
      initial_(symmetric_part(problem.initial)),
      none_(0, problem.states()) {
  const std::vector<double> once(problem.sensors.size(), 1.0);
  for (int block = 0; block < blocks_; ++block) {
    for (int j = 0; j < sensors_; ++j) {
      const Sensor& sensor = problem.sensors[static_cast<std::size_t>(j)];
      Eigen::MatrixXd noise = sensor.r;
      if (j != block && blocks_ > 1) noise.diagonal().array() += problem.communication_noise;
      roots_.push_back(information_root(sensor.c, noise) / std::sqrt(scale));
    }
    all_.push_back(joint_root(std::span(roots_).last(once.size()), once));
  }
}

std::vector<double> Riccati::initial() const {
  std::vector<double> covariance;
  for (int block = 0; block < blocks_; ++block) {
    covariance.insert(covariance.end(), initial_.data(), initial_.data() + initial_.size());
  }
  return covariance;
}

const Matrix& Riccati::root(int block, int choice) const {
  return choice == 0 ? none_ : roots_[static_cast<std::size_t>(block * sensors_ + choice - 1)];
}

void Riccati::step(const double* from, int choice, double* to) {
  for (int block = 0; block < blocks_; ++block) {
    const std::size_t offset = static_cast<std::size_t>(block) * block_size();
    step_block(from + offset, root(block, choice), to + offset);
  }
}

void Riccati::step_with_all(const double* from, double* to) {
  for (int block = 0; block < blocks_; ++block) {
    const std::size_t offset = static_cast<std::size_t>(block) * block_size();
    step_block(from + offset, all_[static_cast<std::size_t>(block)], to + offset);
  }
}

Matrix Riccati::step(const Matrix& p, const Matrix& root, Sensitivity* sensitivity) {
  ++steps_;
  return riccati_step(a_, w_, root, kind_, p, sensitivity);
}

void Riccati::step_block(const double* from, const Matrix& root, double* to) {
  const Matrix p = Eigen::Map<const Eigen::MatrixXd>(from, states(), states());
  Eigen::Map<Eigen::MatrixXd>(to, states(), states()) = step(p, root);
}

double Riccati::trace(const double* covariance) const {
  double sum = 0.0;
  for (int block = 0; block < blocks_; ++block) {
    const double* p = covariance + static_cast<std::size_t>(block) * block_size();
    for (int i = 0; i < states(); ++i) sum += p[i * (states() + 1)];
  }
  return sum;
}

}  // namespace dwell::lti
