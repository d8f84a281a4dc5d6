#pragma once

#include <vector>

namespace dwell {

/// One node of a quadrature rule on [0, 1]: the integral of f is about sum weight f(u); weights sum to one.
struct QuadratureNode {
  double u;
  double weight;
};

/// The Gauss-Legendre rule of n nodes: exact for polynomials of degree 2 n - 1. Requires n >= 1.
/// Nodes and weights from the eigenvectors of the Jacobi matrix with off-diagonals k / sqrt(4 k^2 - 1), k =
/// 1, 2, ... Source  Golub, Welsch (1969).
std::vector<QuadratureNode> gauss_legendre(int n);

}  // namespace dwell
