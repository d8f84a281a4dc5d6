#include "bandit/restless/mechanical_word.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dwell::restless {
namespace {

constexpr int kLargestDenominator = 2048;
/// Convexity bounds what is left between two neighbours that differ by less, as a part of the total.
constexpr double kSettled = 1e-12;

bool looks(int t, int m, int n) { return (static_cast<long long>(t) + 1) * m / n > static_cast<long long>(t) * m / n; }

struct Rate {
  int m;
  int n;
  double total;
};

}  // namespace

double mechanical_cost(const ScalarArm& arm, int m, int n) {
  const double f2 = arm.f * arm.f;
  if (m == 0 || arm.blind()) {
    return f2 < 1.0 ? arm.weight * arm.q / (1.0 - f2) : std::numeric_limits<double>::infinity();
  }
  double a = 1.0, b = 0.0, c = 0.0, d = 1.0;
  for (int t = 0; t < n; ++t) {
    // Idle: p -> f^2 p + q. Look: p -> (f^2 r p + q (p + r)) / (p + r).
    const bool look = looks(t, m, n);
    const double e = look ? f2 * arm.r + arm.q : f2, g = look ? arm.q * arm.r : arm.q;
    const double h = look ? 1.0 : 0.0, k = look ? arm.r : 1.0;
    const double na = e * a + g * c, nb = e * b + g * d, nc = h * a + k * c, nd = h * b + k * d;
    const double scale = 1.0 / (std::abs(na) + std::abs(nb) + std::abs(nc) + std::abs(nd));
    a = na * scale, b = nb * scale, c = nc * scale, d = nd * scale;
  }
  const double half = 0.5 * (d - a);
  const double root = std::sqrt(half * half + b * c);
  double p = half > 0.0 ? b / (half + root) : (root - half) / c;
  double sum = 0.0;
  for (int t = 0; t < n; ++t) {
    const double after = looks(t, m, n) ? arm.after_look(p) : p;
    sum += after;
    p = arm.predict(after);
  }
  return arm.weight * sum / n;
}

RatedCost best_rate(const ScalarArm& arm, double price) {
  const auto at = [&](int m, int n) { return Rate{m, n, mechanical_cost(arm, m, n) + price * arm.dwell * m / n}; };
  const auto mediant = [&](const Rate& a, const Rate& b) {
    if (a.n + b.n <= kLargestDenominator) return at(a.m + b.m, a.n + b.n);
    return Rate{a.m + b.m, a.n + b.n, std::numeric_limits<double>::infinity()};
  };
  const auto answer = [&](const Rate& rate, bool found) {
    const double looks_a_scan = static_cast<double>(rate.m) / rate.n;
    return RatedCost{rate.total - price * arm.dwell * looks_a_scan, looks_a_scan, found};
  };
  Rate low = at(0, 1);
  Rate high = at(1, 1);
  if (arm.blind() || low.total <= at(1, kLargestDenominator).total) return answer(low, true);
  if (high.total <= at(kLargestDenominator - 1, kLargestDenominator).total) return answer(high, true);
  Rate middle = mediant(low, high);
  for (;;) {
    const Rate left = mediant(low, middle);
    const Rate right = mediant(middle, high);
    if (left.total < middle.total) {
      high = middle;
      middle = left;
    } else if (right.total < middle.total) {
      low = middle;
      middle = right;
    } else {
      const bool words_end = std::max(left.n, right.n) > kLargestDenominator;
      const bool settled = std::max(left.total, right.total) - middle.total <= kSettled * middle.total;
      if (words_end || settled) return answer(middle, std::isfinite(std::min(low.total, left.total)));
      low = left;
      high = right;
    }
  }
}

}  // namespace dwell::restless
