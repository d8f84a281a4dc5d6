#pragma once

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "radar/random.hpp"
#include "tracker/gaussian.hpp"

/// What the tests of this folder share: comparisons element by element, and random states and covariances.
namespace dwell::matrices {

inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Every |actual(i, j) - expected(i, j)| <= tolerance(i, j). Says which element is not.
template <class Actual, class Expected, class Tolerance>
testing::AssertionResult near(const Eigen::MatrixBase<Actual>& actual, const Eigen::MatrixBase<Expected>& expected,
                              const Eigen::MatrixBase<Tolerance>& tolerance) {
  for (Eigen::Index j = 0; j < expected.cols(); ++j) {
    for (Eigen::Index i = 0; i < expected.rows(); ++i) {
      if (std::abs(actual(i, j) - expected(i, j)) <= tolerance(i, j)) continue;
      return testing::AssertionFailure() << "element (" << i << ", " << j << "): " << actual(i, j) << " where "
                                         << expected(i, j) << " is expected; difference "
                                         << actual(i, j) - expected(i, j) << ", tolerance " << tolerance(i, j)
                                         << "\nactual\n"
                                         << actual << "\nexpected\n"
                                         << expected;
    }
  }
  return testing::AssertionSuccess();
}

template <class Actual, class Expected>
testing::AssertionResult near(const Eigen::MatrixBase<Actual>& actual, const Eigen::MatrixBase<Expected>& expected,
                              double tolerance) {
  return near(actual, expected, Expected::PlainObject::Constant(expected.rows(), expected.cols(), tolerance));
}

/// sqrt(P_ii P_jj): the natural size of element (i, j) of a covariance, whatever its units.
inline StateMatrix scale_of(const StateMatrix& covariance) {
  const State sigma = covariance.diagonal().cwiseSqrt();
  return sigma * sigma.transpose();
}

/// The smallest squared pivot of the Cholesky factor of the correlations P_ij / sqrt(P_ii P_jj): the least
/// share of a component's variance that the components before it leave open. Not positive where P has no
/// factor.
inline double smallest_pivot(const StateMatrix& covariance) {
  if (!(covariance.diagonal().minCoeff() > 0.0)) return 0.0;
  const StateMatrix correlation = covariance.cwiseQuotient(scale_of(covariance));
  const Eigen::LLT<StateMatrix> factor(correlation);
  if (factor.info() != Eigen::Success) return 0.0;
  const double least = factor.matrixLLT().diagonal().minCoeff();
  return least * least;
}

inline State normal_state(RandomStream& stream) {
  State x;
  for (double& value : x) value = stream.normal();
  return x;
}

/// A covariance of full rank with standard deviations up to a few times `sigma`: A A' of four times eight
/// normals, so that correlations are large and condition numbers stay moderate.
inline StateMatrix random_covariance(RandomStream& stream, const State& sigma) {
  StateMatrix sum = StateMatrix::Zero();
  for (int i = 0; i < 8; ++i) {
    const State column = sigma.cwiseProduct(normal_state(stream));
    sum += column * column.transpose();
  }
  return sum;
}

/// 300 m and 30 m/s: a track some scans old.
inline State typical_sigma() { return {300.0, 30.0, 300.0, 30.0}; }

inline Gaussian random_gaussian(RandomStream& stream) {
  return {(100.0 * typical_sigma()).cwiseProduct(normal_state(stream)), random_covariance(stream, typical_sigma())};
}

/// M probabilities that sum to one.
inline Eigen::VectorXd random_probability(RandomStream& stream, int size) {
  Eigen::VectorXd p(size);
  for (double& value : p) value = -std::log(1.0 - stream.uniform());
  return p / p.sum();
}

/// A stochastic matrix: rows sum to one.
inline Eigen::MatrixXd random_chain(RandomStream& stream, int size) {
  Eigen::MatrixXd chain(size, size);
  for (int i = 0; i < size; ++i) chain.row(i) = random_probability(stream, size).transpose();
  return chain;
}

}  // namespace dwell::matrices
