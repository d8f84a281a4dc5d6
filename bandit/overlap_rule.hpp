#pragma once

#include <span>
#include <vector>

#include "bandit/gauss_legendre.hpp"
#include "radar/state.hpp"

namespace dwell {

/// f(y) = c N(y; z, S) in the plane.
struct WeightedNormal {
  Vector2 z = Vector2::Zero();
  Matrix2 information = Matrix2::Zero();  ///< S^-1
  double log_peak = 0.0;                  ///< log f(z) = log c - log |2 pi S| / 2

  double log_density(const Vector2& y) const { return log_peak - 0.5 * (y - z).dot(information * (y - z)); }
};

/// Quadrature over the overlap of two weighted Gaussians, for integrands h(y) q(y) with q smooth and
///
///   h = f_a f_b / (f_a + f_b),   -log h = log(exp(A) + exp(B)),   A = -log f_a, B = -log f_b.
///
/// -log h is convex, so h has one peak and falls along every ray, but its shape is anything between min(f_a,
/// f_b) and a Gaussian: a bump, a ridge along A = B, or a plateau with an edge. No fixed Gaussian suits them
/// all: where modes are well apart or one is rare, Gauss-Hermite nodes miss the overlap.
///
/// Peak     y(s) = (I_a + I_b)^-1 (I_a z_a + I_b z_b) with I_a = (1 - s) S_a^-1, I_b = s S_b^-1, at the s
///          that equals f_a / (f_a + f_b) there: one equation, solved in logit(s).
/// Frame    eigenvectors of the Hessian of -log h at the peak, in coordinates where S_a^-1 + S_b^-1 = I;
///          the centre and the two half-widths are those of {h = peak / e^2} along them.
/// Rays     2 floor(nodes / 2) + 4 of them, evenly in that frame's angle, the same whatever the signs of its
///          axes; along each, Gauss-Legendre with `nodes` from the centre to where max(A, B), a closed form,
///          is 4 + .6 nodes above the peak's: of a ridge, what lies beyond is .7 % at 5 nodes, 5e-4 at 10,
///          and less of the others. The test of the expected cost's error chose both numbers.
///
/// The rule is the same for (a, b) and (b, a), and turns with the plane.
class OverlapRule {
 public:
  struct Node {
    Vector2 y;
    double area;  ///< the integral is sum area h(y) q(y)
  };

  /// Requires nodes >= 1.
  explicit OverlapRule(int nodes);

  /// nodes x rays of them, valid until the next call. No allocation.
  std::span<const Node> place(const WeightedNormal& a, const WeightedNormal& b);

 private:
  std::vector<QuadratureNode> radii_;
  std::vector<Vector2> directions_;
  double depth_;
  std::vector<Node> nodes_;
};

}  // namespace dwell
