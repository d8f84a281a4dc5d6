#include "radar/calibration/fault_detector.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "radar/random.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

constexpr double kFalseDensity = 1e-7;  // of an innovation in sigmas: a plot in a footprint of some thousands of sigmas

Vector2 normal(RandomStream& stream) {
  const double first = stream.normal();
  return {first, stream.normal()};
}

/// A plot of a track that is known without error: N(0, I) of a radar as it should be.
void add(FaultDetector& detector, const Vector2& e) {
  const ExpectedPlot mode{1.0, e, Matrix2::Zero()};
  detector.add_plot(PlotDensity(std::span(&mode, 1), Matrix2::Identity(), kFalseDensity));
}

/// Flags in so many plots and looks of a radar as it should be, of a track in two modes: the other has ten times the
/// variance and is what a tenth of the plots are of.
TEST(FaultDetector, FlagsAGoodRadarLessThanOnceInTenThousandPlots) {
  RandomStream stream(1);
  const int plots = scaled(1'000'000);
  int flags = 0;
  FaultDetector detector;
  for (int i = 0; i < plots; ++i) {
    const Vector2 e = normal(stream) * (stream.uniform() < 0.1 ? std::sqrt(10.0) : 1.0);
    const ExpectedPlot modes[] = {{0.9, e, 0.3 * Matrix2::Identity()}, {0.1, e, 9.3 * Matrix2::Identity()}};
    detector.add_plot(PlotDensity(modes, 0.7 * Matrix2::Identity(), kFalseDensity));
    detector.add_look(stream.uniform() < 0.9, 0.9);
    if (detector.fault() == Fault::kNone) continue;
    ++flags;
    detector = FaultDetector();
  }
  // Ten are expected at most of a million by Lorden's bound; a hundred is what is promised.
  EXPECT_LE(flags, plots / 10'000);
  std::printf("%d false flags in %d plots\n", flags, plots);
}

/// Plots until the flag, the mean over trials.
double delay(const Vector2& mean, double scale) {
  double sum = 0.0;
  const int trials = scaled(2000);
  for (int trial = 0; trial < trials; ++trial) {
    RandomStream stream(trial);
    FaultDetector detector;
    int plots = 0;
    while (detector.fault() == Fault::kNone && plots < 1000) {
      add(detector, mean + scale * normal(stream));
      ++plots;
    }
    sum += plots;
  }
  return sum / trials;
}

TEST(FaultDetector, FlagsAStepOfTenSigmaAtTheSecondPlot) {
  EXPECT_DOUBLE_EQ(delay({0.0, 10.0}, 1.0), 2.0);
  EXPECT_DOUBLE_EQ(delay({-10.0, 0.0}, 1.0), 2.0);
}

/// h over the mean ratio, E |e|^2 3/8 - 2 log 2 at twice the sigma, 1.61, and the overshoot, some three.
TEST(FaultDetector, FlagsDoubledNoise) { EXPECT_LE(delay({0.0, 0.0}, 2.0), 13.5 / 1.61 + 4.0); }

TEST(FaultDetector, FlagsLostDetectionsAndClearsThemByDetections) {
  FaultDetector detector;
  int looks = 0;
  while (detector.fault() == Fault::kNone) {
    detector.add_look(false, 0.9);
    ++looks;
  }
  EXPECT_EQ(detector.fault(), Fault::kDetection);
  EXPECT_EQ(looks, 8);  // log(.55 / .1) = 1.70 a miss
  for (int plot = 0; plot < 100; ++plot) add(detector, Vector2::Zero());
  EXPECT_EQ(detector.fault(), Fault::kDetection);
  looks = 0;
  while (detector.fault() != Fault::kNone) {
    detector.add_look(true, 0.9);
    ++looks;
  }
  EXPECT_EQ(looks, 10);  // log 2 = .69 each, to log 10^3 = 6.9
}

TEST(FaultDetector, OneFalsePlotFlagsNothing) {
  for (const double far : {3.0, 30.0, 300.0, 1e9}) {
    FaultDetector detector;
    add(detector, {far, -far});
    EXPECT_EQ(detector.fault(), Fault::kNone);
  }
}

TEST(FaultDetector, IsClearedByGoodPlotsAndNotByBadOnes) {
  RandomStream stream(3);
  FaultDetector detector;
  for (int i = 0; i < 2; ++i) add(detector, {0.0, 20.0});
  ASSERT_EQ(detector.fault(), Fault::kBias);
  for (int i = 0; i < 1000; ++i) add(detector, Vector2(0.0, 5.0) + normal(stream));
  EXPECT_EQ(detector.fault(), Fault::kBias);
  int plots = 0;
  while (detector.fault() != Fault::kNone && plots < 100) {
    add(detector, normal(stream));
    ++plots;
  }
  EXPECT_LE(plots, 30);
}

}  // namespace
}  // namespace dwell::testing
