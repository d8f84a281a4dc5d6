#include "radar/calibration/bias_detector.hpp"

#include <algorithm>
#include <cmath>

#include "radar/calibration/fault_detector.hpp"

namespace dwell {
namespace {

constexpr double kSteps[] = {2.0, 5.0};  // sigma

}  // namespace

BiasDetector::BiasDetector(std::size_t radars, std::size_t tracks)
    : flag_(kFlag + std::log(static_cast<double>(std::max<std::size_t>(radars, 1) * std::size(kSteps)))) {
  for (std::size_t radar = 0; radar < radars; ++radar) {
    for (int k = 0; k < 2; ++k) {
      for (const double step : kSteps) {
        for (const double sign : {1.0, -1.0}) hypotheses_.push_back({radar, sign * step * Vector2::Unit(k)});
      }
    }
  }
  tracks_.assign(tracks, {0, 0, std::vector<State>(hypotheses_.size(), State::Zero())});
}

/// Of a track; if it is new, in a free place or that of one that has not been looked at for long.
BiasDetector::TrackShifts& BiasDetector::shifts_of(const BiasLook& look, std::size_t longest_gap) {
  const auto known = std::ranges::find(tracks_, look.track, &TrackShifts::track);
  if (known != tracks_.end()) return *known;
  const auto old = std::ranges::find_if(
      tracks_, [&](const TrackShifts& shifts) { return shifts.track == 0 || look.scan - shifts.scan > longest_gap; });
  if (old == tracks_.end()) {
    return tracks_.emplace_back(look.track, look.scan, std::vector<State>(hypotheses_.size(), State::Zero()));
  }
  old->track = look.track;
  return *old;
}

std::optional<std::size_t> BiasDetector::add(const MotionPrior& motion, const BiasLook& look,
                                             const PlotDensity* evidence) {
  TrackShifts& shifts = shifts_of(look, motion.steps.size() - 1);
  const std::uint64_t gap = look.scan - shifts.scan;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    Hypothesis& hypothesis = hypotheses_[i];
    State& m = shifts.m[i];
    const bool moved = shifts.scan >= hypothesis.since && gap < motion.steps.size();
    m = moved ? State(motion.steps[gap].f[0] * m) : State::Zero();
    const bool own = hypothesis.radar == look.radar;
    if (!own && !moved) continue;
    Vector2 d = -look.h * m;
    if (own) d += hypothesis.direction.cwiseProduct(look.sigma);
    m += look.gain * d;
    if (evidence == nullptr) continue;
    hypothesis.sum += std::min(evidence->log_shift_ratio(d), kMostOfAPlot);
    if (hypothesis.sum >= 0.0) continue;
    hypothesis.sum = 0.0;
    hypothesis.since = look.scan + 1;
  }
  shifts.scan = look.scan;
  const auto most = std::ranges::max_element(hypotheses_, {}, &Hypothesis::sum);
  if (most == hypotheses_.end() || most->sum <= flag_) return std::nullopt;
  const std::size_t radar = most->radar;
  restart(look.scan);
  return radar;
}

void BiasDetector::restart(std::uint64_t scan) {
  for (Hypothesis& hypothesis : hypotheses_) {
    hypothesis.sum = 0.0;
    hypothesis.since = scan + 1;
  }
}

}  // namespace dwell
