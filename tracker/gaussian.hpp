#pragma once

#include "radar/state.hpp"

namespace dwell {

struct Gaussian {
  State mean = State::Zero();
  StateMatrix covariance = StateMatrix::Zero();
};

inline bool is_finite(const Gaussian& g) { return g.mean.allFinite() && g.covariance.allFinite(); }

/// What a numerical step says of itself. On any error its output must not be used.
enum class [[nodiscard]] Numerics{
    kOk,
    kNotPositiveDefinite,  ///< an innovation covariance S has no Cholesky factor
    kNotFinite,            ///< NaN or infinity in a likelihood, a mean or a covariance
};

/// The average of a matrix and its transpose: takes away what rounding made asymmetric.
inline StateMatrix symmetric_part(const StateMatrix& m) { return 0.5 * (m + m.transpose()); }

}  // namespace dwell
