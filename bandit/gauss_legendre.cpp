#include "bandit/gauss_legendre.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace dwell {

std::vector<QuadratureNode> gauss_legendre(int n) {
  Eigen::VectorXd off_diagonal(n - 1);
  for (int k = 1; k < n; ++k) off_diagonal[k - 1] = k / std::sqrt(4.0 * k * k - 1.0);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::VectorXd::Zero(n), off_diagonal);
  std::vector<QuadratureNode> nodes;
  for (int i = 0; i < n; ++i) {
    const double first = solver.eigenvectors()(0, i);
    nodes.push_back({0.5 + 0.5 * solver.eigenvalues()[i], first * first});
  }
  return nodes;
}

}  // namespace dwell
