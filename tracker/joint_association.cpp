#include "tracker/joint_association.hpp"

#include "radar/assert.hpp"

namespace dwell {

void JointAssociation::reserve(std::size_t plots) {
  before_.reserve((plots + 1) << kMostRivals);
  after_.reserve((plots + 1) << kMostRivals);
}

void JointAssociation::solve(std::span<const double> ratio, std::size_t rivals, std::span<double> factor) {
  DWELL_ASSERT(rivals <= kMostRivals && ratio.size() == rivals * factor.size());
  const std::size_t plots = factor.size();
  const std::size_t sets = std::size_t{1} << rivals;
  before_.assign((plots + 1) * sets, 0.0);
  after_.assign((plots + 1) * sets, 0.0);
  before_[0] = 1.0;
  for (std::size_t i = 0; i < plots; ++i) {
    const double* from = &before_[i * sets];
    double* to = &before_[(i + 1) * sets];
    for (std::size_t set = 0; set < sets; ++set) {
      to[set] += from[set];
      for (std::size_t s = 0; s < rivals; ++s) {
        const std::size_t taken = set | (std::size_t{1} << s);
        if (taken != set) to[taken] += from[set] * ratio[s * plots + i];
      }
    }
  }
  for (std::size_t set = 0; set < sets; ++set) after_[plots * sets + set] = 1.0;
  for (std::size_t i = plots; i-- > 0;) {
    const double* from = &after_[(i + 1) * sets];
    double* to = &after_[i * sets];
    for (std::size_t set = 0; set < sets; ++set) {
      to[set] = from[set];
      for (std::size_t s = 0; s < rivals; ++s) {
        const std::size_t taken = set | (std::size_t{1} << s);
        if (taken != set) to[set] += from[taken] * ratio[s * plots + i];
      }
    }
  }
  const double all = after_[0];
  for (std::size_t i = 0; i < plots; ++i) {
    double free = 0.0;
    for (std::size_t set = 0; set < sets; ++set) free += before_[i * sets + set] * after_[(i + 1) * sets + set];
    factor[i] = free / all;
  }
}

}  // namespace dwell
