#pragma once

#include <variant>

#include "tracker/particle/bootstrap_filter.hpp"
#include "tracker/particle/marginal_filter.hpp"

namespace dwell {

enum class ParticleKind { kMarginal, kBootstrap };

struct ParticleSettings {
  ParticleKind kind = ParticleKind::kMarginal;
  /// 30: of mode histories more do not lower the error (tests/scenarios/particles_test.cpp); of states thousands do.
  int count = 30;
};

/// The catalogue of particle filters. What the rest of the tracker and the policies read of one is its `estimate`: the
/// moment-matched Gaussian and the weight of each mode.
using ParticleFilter = std::variant<MarginalFilter, BootstrapFilter>;

inline ParticleFilter make_particles(const ParticleSettings& settings, const DiscreteBank& bank, const Gaussian& start,
                                     const Eigen::VectorXd& probability, const RandomStream& stream) {
  if (settings.kind == ParticleKind::kBootstrap) {
    return BootstrapFilter(bank, start, probability, settings.count, stream);
  }
  return MarginalFilter(bank, start, probability, settings.count, stream);
}

}  // namespace dwell
