#include "tracker/normal_orthant.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/owens_t.hpp>

#include "radar/assert.hpp"

namespace dwell {
namespace {

using std::numbers::pi;

/// Correlations nearer to one than this are one: what rounding leaves of a singular covariance.
constexpr double kCollinear = 4.0 * std::numeric_limits<double>::epsilon();

/// y <= b with unit variances and correlations R.
struct Standardised {
  std::vector<double> b;
  Eigen::MatrixXd r;
  bool impossible = false;  ///< an element without variance is positive
};

Standardised standardise(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
  Standardised y;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    if (covariance(i, i) > 0.0) {
      kept.push_back(i);
    } else if (mean[i] > 0.0) {
      y.impossible = true;
    }
  }
  const auto size = static_cast<Eigen::Index>(kept.size());
  y.r.setIdentity(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const double sigma = std::sqrt(covariance(kept[i], kept[i]));
    y.b.push_back(-mean[kept[i]] / sigma);
    for (Eigen::Index j = 0; j < i; ++j) {
      const double rho = covariance(kept[i], kept[j]) / (sigma * std::sqrt(covariance(kept[j], kept[j])));
      y.r(i, j) = y.r(j, i) = std::clamp(rho, -1.0, 1.0);
    }
  }
  return y;
}

/// T(h, (k - rho h) / (h sqrt(1 - rho^2))), with its limit at h = 0.
double owen(double h, double k, double rho, double root) {
  const double rise = k - rho * h;
  if (h == 0.0) return rise == 0.0 ? 0.0 : std::copysign(0.25, rise);
  return boost::math::owens_t(h, std::clamp(rise / (h * root), -1e300, 1e300));
}

double bivariate(double h, double k, double rho) {
  if (rho > 1.0 - kCollinear) return normal_cdf(std::min(h, k));
  if (rho < kCollinear - 1.0) return h > -k ? normal_cdf(h) - normal_cdf(-k) : 0.0;
  if (h == 0.0 && k == 0.0) return 0.25 + std::asin(rho) / (2.0 * pi);
  const double root = std::sqrt((1.0 - rho) * (1.0 + rho));
  const bool opposite = h * k < 0.0 || (h * k == 0.0 && h + k < 0.0);
  const double value =
      0.5 * (normal_cdf(h) + normal_cdf(k)) - owen(h, k, rho, root) - owen(k, h, rho, root) - (opposite ? 0.5 : 0.0);
  return std::clamp(value, 0.0, 1.0);
}

/// Plackett's integrand for the pair (1, j) with the third element l: correlations t rho_1j, t rho_1l, rho_jl.
struct PlackettTerm {
  double b1, bj, bl;
  double rho_1j, rho_1l, rho_jl;

