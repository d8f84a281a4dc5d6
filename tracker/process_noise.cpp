#include "tracker/process_noise.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

#include "radar/assert.hpp"
#include "tracker/gaussian.hpp"

namespace dwell {
namespace {

StateMatrix sum_of_steps(const Motion& motion, const StateMatrix& each, double step_s, double dt_s) {
  const auto steps = std::lround(dt_s / step_s);
  DWELL_ASSERT(std::abs(dt_s / step_s - static_cast<double>(steps)) < 1e-9);
  const StateMatrix f = transition(motion, step_s);
  StateMatrix sum = StateMatrix::Zero();
  for (long i = 0; i < steps; ++i) sum = symmetric_part(f * sum * f.transpose() + each);
  return sum;
}

struct Accumulate {
  const Motion& motion;
  double dt_s;

  StateMatrix operator()(const NoProcessNoise& /*noise*/) const { return StateMatrix::Zero(); }
  StateMatrix operator()(const WhiteNoiseAcceleration& noise) const { return white_noise(motion, noise.q, dt_s); }
  StateMatrix operator()(const PiecewiseAcceleration& noise) const {
    const double t = noise.step_s;
    const State gx = make_state({0.5 * t * t, 0.0}, {t, 0.0});
    const State gy = make_state({0.0, 0.5 * t * t}, {0.0, t});
    const double variance = noise.sigma_mps2 * noise.sigma_mps2;
    return sum_of_steps(motion, variance * (gx * gx.transpose() + gy * gy.transpose()), t, dt_s);
  }
  StateMatrix operator()(const DiagonalNoise& noise) const {
    return sum_of_steps(motion, noise.b.cwiseAbs2().asDiagonal(), noise.step_s, dt_s);
  }
};

double step_of(const NoProcessNoise& /*noise*/) { return 0.0; }
double step_of(const WhiteNoiseAcceleration& /*noise*/) { return 0.0; }
double step_of(const PiecewiseAcceleration& noise) { return noise.step_s; }
double step_of(const DiagonalNoise& noise) { return noise.step_s; }

}  // namespace

StateMatrix process_noise(const Motion& motion, const ProcessNoise& noise, double dt_s) {
  return std::visit(Accumulate{motion, dt_s}, noise);
}

StateMatrix noise_root(const StateMatrix& q) {
  const Eigen::SelfAdjointEigenSolver<StateMatrix> solver(q);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

bool divides(const ProcessNoise& noise, double dt_s) {
  const double step_s = std::visit([](const auto& form) { return step_of(form); }, noise);
  return step_s == 0.0 || std::abs(dt_s / step_s - std::round(dt_s / step_s)) < 1e-9;
}

}  // namespace dwell
