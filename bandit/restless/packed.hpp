#pragma once

#include <Eigen/Core>

#include "bandit/restless/problem.hpp"

namespace dwell::restless {

/// Symmetric n x n matrices as vectors of m = n (n + 1) / 2, column by column of the lower triangle.
///
///   state form     p = (P_11, P_21, .., P_22, ..)            of covariances
///   weight form    l = (L_11, 2 L_21, .., L_22, ..)          of what multiplies them: l'p = <L, P>
inline constexpr int kMaximumPacked = kMaximumStates * (kMaximumStates + 1) / 2;
using Packed = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaximumPacked, 1>;
using PackedMap =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaximumPacked, kMaximumPacked>;

inline Eigen::Index packed_size(Eigen::Index n) { return n * (n + 1) / 2; }

Packed pack_state(const Matrix& p);
Packed pack_weight(const Matrix& l);
Matrix unpack_state(const Packed& p, Eigen::Index n);

/// The m x m matrix of P -> G P G' in state form.
PackedMap congruence(const Matrix& g);

}  // namespace dwell::restless