  /// `determinant` of R(t); `free` = 1 - t^2.
  double operator()(double t, double free, double determinant) const {
    const double r = t * rho_1j;
    const double one_minus_r2 = (1.0 - rho_1j * rho_1j) + free * rho_1j * rho_1j;
    if (one_minus_r2 <= 0.0) return 0.0;
    const double density =
        std::exp(-0.5 * ((b1 - r * bj) * (b1 - r * bj) / one_minus_r2 + bj * bj)) / std::sqrt(one_minus_r2);
    if (density == 0.0) return 0.0;
    const double mean = (b1 * (t * rho_1l - rho_jl * r) + bj * (rho_jl - t * rho_1l * r)) / one_minus_r2;
    const double sigma = std::sqrt(std::max(determinant, 0.0) / one_minus_r2);
    const double apart = bl - mean;
    const double conditional = sigma > 0.0 ? normal_cdf(apart / sigma) : (apart >= 0.0 ? 1.0 : 0.0);
    return rho_1j * density * conditional / (2.0 * pi);
  }
};

double trivariate(std::array<double, 3> b, double rho_12, double rho_13, double rho_23) {
  // The largest correlation is the one that is not swept.
  if (std::abs(rho_12) > std::abs(rho_23)) std::swap(b[0], b[2]), std::swap(rho_12, rho_23);
  if (std::abs(rho_13) > std::abs(rho_23)) std::swap(b[0], b[1]), std::swap(rho_13, rho_23);
  if (rho_23 > 1.0 - kCollinear) return bivariate(b[0], std::min(b[1], b[2]), rho_12);
  if (rho_23 < kCollinear - 1.0) {
    return b[1] > -b[2] ? bivariate(b[0], b[1], rho_12) - bivariate(b[0], -b[2], rho_12) : 0.0;
  }
  const PlackettTerm second{b[0], b[1], b[2], rho_12, rho_13, rho_23};
  const PlackettTerm third{b[0], b[2], b[1], rho_13, rho_12, rho_23};
  const double swept = rho_12 * rho_12 + rho_13 * rho_13 - 2.0 * rho_12 * rho_13 * rho_23;
  const double determinant = std::max(0.0, (1.0 - rho_23) * (1.0 + rho_23) - swept);
  // t = 1 - s^2 takes the root singularity of a singular R(1) away.
  const auto integrand = [&](double s) {
    const double t = 1.0 - s * s;
    const double free = s * s * (1.0 + t);
    const double of_t = determinant + free * swept;
    return 2.0 * s * (second(t, free, of_t) + third(t, free, of_t));
  };
  constexpr unsigned kDepth = 8;  // more would chase rounding
  const double integral =
      boost::math::quadrature::gauss_kronrod<double, 31>::integrate(integrand, 0.0, 1.0, kDepth, 1e-13);
  return std::clamp(normal_cdf(b[0]) * bivariate(b[1], b[2], rho_23) + integral, 0.0, 1.0);
}

/// Lower triangular root of a positive semidefinite matrix; columns of zeros where it is singular.
Eigen::MatrixXd semidefinite_root(const Eigen::MatrixXd& r) {
  const Eigen::Index size = r.rows();
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double rest = r(i, j) - root.row(i).head(j).dot(root.row(j).head(j));
      root(i, j) = root(j, j) > 0.0 ? rest / root(j, j) : 0.0;
    }
    const double rest = r(i, i) - root.row(i).head(i).squaredNorm();
    root(i, i) = rest > 1e-14 ? std::sqrt(rest) : 0.0;
  }
  return root;
}

double normal_quantile(double p) { return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * p); }

double lattice(const std::vector<double>& b, const Eigen::MatrixXd& r) {
  constexpr int kShifts = 16;
  constexpr int kPoints = 1024;
  const auto size = static_cast<Eigen::Index>(b.size());
  const Eigen::MatrixXd root = semidefinite_root(r);
  Eigen::VectorXd generator(size);  // fractional parts of the roots of primes (Richtmyer)
  for (int prime = 2, found = 0; found < size; ++prime) {
    bool composite = false;
    for (int d = 2; d * d <= prime; ++d) composite = composite || prime % d == 0;
    if (!composite) generator[found++] = std::sqrt(static_cast<double>(prime));
  }
  double sum = 0.0;
  Eigen::VectorXd w(size);
  for (int shift = 0; shift < kShifts; ++shift) {
    for (int point = 1; point <= kPoints; ++point) {
      double product = 1.0;
      for (Eigen::Index i = 0; i < size && product > 0.0; ++i) {
        const double rest = b[static_cast<std::size_t>(i)] - root.row(i).head(i).dot(w.head(i));
        if (root(i, i) == 0.0) {
          product *= rest >= -1e-12 ? 1.0 : 0.0;
          w[i] = 0.0;
          continue;
        }
        const double below = normal_cdf(rest / root(i, i));
        product *= below;
        const double x = point * generator[i] + shift * generator[size - 1 - i] / kShifts;
        const double folded = std::abs(2.0 * (x - std::floor(x)) - 1.0);
        w[i] = normal_quantile(std::clamp(folded * below, 1e-300, 1.0 - 1e-16));
      }
      sum += product;
    }
  }
  return sum / (kShifts * kPoints);
}

}  // namespace

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

double normal_orthant(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
  DWELL_ASSERT(mean.size() >= 1 && covariance.rows() == mean.size() && covariance.cols() == mean.size());
  DWELL_ASSERT(mean.allFinite() && covariance.allFinite());
  const Standardised y = standardise(mean, covariance);
  if (y.impossible) return 0.0;
  switch (y.b.size()) {
    case 0:
      return 1.0;
    case 1:
      return normal_cdf(y.b[0]);
    case 2:
      return bivariate(y.b[0], y.b[1], y.r(0, 1));
    case 3:
      return trivariate({y.b[0], y.b[1], y.b[2]}, y.r(0, 1), y.r(0, 2), y.r(1, 2));
    default:
      return lattice(y.b, y.r);
  }
}

}  // namespace dwell
