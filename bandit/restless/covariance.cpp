#include "bandit/restless/covariance.hpp"

#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace dwell::restless {
namespace {

void symmetrise(Matrix& m) {
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) m(i, j) = m(j, i) = 0.5 * (m(i, j) + m(j, i));
  }
}

}  // namespace

LookUpdate look_update(const Sensor& sensor, const Matrix& predicted) {
  const Matrix hp = sensor.h * predicted;
  const Matrix s = hp * sensor.h.transpose() + sensor.r;
  const Matrix k = s.llt().solve(hp).transpose();
  LookUpdate update;
  update.a = Matrix::Identity(predicted.rows(), predicted.cols()) - k * sensor.h;
  update.noise = k * sensor.r * k.transpose();
  update.covariance = update.a * predicted * update.a.transpose() + update.noise;
  symmetrise(update.covariance);
  return update;
}

Matrix predict(const Arm& arm, const Matrix& covariance) {
  Matrix predicted = arm.f * covariance * arm.f.transpose() + arm.q;
  symmetrise(predicted);
  return predicted;
}

double scan_cost(const Arm& arm, const Matrix& covariance) {
  return arm.weight * arm.cost.cwiseProduct(covariance).sum();
}

double expected_scan_cost(const Arm& arm, const Sensor& sensor, const Matrix& predicted) {
  return sensor.p_detect * scan_cost(arm, look_update(sensor, predicted).covariance) +
         (1.0 - sensor.p_detect) * scan_cost(arm, predicted);
}

AllLooks all_looks(const Arm& arm) {
  Matrix p = arm.p0 + arm.q;
  Matrix loop;
  for (int step = 0; step < 100'000; ++step) {
    Matrix m = p;
    loop = arm.f;
    for (const Sensor& sensor : arm.sensors) {
      const LookUpdate look = look_update(sensor, m);
      m = look.covariance;
      loop = loop * look.a;
    }
    const Matrix next = predict(arm, m);
    const double change = (next - p).cwiseAbs().maxCoeff();
    p = next;
    if (!(change > 1e-14 * p.cwiseAbs().maxCoeff())) break;
  }
  const double radius = spectral_radius(loop);
  return {p, radius * radius};
}

double spectral_radius(const Matrix& m) {
  return m.allFinite() ? Eigen::EigenSolver<Matrix>(m, false).eigenvalues().cwiseAbs().maxCoeff()
                       : std::numeric_limits<double>::infinity();
}

}  // namespace dwell::restless
