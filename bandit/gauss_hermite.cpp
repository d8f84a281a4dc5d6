#include "bandit/gauss_hermite.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace dwell {

std::vector<QuadratureNode> gauss_hermite(int n) {
  Eigen::VectorXd off_diagonal(n - 1);
  for (int k = 1; k < n; ++k) off_diagonal[k - 1] = std::sqrt(static_cast<double>(k));
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::VectorXd::Zero(n), off_diagonal);
  std::vector<QuadratureNode> nodes;
  for (int i = 0; i < n; ++i) {
    const double first = solver.eigenvectors()(0, i);
    nodes.push_back({solver.eigenvalues()[i], first * first});
  }
  return nodes;
}

}  // namespace dwell
