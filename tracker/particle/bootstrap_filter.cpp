#include "tracker/particle/bootstrap_filter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "radar/assert.hpp"
#include "radar/jump_markov_trajectory.hpp"
#include "tracker/particle/weights.hpp"

namespace dwell {
namespace {

State normal_state(RandomStream& stream) {
  State draw;
  for (double& value : draw) value = stream.normal();
  return draw;
}

}  // namespace

BootstrapFilter::BootstrapFilter(DiscreteBank bank, const Gaussian& start, const Eigen::VectorXd& probability,
                                 int particles, RandomStream stream)
    : bank_(std::move(bank)), stream_(stream) {
  DWELL_ASSERT(particles >= 1 && bank_.guards.empty() && bank_.trailing.empty());
  for (const StateMatrix& q : bank_.q) noise_root_.push_back(noise_root(q));
  const StateMatrix root = noise_root(start.covariance);
  for (int i = 0; i < particles; ++i) {
    const State x = start.mean + root * normal_state(stream_);
    particles_.push_back({x, draw_index(probability.transpose(), stream_)});
  }
  weight_.assign(particles_.size(), 1.0 / particles);
  log_weight_.resize(particles_.size());
}

void BootstrapFilter::predict() {
  double squares = 0.0;
  for (const double weight : weight_) squares += weight * weight;
  if (1.0 / squares < 0.5 * static_cast<double>(particles_.size())) resample();
  for (Particle& particle : particles_) {
    particle.mode = draw_index(bank_.transition.row(particle.mode), stream_);
    const auto mode = static_cast<std::size_t>(particle.mode);
    particle.x = bank_.f[mode] * particle.x + noise_root_[mode] * normal_state(stream_);
  }
}

Numerics BootstrapFilter::update(const Sensor& sensor, const Vector2& z) {
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    PredictedMeasurement exact;  // of a state that is known: S = R
    exact.r = sensor.noise(particles_[i].x);
    if (const Numerics factor = factorise(StateMatrix::Zero(), exact); factor != Numerics::kOk) return factor;
    const Vector2 nu = sensor.residual(z, sensor.measure(particles_[i].x));
    log_weight_[i] = std::log(weight_[i]) + exact.log_likelihood(nu);
  }
  return normalise(log_weight_, weight_);
}

Numerics BootstrapFilter::weigh(std::span<const double> of_mode) {
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    log_weight_[i] = std::log(weight_[i] * of_mode[static_cast<std::size_t>(particles_[i].mode)]);
  }
  return normalise(log_weight_, weight_);
}

void BootstrapFilter::resample() {
  resample_systematically(weight_, particles_.size(), stream_, survivors_);
  kept_.clear();
  for (const std::size_t i : survivors_.index) kept_.push_back(particles_[i]);
  std::swap(particles_, kept_);
  weight_ = survivors_.weight;
}

ImmEstimate BootstrapFilter::estimate() const {
  std::vector<WeightedGaussian> points;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    points.push_back({particles_[i].mode, weight_[i], {particles_[i].x, StateMatrix::Zero()}});
  }
  return moments_by_mode(points, bank_.size());
}

}  // namespace dwell
