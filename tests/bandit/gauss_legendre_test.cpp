#include "bandit/gauss_legendre.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dwell::testing {
namespace {

/// The integral of u^k over [0, 1] is 1 / (k + 1). 1e-14: a few roundings of the eigenvectors' first
/// components.
TEST(GaussLegendre, MomentsAreExactToDegreeTwiceTheNodesLessOne) {
  for (int n = 1; n <= 32; ++n) {
    const auto nodes = gauss_legendre(n);
    ASSERT_EQ(std::ssize(nodes), n);
    for (int k = 0; k <= 2 * n - 1; ++k) {
      double moment = 0.0;
      for (const QuadratureNode& node : nodes) moment += node.weight * std::pow(node.u, k);
      EXPECT_NEAR(moment, 1.0 / (k + 1), 1e-14) << n << " nodes, degree " << k;
    }
  }
}

/// The error of degree 2 n is (n!)^4 / ((2 n + 1) ((2 n)!)^2) of the monic polynomial: the rule is not better
/// than it is.
TEST(GaussLegendre, TheNextMomentIsNot) {
  for (int n = 1; n <= 8; ++n) {
    double moment = 0.0;
    for (const QuadratureNode& node : gauss_legendre(n)) moment += node.weight * std::pow(node.u, 2 * n);
    const double log_error = 4.0 * std::lgamma(n + 1.0) - 2.0 * std::lgamma(2.0 * n + 1.0) - std::log(2.0 * n + 1.0);
    const double error = std::exp(log_error);
    EXPECT_NEAR(1.0 / (2 * n + 1) - moment, error, 1e-14 + 1e-6 * error) << n;
  }
}

TEST(GaussLegendre, NodesLieInsideAndMirrorEachOther) {
  for (int n = 1; n <= 32; ++n) {
    const auto nodes = gauss_legendre(n);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const QuadratureNode& mirror = nodes[nodes.size() - 1 - i];
      EXPECT_GT(nodes[i].u, 0.0);
      EXPECT_LT(nodes[i].u, 1.0);
      EXPECT_GT(nodes[i].weight, 0.0);
      EXPECT_NEAR(nodes[i].u + mirror.u, 1.0, 1e-15 * n);
      EXPECT_NEAR(nodes[i].weight, mirror.weight, 1e-15 * n);
    }
  }
}

}  // namespace
}  // namespace dwell::testing
