#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

/// Bounds for Monte Carlo checks, each derived from a distribution at a stated false-alarm rate.
namespace dwell::statistics {

/// The chance that a correct program fails one check. Seeds are fixed, so this matters only when a stream
/// changes: with 200 checks a change fails by chance once in 5000.
inline constexpr double kFalseAlarm = 1e-6;

struct Band {
  double low;
  double high;
  bool contains(double value) const { return low <= value && value <= high; }
};

/// P(a, x), the regularised lower incomplete gamma function, and its complement Q: the series below a + 1,
/// the continued fraction (modified Lentz) above.
/// Source  Abramowitz, Stegun (1964), 6.5.29 and 6.5.31.
inline double gamma_p(double a, double x);
inline double gamma_q(double a, double x);

inline double gamma_series(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (double n = a + 1.0; term > 1e-17 * sum; n += 1.0) sum += term *= x / n;
  return sum * std::exp(a * std::log(x) - x - std::lgamma(a));
}

inline double gamma_fraction(double a, double x) {
  double b = x + 1.0 - a;
  double c = 1e300;
  double d = 1.0 / b;
  double h = d;
  for (double i = 1.0;; i += 1.0) {
    const double an = -i * (i - a);
    b += 2.0;
    d = 1.0 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1.0) < 1e-15) return h * std::exp(a * std::log(x) - x - std::lgamma(a));
  }
}

inline double gamma_p(double a, double x) {
  if (x <= 0.0) return 0.0;
  return x < a + 1.0 ? gamma_series(a, x) : 1.0 - gamma_fraction(a, x);
}

inline double gamma_q(double a, double x) {
  if (x <= 0.0) return 1.0;
  return x < a + 1.0 ? 1.0 - gamma_series(a, x) : gamma_fraction(a, x);
}

inline double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }
inline double chi_square_cdf(double x, double degrees) { return gamma_p(0.5 * degrees, 0.5 * x); }

/// Where a chi-square variable lies except with probability `false_alarm`, half of it on each side. Exact.
inline Band chi_square_band(double degrees, double false_alarm = kFalseAlarm) {
  const auto solve = [&](auto below) {
    double low = 0.0;
    double high = 2.0 * degrees + 200.0;
    for (int i = 0; i < 80; ++i) {
      const double middle = 0.5 * (low + high);
      (below(middle) ? low : high) = middle;
    }
    return 0.5 * (low + high);
  };
  const double tail = 0.5 * false_alarm;
  return {solve([&](double x) { return gamma_p(0.5 * degrees, 0.5 * x) < tail; }),
          solve([&](double x) { return gamma_q(0.5 * degrees, 0.5 * x) > tail; })};
}

/// The same for a sum of `count` standard normal variables.
inline Band normal_sum_band(double count, double false_alarm = kFalseAlarm) {
  double low = 0.0;
  double high = 40.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (normal_cdf(-middle) > 0.5 * false_alarm ? low : high) = middle;
  }
  return {-high * std::sqrt(count), high * std::sqrt(count)};
}

/// The same for a count with probabilities exp(log_mass(k)), k = 0 .. last: tails summed term by term.
template <class LogMass>
Band count_band(LogMass log_mass, int last, double false_alarm) {
  const double tail = 0.5 * false_alarm;
  int low = 0;
  int high = last;
  for (double below = std::exp(log_mass(low)); below <= tail; below += std::exp(log_mass(low))) ++low;
  for (double above = std::exp(log_mass(high)); above <= tail; above += std::exp(log_mass(high))) --high;
  return {static_cast<double>(low), static_cast<double>(high)};
}

/// Successes in `trials` of probability p.
inline Band binomial_band(int trials, double p, double false_alarm = kFalseAlarm) {
  if (p <= 0.0 || p >= 1.0) return {trials * p, trials * p};
  const auto log_mass = [=](int k) {
    return std::lgamma(trials + 1.0) - std::lgamma(k + 1.0) - std::lgamma(trials - k + 1.0) + k * std::log(p) +
           (trials - k) * std::log1p(-p);
  };
  return count_band(log_mass, trials, false_alarm);
}

inline double poisson_log_mass(int k, double mean) { return k * std::log(mean) - mean - std::lgamma(k + 1.0); }

inline Band poisson_band(double mean, double false_alarm = kFalseAlarm) {
  // Beyond mean + 20 sqrt(mean) + 100 the tail is under 1e-30.
  const int last = static_cast<int>(mean + 20.0 * std::sqrt(mean) + 100.0);
  return count_band([=](int k) { return poisson_log_mass(k, mean); }, last, false_alarm);
}

/// Pearson's statistic; chi-square with bins - 1 degrees of freedom in the limit of large expected counts.
/// Requires every expected count to be 5 or more.
inline double pearson(std::span<const double> observed, std::span<const double> expected) {
  double sum = 0.0;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    sum += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
  }
  return sum;
}

struct Fit {
  double statistic;
  double degrees;
};

/// Pearson's statistic of counts against Poisson(mean); values of expected count under 10 are joined to the
/// tails.
inline Fit poisson_fit(std::span<const int> counts, double mean) {
  const double n = static_cast<double>(counts.size());
  const auto expected_count = [&](int k) { return n * std::exp(poisson_log_mass(k, mean)); };
  int low = 0;
  while (expected_count(low) < 10.0) ++low;
  int high = std::max(low + 1, static_cast<int>(mean) + 1);
  while (expected_count(high + 1) >= 10.0) ++high;
  std::vector<double> expected;
  double above = n;
  for (int k = 0; k < high; ++k) {
    const double here = expected_count(k);
    if (k > low || expected.empty()) expected.push_back(0.0);
    expected.back() += here;
    above -= here;
  }
  expected.push_back(above);
  std::vector<double> observed(expected.size(), 0.0);
  for (const int count : counts) observed[static_cast<std::size_t>(std::clamp(count, low, high) - low)] += 1.0;
  return {pearson(observed, expected), static_cast<double>(expected.size() - 1)};
}

/// Largest distance between the empirical distribution of the samples and `cdf`.
template <class Cdf>
double kolmogorov_distance(std::vector<double> samples, Cdf cdf) {
  std::sort(samples.begin(), samples.end());
  const double n = static_cast<double>(samples.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double expected = cdf(samples[i]);
    const double below = static_cast<double>(i) / n;
    distance = std::max({distance, expected - below, below + 1.0 / n - expected});
  }
  return distance;
}

/// P(distance > d) <= 2 exp(-2 n d^2) for every n. Source  Massart (1990), Annals of Probability 18,
/// 1269-1283.
inline double kolmogorov_bound(double n, double false_alarm = kFalseAlarm) {
  return std::sqrt(std::log(2.0 / false_alarm) / (2.0 * n));
}

/// P(|mean of n independent values in [-1, 1] of mean 0| > d) <= 2 exp(-n d^2 / 2). Source  Hoeffding (1963).
inline double hoeffding_bound(double n, double false_alarm = kFalseAlarm) {
  return std::sqrt(2.0 * std::log(2.0 / false_alarm) / n);
}

}  // namespace dwell::statistics
