#include "bandit/information_reduction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dwell {
namespace {

constexpr std::array kDetection{0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99};
constexpr std::array kFalsePlots{0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0};

/// 1 - q2 / P_d, a row for each P_d.
constexpr std::array<std::array<double, kFalsePlots.size()>, kDetection.size()> kLoss{{
    {0.00842, 0.02159, 0.05465, 0.11607, 0.24379, 0.42144, 0.66053, 0.84494, 0.94276},
    {0.00447, 0.01116, 0.03042, 0.06897, 0.15781, 0.30321, 0.53360, 0.75293, 0.90883},
    {0.00313, 0.00838, 0.02234, 0.05326, 0.12611, 0.25530, 0.47960, 0.70568, 0.88436},
    {0.00225, 0.00550, 0.01630, 0.04103, 0.10129, 0.21349, 0.42476, 0.66606, 0.86900},
    {0.00175, 0.00412, 0.01162, 0.02955, 0.07733, 0.17472, 0.37088, 0.62139, 0.84649},
    {0.00099, 0.00261, 0.00706, 0.01923, 0.05552, 0.13200, 0.31196, 0.56870, 0.82656},
    {0.00086, 0.00182, 0.00504, 0.01435, 0.04232, 0.10937, 0.27613, 0.53410, 0.80847},
    {0.00064, 0.00136, 0.00349, 0.00959, 0.03068, 0.08545, 0.23915, 0.50125, 0.79960},
}};

/// The place of the interval of x, clamped to those there are.
template <std::size_t N>
std::size_t interval(const std::array<double, N>& points, double x) {
  const auto above = std::upper_bound(points.begin() + 1, points.end() - 1, x);
  return static_cast<std::size_t>(above - points.begin()) - 1;
}

}  // namespace

double information_reduction(double p_detect, double false_plots) {
  if (false_plots <= 0.0 || p_detect <= 0.0) return p_detect;
  const double p = std::clamp(p_detect, kDetection.front(), kDetection.back());
  const std::size_t row = interval(kDetection, p);
  const double within = std::min(false_plots, kFalsePlots.back());
  const std::size_t column = interval(kFalsePlots, false_plots);
  const double down = (p - kDetection[row]) / (kDetection[row + 1] - kDetection[row]);
  const double along = std::log(within / kFalsePlots[column]) / std::log(kFalsePlots[column + 1] / kFalsePlots[column]);
  const auto log_loss = [&](std::size_t at) {
    return (1.0 - along) * std::log(kLoss[at][column]) + along * std::log(kLoss[at][column + 1]);
  };
  const double loss = std::exp((1.0 - down) * log_loss(row) + down * log_loss(row + 1));
  return p_detect * (1.0 - loss) * within / false_plots;
}

}  // namespace dwell
