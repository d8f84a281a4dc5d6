// A holding pattern whose turns are entered and left by guards: scans with the wrong mode likeliest, of a filter that
// has the guards and of two that have a Markov chain instead, over the same plots. 900 scans are some 11 turns.

#include <algorithm>
#include <array>
#include <cstdio>

#include <gtest/gtest.h>

#include "daemon/study/monte_carlo.hpp"
#include "tests/scale.hpp"
#include "tests/scenarios/monte_carlo.hpp"

namespace dwell::testing {
namespace {

constexpr std::uint64_t kScans = 900;

double mode_errors(const EngineConfig& config) {
  const auto names = metric_names(config);
  const auto at = std::find(names.begin(), names.end(), "mode_errors") - names.begin();
  return run_and_measure(config, kScans, {}).figures[static_cast<std::size_t>(at)];
}

/// Runs of the guards, of a chain, and of both paired.
struct Compared {
  Estimate guards;
  Estimate chain;
  Estimate difference;
  double half;  // of the 95 % interval
};

Compared compare(const Eigen::Matrix2d& chain, int runs) {
  EngineConfig guarded = scenario("holding_pattern", FixedSettings{});
  EngineConfig markov = guarded;  // of the tracker; the truth keeps its guards
  markov.bank.guards.clear();
  markov.bank.transition = chain;
  std::vector<double> of_guards, of_chain, difference;
  for (int run = 1; run <= runs; ++run) {
    guarded.seed = markov.seed = static_cast<std::uint64_t>(run);
    of_guards.push_back(mode_errors(guarded));
    of_chain.push_back(mode_errors(markov));
    difference.push_back(of_chain.back() - of_guards.back());
  }
  Compared compared{estimate(of_guards), estimate(of_chain), estimate(difference), 0.0};
  compared.half = student_975(runs - 1) * compared.difference.standard_error;
  return compared;
}

// The chain of the truth's own mean stays, 100 s straight and 60 s in the turn, and one of 20 s each way.
TEST(HoldingPattern, GuardsMakeFewerModeErrorsThanMarkovChains) {
  const int runs = soaked(200, 10);
  const std::array chains{(Eigen::Matrix2d() << 0.99, 0.01, 1.0 / 60.0, 59.0 / 60.0).finished(),
                          (Eigen::Matrix2d() << 0.95, 0.05, 0.05, 0.95).finished()};
  for (const Eigen::Matrix2d& chain : chains) {
    const Compared c = compare(chain, runs);
    std::printf(
        "stays of %.0f and %.0f s: mode errors of %d runs, guards %.1f (%.1f), chain %.1f (%.1f), more by %.1f "
        "[%.1f, %.1f]\n",
        1.0 / chain(0, 1), 1.0 / chain(1, 0), runs, c.guards.mean, c.guards.standard_error, c.chain.mean,
        c.chain.standard_error, c.difference.mean, c.difference.mean - c.half, c.difference.mean + c.half);
    EXPECT_GT(c.difference.mean - c.half, 0.0);
    EXPECT_LT(c.guards.mean, 0.5 * c.chain.mean);
  }
}

}  // namespace
}  // namespace dwell::testing
