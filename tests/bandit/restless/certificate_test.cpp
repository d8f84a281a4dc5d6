// The certificates, checked by what they claim and nothing of how they were found.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "bandit/restless/bound.hpp"
#include "bandit/restless/concave_mesh.hpp"
#include "bandit/restless/simulate.hpp"
#include "tests/bandit/restless/instances.hpp"

namespace dwell::restless::testing {
namespace {

using Wide = Eigen::Matrix<long double, 2, 2>;

constexpr double kRounding = 1e-12;

Wide wide(const Matrix& m) { return Eigen::Matrix2d(m).cast<long double>(); }

/// The covariance after a detection, in information form: nothing of Joseph's.
Wide after_look(const Sensor& sensor, const Wide& p) {
  const auto h = sensor.h.cast<long double>().eval();
  const auto r = sensor.r.cast<long double>().eval();
  return (p.inverse() + h.transpose() * r.inverse() * h).inverse();
}

long double smaller_eigenvalue(const Wide& m) {
  const long double half = 0.5L * (m(0, 0) + m(1, 1));
  const long double apart = 0.5L * (m(0, 0) - m(1, 1));
  return half - std::sqrt(apart * apart + m(0, 1) * m(1, 0));
}

/// What the certificate proves; NaN where a mixture is none, or is not below its successor.
double proved(const Arm& arm, double discount, const Certificate& certificate) {
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  const auto f = arm.f.cast<long double>().eval();
  long double least_change = std::numeric_limits<long double>::infinity();
  for (std::size_t k = 0; k < certificate.points.size(); ++k) {
    const Wide p = wide(certificate.points[k]);
    std::vector<long double> follow;  // by outcome: what the scan costs, and v after it
    for (std::size_t outcome = 0; outcome <= arm.sensors.size(); ++outcome) {
      // Point zero has no inverse, and stays zero whoever looks.
      const bool zero = p.isZero();
      const Wide m = outcome == 0 || zero ? p : after_look(arm.sensors[outcome - 1], p);
      const Wide next = f * m * f.transpose() + wide(arm.q);
      Wide left = next;
      long double sum = 0.0L;
      long double value = 0.0L;
      for (const auto& [point, weight] : certificate.below[k][outcome]) {
        if (!(weight >= 0.0)) return kNothing;
        sum += weight;
        value += static_cast<long double>(weight) * certificate.values[static_cast<std::size_t>(point)];
        left -= static_cast<long double>(weight) * wide(certificate.points[static_cast<std::size_t>(point)]);
      }
      if (!(std::abs(sum - 1.0L) <= kRounding)) return kNothing;
      if (!(smaller_eigenvalue(left) >= -kRounding * next.trace())) return kNothing;
      const long double cost = arm.weight * (wide(arm.cost).cwiseProduct(m)).sum();
      follow.push_back(cost + discount * value);
    }
    long double least = follow[0];
    for (std::size_t s = 0; s < arm.sensors.size(); ++s) {
      const long double p_d = arm.sensors[s].p_detect;
      least = std::min(least, p_d * follow[s + 1] + (1.0L - p_d) * follow[0] + certificate.price * arm.dwell);
    }
    least_change = std::min(least_change, least - certificate.values[k]);
  }
  if (discount == 1.0) return static_cast<double>(least_change);
  return static_cast<double>(certificate.values[0] + least_change / (1.0L - discount));
}

Certificate certificate_of(const Arm& arm, double discount, double price, double& cost) {
  PricedArm set(arm, discount);
  cost = set.solve(price).total(price);
  CertificateSettings settings;
  settings.enough = cost * (1.0 - 1e-3);
  return certify(arm, discount, price, set.value(), settings);
}

/// One sensor and two, sure and unsure, average and discounted. 1e-9: sums of a thousand terms of the value's size.
TEST(Certificate, ProvesWhatItSays) {
  Arm two_sensors = constant_velocity_arm(1, 25);
  Sensor other = two_sensors.sensors[0];
  other.h << 0.5, 0.5;
  other.p_detect = 0.7;
  two_sensors.sensors.push_back(other);
  const struct {
    Arm arm;
    double discount, price;
  } cases[] = {{constant_velocity_arm(10, 1), 1.0, 32.0},
               {constant_velocity_arm(0.2, 25, 2), 1.0, 80.0},
               {constant_velocity_arm(1, 4, 1, 0.8), 1.0, 10.0},
               {constant_velocity_arm(1, 4), 0.95, 10.0},
               {two_sensors, 1.0, 60.0}};
  for (const auto& c : cases) {
    double cost = 0.0;
    const Certificate certificate = certificate_of(c.arm, c.discount, c.price, cost);
    EXPECT_NEAR(proved(c.arm, c.discount, certificate), certificate.value, 1e-9 * cost);
    EXPECT_LE(certificate.value, cost * (1.0 + 1e-9));
    EXPECT_GE(certificate.value, 0.95 * cost);  // and says something
    std::printf("certified %.6g, the best policy known %.6g: %.3f %% apart, %d points\n", certificate.value, cost,
                100.0 * (1.0 - certificate.value / cost), static_cast<int>(certificate.points.size()));
  }
}

/// The verifier's own check: a weight moved to a higher point is no longer below, a value raised proves less.
TEST(Certificate, AForgeryIsFound) {
  const Arm arm = constant_velocity_arm(10, 1);
  double cost = 0.0;
  const Certificate certificate = certificate_of(arm, 1.0, 32.0, cost);
  std::size_t highest = 0;
  for (std::size_t k = 0; k < certificate.points.size(); ++k) {
    if (certificate.points[k](0, 0) > certificate.points[highest](0, 0)) highest = k;
  }
  Certificate forged = certificate;
  forged.below[2][1] = {{static_cast<int>(highest), 1.0}};
  EXPECT_TRUE(std::isnan(proved(arm, 1.0, forged)));
  forged = certificate;
  forged.values[2] += 0.1 * cost;
  EXPECT_LT(proved(arm, 1.0, forged), certificate.value - 1e-3 * cost);
}

/// No policy is below it. The bound of C2 (daemon/scenarios/restless): within .05 % of what is achieved.
TEST(Certificate, OfC2IsWithinATwentiethOfAPercentOfWhatIsAchieved) {
  const Problem problem = c2();
  const Analysis analysis = analyse(problem);
  const Bound bound = certify(problem, analysis);
  EXPECT_EQ(bound.kind, BoundKind::kCertified);
  const auto policy = make_policy(IndexSettings{}, problem, analysis.priced);
  const double achieved = simulate(problem, *policy, {}).cost;
  EXPECT_LE(bound.value, achieved);
  EXPECT_GE(bound.value, achieved * (1.0 - 5e-4));
  EXPECT_LE(bound.value, bound.reference.value() * (1.0 + 1e-9));
  std::printf("certified %.5f, achieved %.5f: %.4f %%\n", bound.value, achieved,
              100.0 * (achieved / bound.value - 1.0));
}

}  // namespace
}  // namespace dwell::restless::testing
