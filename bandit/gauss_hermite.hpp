#pragma once

#include <vector>

namespace dwell {

/// One node of a quadrature rule for N(0, 1): E f(u) is about sum weight f(u); weights sum to one.
struct QuadratureNode {
  double u;
  double weight;
};

/// The Gauss-Hermite rule of n nodes: exact for polynomials of degree 2 n - 1. Requires n >= 1.
/// Nodes and weights from the eigenvectors of the Jacobi matrix with off-diagonals sqrt(1), sqrt(2), ...
/// Source  Golub, Welsch (1969).
std::vector<QuadratureNode> gauss_hermite(int n);

}  // namespace dwell
