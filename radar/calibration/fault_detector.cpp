#include "radar/calibration/fault_detector.hpp"

#include <algorithm>
#include <cmath>

namespace dwell {
namespace {

constexpr double kGrossScale = 20.0;  // of the noise
constexpr double kNoiseScale = 2.0;
constexpr double kFaultyScale = 3.0;  // what a healthy radar is told from
constexpr double kClear = 6.908;      // log(1e3)

}  // namespace

bool FaultDetector::add_plot(const PlotDensity& density) {
  const double gross = density.log_noise_ratio(kGrossScale);
  if (fault_ == Fault::kBias || fault_ == Fault::kNoise) {
    add_healthy(std::log(density.as_expected() / density.of_modes(kFaultyScale)));
  } else if (fault_ == Fault::kNone) {
    add(gross_, gross, Fault::kBias);
    add(noise_, density.log_noise_ratio(kNoiseScale), Fault::kNoise);
  }
  return gross > 0.0;
}

void FaultDetector::add_look(bool detected, double detection) {
  const double p = std::clamp(detection, 0.01, 0.99);
  const double ratio = detected ? std::log(0.5) : std::log((1.0 - 0.5 * p) / (1.0 - p));
  if (fault_ == Fault::kNone) {
    add(detection_, ratio, Fault::kDetection);
  } else if (fault_ == Fault::kDetection) {
    add_healthy(-ratio);
  }
}

void FaultDetector::add(double& sum, double ratio, Fault fault) {
  sum = std::max(0.0, sum + std::min(ratio, kMostOfAPlot));
  if (sum > kFlag && fault_ == Fault::kNone) fault_ = fault;
}

void FaultDetector::add_healthy(double ratio) {
  healthy_ = std::max(0.0, healthy_ + ratio);
  if (healthy_ > kClear) *this = FaultDetector();
}

}  // namespace dwell
