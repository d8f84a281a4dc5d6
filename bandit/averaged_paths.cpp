#include "bandit/averaged_paths.hpp"

#include <algorithm>

#include "bandit/expected_cost.hpp"

namespace dwell {

double AveragedPaths::bound(const PredictedPaths& paths, std::span<const Pair> pairs, std::span<const double> q,
                            std::span<double> gradient) {
  double sum = 0.0;
  for (std::size_t first = 0; first < pairs.size();) {
    std::size_t last = first;
    while (last < pairs.size() && pairs[last].track == pairs[first].track) ++last;
    const auto of_track = pairs.subspan(first, last - first);
    const auto q_of_track = q.subspan(first, last - first);
    sum += forward(paths, of_track, q_of_track);
    backward(paths, of_track, q_of_track, gradient.subspan(first, last - first));
    first = last;
  }
  return sum;
}

/// Of one track; keeps what the way back needs.
double AveragedPaths::forward(const PredictedPaths& paths, std::span<const Pair> pairs, std::span<const double> q) {
  const std::size_t modes = paths.modes();
  const auto scans = static_cast<std::size_t>(paths.scans());
  const std::size_t track = pairs.front().track;
  before_.resize(scans * modes);
  after_.resize(modes);
  seen_.resize(scans * pairs.size() * modes);
  rest_.resize(seen_.size());
  std::copy_n(paths.covariances(paths.start(track)), modes, after_.data());
  double sum = 0.0;
  for (std::size_t k = 0; k < scans; ++k) {
    const int scan = static_cast<int>(k);
    StateMatrix* before = &before_[k * modes];
    paths.predict(track, scan, 1.0, after_.data(), before);
    double chosen = 0.0;
    for (const double share : q) chosen += share;
    for (std::size_t j = 0; j < modes; ++j) after_[j] = (1.0 - chosen) * before[j];
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      StateMatrix* seen = &seen_[(k * pairs.size() + i) * modes];
      std::copy_n(before, modes, seen);
      paths.look(track, scan, pairs[i].sensor, 1.0, seen, &rest_[(k * pairs.size() + i) * modes]);
      for (std::size_t j = 0; j < modes; ++j) after_[j] += q[i] * seen[j];
    }
    sum += paths.cost(track, scan, after_.data());
  }
  return sum;
}

void AveragedPaths::backward(const PredictedPaths& paths, std::span<const Pair> pairs, std::span<const double> q,
                             std::span<double> gradient) {
  const std::size_t modes = paths.modes();
  const std::size_t track = pairs.front().track;
  std::fill(gradient.begin(), gradient.end(), 0.0);
  adjoint_.assign(modes, StateMatrix::Zero());
  carried_.resize(modes);
  double chosen = 0.0;
  for (const double share : q) chosen += share;
  for (auto k = static_cast<std::size_t>(paths.scans()); k-- > 0;) {
    const int scan = static_cast<int>(k);
    for (std::size_t j = 0; j < modes; ++j) {
      adjoint_[j] += paths.weight(track) * paths.probability(track, scan, j) * position_weight();
      carried_[j] = (1.0 - chosen) * adjoint_[j];
    }
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double p = paths.detection(track, scan, pairs[i].sensor);
      for (std::size_t j = 0; j < modes; ++j) {
        const std::size_t place = (k * pairs.size() + i) * modes + j;
        gradient[i] += adjoint_[j].cwiseProduct(seen_[place] - before_[k * modes + j]).sum();
        const StateMatrix through = rest_[place].transpose() * adjoint_[j] * rest_[place];
        carried_[j] += q[i] * (p * through + (1.0 - p) * adjoint_[j]);
      }
    }
    if (k == 0) return;
    std::fill(adjoint_.begin(), adjoint_.end(), StateMatrix::Zero());
    for (std::size_t j = 0; j < modes; ++j) {
      const StateMatrix moved = paths.transition(j).transpose() * carried_[j] * paths.transition(j);
      for (std::size_t i = 0; i < modes; ++i) adjoint_[i] += paths.mixing(track, scan, i, j) * moved;
    }
  }
}

}  // namespace dwell
