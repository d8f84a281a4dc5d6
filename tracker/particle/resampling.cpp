#include "tracker/particle/resampling.hpp"

#include <algorithm>

#include "radar/assert.hpp"

namespace dwell {
namespace {

/// The c of optimal resampling; 0 where all stay.
double threshold(std::span<const double> weight, std::size_t count) {
  if (weight.size() <= count) return 0.0;
  std::vector<double> sorted(weight.begin(), weight.end());
  std::sort(sorted.begin(), sorted.end());  // so that the sums begin with what is small
  double below = 0.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    below += sorted[i];
    const std::size_t above = sorted.size() - 1 - i;
    if (above >= count) continue;
    const double c = below / static_cast<double>(count - above);
    if (above == 0 || sorted[i + 1] > c) return c;
  }
  return 0.0;
}

}  // namespace

void resample_systematically(std::span<const double> weight, std::size_t count, RandomStream& stream, Survivors& out) {
  DWELL_ASSERT(!weight.empty() && count > 0);
  const double step = 1.0 / static_cast<double>(count);
  out.index.clear();
  out.weight.assign(count, step);
  const double first = stream.uniform();
  double below = weight[0];
  std::size_t i = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double at = (static_cast<double>(k) + first) * step;
    while (below <= at && i + 1 < weight.size()) below += weight[++i];
    out.index.push_back(i);
  }
}

void resample_optimally(std::span<const double> weight, std::size_t count, RandomStream& stream, Survivors& out) {
  DWELL_ASSERT(!weight.empty() && count > 0);
  const double c = threshold(weight, count);
  out.index.clear();
  out.weight.clear();
  double left = stream.uniform() * c;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    if (weight[i] <= 0.0) continue;
    if (weight[i] > c) {
      out.index.push_back(i);
      out.weight.push_back(weight[i]);
      continue;
    }
    left -= weight[i];
    if (left >= 0.0) continue;
    left += c;
    out.index.push_back(i);
    out.weight.push_back(c);
  }
}

}  // namespace dwell
