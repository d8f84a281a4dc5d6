// A radar that goes bad while it runs, on calibration_traffic with calibration applied: how soon it is flagged, what it
// does to the tracks, how it comes back; and how often a good one is flagged.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/scenarios/calibrated_run.hpp"
#include "tests/statistics.hpp"

namespace dwell::testing {
namespace {

constexpr std::uint64_t kFrom = 300;  // scans at 1 s
constexpr std::uint64_t kTo = 450;    // 45 plots of each radar in turn
constexpr std::size_t kBad = 1;       // southeast

EngineConfig traffic(const PolicySettings& policy) {
  EngineConfig config = scenario("calibration_traffic", policy);
  config.calibration.mode = CalibrationMode::kApply;
  config.calibration.period_scans = 1'000'000;  // nothing is solved: the figures are right, and flags need no solve
  return config;
}

EngineConfig with_fault(EngineConfig config, std::size_t radar, const RadarTruth& change) {
  RadarFault bad;
  bad.start = TimePoint(from_seconds(kFrom));
  bad.end = TimePoint(from_seconds(kTo));
  bad.change = change;
  config.sensors[radar].faults.push_back(bad);
  return config;
}

RadarTruth azimuth_step(double degrees) {
  RadarTruth change;
  change.correction.azimuth_bias_rad = degrees * kDegree;
  return change;
}

const RoundRobinSettings kTurns{RoundRobinSettings::Order::kTrackFastest};

RadarTruth range_step(double metres) {
  RadarTruth change;
  change.correction.range_bias_m = metres;
  return change;
}

/// A step of so many sigma of the radar's noise in range (component 0) or azimuth (1).
RadarTruth step(std::size_t radar, int component, double sigmas) {
  const auto& figures = std::get<RadarFigures>(traffic(kTurns).sensors[radar].figures);
  return component == 0 ? range_step(sigmas * figures.range_noise_floor_m)
                        : azimuth_step(sigmas * figures.azimuth_noise_floor_rad / kDegree);
}

/// Of one radar in one run.
struct Record {
  std::optional<int> plots_to_flag;   ///< from the fault on; plots of the target that was looked at
  std::optional<int> plots_to_clear;  ///< from its end
  bool blamed_others = false;         ///< before it was flagged itself
};

Record follow(EngineConfig config, std::size_t radar, int seed) {
  config.seed = static_cast<std::uint64_t>(seed);
  Record record;
  int plots = 0;
  run_calibrated(config, 600, [&](const Engine& engine) {
    const std::uint64_t scan = engine.last().scan;
    const auto is_flagged = [&](std::size_t i) { return engine.calibrator().radar(i)->fault != Fault::kNone; };
    const bool flagged = is_flagged(radar);
    if (scan == kFrom || scan == kTo) plots = 0;
    const Dwell& dwell = engine.last().looks.front().dwell;
    // Tracks are cued: a track has the number of its target.
    const bool seen = std::ranges::any_of(
        engine.last().plots, [&](const Plot& plot) { return plot.source == TargetId{dwell.track.number}; });
    plots += dwell.radar.number == radar + 1 && seen;
    if (scan >= kFrom && scan < kTo && !record.plots_to_flag) {
      if (flagged) record.plots_to_flag = plots;
      for (std::size_t i = 0; i < 3; ++i) record.blamed_others |= i != radar && is_flagged(i);
    }
    if (!flagged && record.plots_to_flag && scan >= kTo && !record.plots_to_clear) record.plots_to_clear = plots;
  });
  return record;
}

/// How soon a step is flagged and, after its end, cleared.
struct Delays {
  int runs = 0;
  int flagged = 0;
  int in_time = 0;  ///< of those, within the plots that are asked for
  int most = 0;
  double mean = 0.0;
  int blamed_others = 0;
  int comes_back = 0;
  double cleared = 0.0;  ///< plots until it does, mean
};

Delays delays(std::size_t radar, const RadarTruth& change, int limit) {
  Delays out;
  out.runs = soaked(200, 5);
  for (int seed = 1; seed <= out.runs; ++seed) {
    const Record record = follow(with_fault(traffic(kTurns), radar, change), radar, seed);
    out.blamed_others += record.blamed_others;
    if (!record.plots_to_flag) continue;
    ++out.flagged;
    out.in_time += *record.plots_to_flag <= limit;
    out.most = std::max(out.most, *record.plots_to_flag);
    out.mean += *record.plots_to_flag;
    if (!record.plots_to_clear) continue;
    ++out.comes_back;
    out.cleared += *record.plots_to_clear;
  }
  out.mean /= std::max(out.flagged, 1);
  out.cleared /= std::max(out.comes_back, 1);
  std::printf(
      "radar %zu: flagged in %d of %d runs, %d within %d plots, after %.1f on average and %d at most, another one "
      "first in %d; back in %d, after %.1f\n",
      radar + 1, out.flagged, out.runs, out.in_time, limit, out.mean, out.most, out.blamed_others, out.comes_back,
      out.cleared);
  return out;
}

/// What a look's plot is to its track.
struct Innovation {
  std::size_t radar;
  bool used;
  Vector2 nu;   ///< of the combined prediction
  Matrix2 sum;  ///< sum_j c_j S_j^-1 over the modes
};

std::vector<Innovation> innovations(const EngineConfig& config) {
  const DiscreteBank bank = *discretise(config.bank, to_seconds(config.scan_period));
  std::vector<Innovation> all;
  Engine engine(config);
  while (engine.last().scan < kTo) {
    const std::vector<Track> before(engine.tracks().begin(), engine.tracks().end());
    const LookReport& look = engine.scan().looks.front();
    const auto track = std::ranges::find(before, look.dwell.track, &Track::id);
    ImmEstimate predicted;
    if (predict(bank, track->estimate, predicted) != Numerics::kOk) continue;
    const Sensor& radar = *engine.sensors()[look.dwell.radar.number - 1];
    const State mean = combined_mean(predicted);
    Innovation out{look.dwell.radar.number - 1, look.used_plot.has_value(), Vector2::Zero(), Matrix2::Zero()};
    for (int j = 0; j < predicted.size(); ++j) {
      const MeasurementJacobian h = radar.jacobian(predicted.modes[j].mean);
      const Matrix2 s = h * predicted.modes[j].covariance * h.transpose() + radar.noise(mean);
      out.sum += predicted.probability[j] * s.inverse();
    }
    if (out.used) out.nu = radar.residual(engine.last().plots[*look.used_plot].z, radar.measure(mean));
    all.push_back(out);
  }
  return all;
}

/// The least mean delay of any detector with 10^5 plots between false flags, plots of the radar: log 10^5 / I (Lorden),
/// I the Kullback-Leibler information d' S^-1 d / 2 that a step puts into the innovations of all radars, per plot of
/// the one that is wrong. d is the difference between a run with the step and the same without.
double least_delay(std::size_t radar, const RadarTruth& change) {
  double information = 0.0;
  int plots = 0;
  for (int seed = 1; seed <= soaked(20, 3); ++seed) {
    EngineConfig config = traffic(kTurns);
    config.calibration.mode = CalibrationMode::kObserve;
    config.seed = static_cast<std::uint64_t>(seed);
    const auto good = innovations(config);
    const auto bad = innovations(with_fault(config, radar, change));
    for (std::size_t i = kFrom; i < good.size() && i < bad.size(); ++i) {
      if (good[i].radar != bad[i].radar || !good[i].used || !bad[i].used) continue;
      const Vector2 d = bad[i].nu - good[i].nu;
      information += 0.5 * d.dot(good[i].sum * d);
      plots += good[i].radar == radar;
    }
  }
  return std::log(1e5) * plots / information;
}

/// A plot that finds its track in a hard turn says less: one run in some hundreds takes longer.
TEST(RadarFault, AStepOfADegreeIsFlaggedWithinFivePlotsAndCleared) {
  for (std::size_t radar = 0; radar < 3; ++radar) {
    const Delays step = delays(radar, azimuth_step(1.0), 5);
    EXPECT_GE(step.in_time, statistics::binomial_band(step.runs, 0.995).low);
    EXPECT_LE(step.most, 20);
    EXPECT_EQ(step.comes_back, step.runs);
    EXPECT_EQ(step.blamed_others, 0);
  }
}

/// What the detector may take for the least of all: its h of 13.5 + log 6 and an overshoot of 1.5 for 11.5, and of the
/// bound's information about half, that of the quietest mode.
constexpr double kTimesTheLeast = 3.0;

/// Two sigma of its own noise: within 40 plots where that can be, a mean of 20 and the spread of a sum that is over h,
/// sqrt(2 / h) = .37 of the mean, two and a half times. What is left is a range step of the two best radars, 30 and 60
/// m where a track is known to 70: of the first the bound itself is longer, of the second it is a third.
TEST(RadarFault, AStepOfTwoSigmaIsFlaggedWithinFortyPlots) {
  for (const int component : {0, 1}) {
    for (std::size_t radar = 0; radar < 3; ++radar) {
      const RadarTruth change = step(radar, component, 2.0);
      const double least = least_delay(radar, change);
      std::printf("two sigma of %s, at the least %.1f plots; ", component == 0 ? "range" : "azimuth", least);
      const Delays found = delays(radar, change, 40);
      if (least <= 8.0) {
        EXPECT_GE(found.in_time, statistics::binomial_band(found.runs, 0.995).low);
      }
      if (least <= 40.0) {
        const double chance = 1.0 + 4.9 * 0.37 / std::sqrt(found.runs);  // of the mean, once in 10^6
        EXPECT_LE(found.mean, chance * kTimesTheLeast * least);
        EXPECT_GE(2 * found.in_time, found.runs);
      } else {
        EXPECT_LE(2 * found.in_time, found.runs);
      }
      EXPECT_LE(found.blamed_others, statistics::binomial_band(found.runs, 0.01).high);
    }
  }
}

/// Of the best radar that is 75 m, where its tracks are believed known to 15: most runs lose tracks to it before any
/// detector could tell, and what is left is told late.
TEST(RadarFault, ARangeBiasOfFiveSigmaIsFlagged) {
  for (std::size_t radar = 0; radar < 3; ++radar) {
    const Delays found = delays(radar, step(radar, 0, 5.0), 20);
    if (radar == 0) {
      EXPECT_GE(found.flagged, found.runs / 2);
      continue;
    }
    EXPECT_GE(found.in_time, statistics::binomial_band(found.runs, 0.99).low);
    EXPECT_LE(found.blamed_others, statistics::binomial_band(found.runs, 0.05).high);
  }
}

/// P_d .9 to .27: a mean of 1.05 a look (1.70 a miss, -.69 a plot) with a spread of 1.06; over the 50 looks of the
/// fault 13.5 is missed by 5 standard deviations.
TEST(RadarFault, LostDetectionsAreFlagged) {
  RadarTruth blind;
  blind.detection_scale = 0.3;
  for (std::size_t radar = 0; radar < 3; ++radar) {
    const Delays loss = delays(radar, blind, 20);
    EXPECT_EQ(loss.flagged, loss.runs);
    EXPECT_EQ(loss.blamed_others, 0);
    EXPECT_EQ(loss.comes_back, loss.runs);
  }
}

/// Under one flag in 10^4 plots of a radar: of n plots, fewer than the Poisson count of that mean reaches by chance.
void expect_few_flags(EngineConfig config, const char* name) {
  const int runs = soaked(200, 20);
  std::array<int, 3> flags{};
  std::array<double, 3> plots{};
  for (int seed = 1; seed <= runs; ++seed) {
    config.seed = static_cast<std::uint64_t>(seed);
    std::array<bool, 3> was{};
    run_calibrated(config, 600, [&](const Engine& engine) {
      const LookReport& look = engine.last().looks.front();
      plots[look.dwell.radar.number - 1] += static_cast<double>(look.plots);
      for (std::size_t i = 0; i < 3; ++i) {
        const bool is = engine.calibrator().radar(i)->fault != Fault::kNone;
        flags[i] += is && !was[i];
        was[i] = is;
      }
    });
  }
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf("%s, radar %zu: %d false flags in %.0f plots\n", name, i + 1, flags[i], plots[i]);
    EXPECT_LE(flags[i], statistics::poisson_band(plots[i] / 1e4).high);
  }
}

TEST(RadarFault, GoodRadarsAreFlaggedLessThanOnceInTenThousandPlots) {
  expect_few_flags(traffic(kTurns), "calibration_traffic, round_robin");
  expect_few_flags(traffic(SaImmSettings{}), "calibration_traffic, sa_imm");
  EngineConfig recorded = traffic(SaImmSettings{});
  recorded.targets = scenario("recorded_flights", SaImmSettings{}).targets;
  expect_few_flags(recorded, "recorded_flights, sa_imm");
}

/// By track, over the scans of the fault.
struct Suffered {
  std::array<double, 3> squared_error{};
  std::array<bool, 3> hit{};   ///< looked at by the bad radar before it was flagged
  std::array<bool, 3> lost{};  ///< before the end
};

/// A run with the radar as `config` has it, or down, while the fault lasts.
Suffered suffer(const EngineConfig& config, bool down) {
  Suffered out;
  Engine engine(config);
  CalibrationLoop loop(engine);
  while (engine.last().scan < kTo) {
    if (down && engine.last().scan + 1 == kFrom) engine.set_sensor(kBad, false);
    (void)loop.before_scan();
    engine.scan();
    loop.after_scan();
    if (engine.last().scan < kFrom) continue;
    const LookReport& look = engine.last().looks.front();
    const bool flagged = engine.calibrator().radar(kBad)->fault != Fault::kNone;
    if (look.dwell.radar.number == kBad + 1 && !flagged) out.hit[look.dwell.track.number - 1] = true;
    const auto errors = squared_errors(engine);
    for (std::size_t i = 0; i < 3; ++i) out.squared_error[i] += errors[i].value_or(0.0);  // of lost ones not used
  }
  for (std::size_t i = 0; i < 3; ++i) {
    out.lost[i] = std::ranges::none_of(engine.tracks(),
                                       [&](const Track& track) { return track.id.number == i + 1 && track.alive(); });
  }
  return out;
}

/// R26. The tracks that the bad radar gets no look at between its fault and its flag, against the same run with the
/// radar down for that time: what is lost is the radar, and not more. The geometric mean of the pairs' ratios, so that
/// one track that goes astray in either does not decide; those that are lost or twice as far off are counted.
TEST(RadarFault, OtherTracksHardlySuffer) {
  const int runs = 200;  // fewer do not tell 1.05
  double log_ratios = 0.0;
  int tracks = 0;
  int worse = 0;
  int better = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    EngineConfig config = traffic(SaImmSettings{});
    config.seed = static_cast<std::uint64_t>(seed);
    const Suffered with = suffer(with_fault(config, kBad, azimuth_step(1.0)), false);
    const Suffered without = suffer(config, true);
    for (std::size_t i = 0; i < 3; ++i) {
      if (with.hit[i]) continue;
      const double ratio = std::sqrt(with.squared_error[i] / without.squared_error[i]);
      worse += with.lost[i] || (!without.lost[i] && ratio > 2.0);
      better += without.lost[i] || (!with.lost[i] && ratio < 0.5);
      if (with.lost[i] || without.lost[i]) continue;
      log_ratios += std::log(ratio);
      ++tracks;
    }
  }
  const double growth = std::exp(log_ratios / tracks);
  std::printf(
      "%d other tracks: RMS error with the lying radar %.4f of that with the radar down; lost or twice as far "
      "off with the one %d, with the other %d\n",
      tracks, growth, worse, better);
  EXPECT_LE(growth, 1.05);
  EXPECT_LE(worse, statistics::poisson_band(std::max(better, 1)).high);
}

}  // namespace
}  // namespace dwell::testing
