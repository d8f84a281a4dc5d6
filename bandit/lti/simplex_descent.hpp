#pragma once

#include <functional>

#include <Eigen/Core>

namespace dwell::lti {

/// The nearest point of the simplex { q >= 0, sum q = 1 }.
/// Source  Held, Wolfe, Crowder (1974), Mathematical Programming 6, 62-88: by sorting.
Eigen::VectorXd nearest_on_simplex(const Eigen::VectorXd& point);

/// Value of a smooth function at q, each column of which is on the simplex, and its gradient. Infinite where the
/// function has no value; the gradient is then not used.
using SimplexFunction = std::function<double(const Eigen::MatrixXd& q, Eigen::MatrixXd& gradient)>;

struct DescentSettings {
  int iterations = 500;      ///< at most
  double tolerance = 1e-10;  ///< of the projected gradient, relative to the largest entry of the first gradient
};

/// Descends from q to a point without a direction of descent; of a convex function that is the minimum. A start
/// without a value is returned as it is. Spectral projected gradient: steps of Barzilai and Borwein's length,
/// projected, and shortened until the value is below the largest of the last ten by Armijo's rule. Source  Birgin,
/// Martinez, Raydan (2000), SIAM J. Optim. 10, 1196-1211, algorithm 2.2.
Eigen::MatrixXd descend(const SimplexFunction& function, Eigen::MatrixXd q, const DescentSettings& settings);

}  // namespace dwell::lti
