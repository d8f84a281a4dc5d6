#include "daemon/calibration_loop.hpp"

#include "radar/assert.hpp"

namespace dwell {

CalibrationLoop::~CalibrationLoop() {
  // Seen at the solver's next evaluation, some hundredths of a second away; the future's end waits for it.
  stop_ = true;
}

bool CalibrationLoop::ready() const { return running_.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }

std::optional<std::uint64_t> CalibrationLoop::due() const {
  if (!asked_scan_) return std::nullopt;
  return *asked_scan_ + static_cast<std::uint64_t>(engine_.calibrator().settings().delay_scans);
}

CalibrationLoop::Event CalibrationLoop::before_scan(bool late) {
  if (!asked_scan_ || engine_.last().scan + 1 < *due()) return Event::kNone;
  const bool begun = *asked_scan_ == task_.scan;
  asked_scan_.reset();
  if (late || !begun || (!waits_ && !ready())) {
    stop_ = true;
    engine_.give_up_calibration();
    return Event::kGivenUp;
  }
  engine_.finish_calibration(task_, running_.get());
  return Event::kFinished;
}

void CalibrationLoop::after_scan() {
  const Calibrator& calibrator = engine_.calibrator();
  const auto period = static_cast<std::uint64_t>(calibrator.settings().period_scans);
  const std::uint64_t scan = engine_.last().scan;
  const bool early = scan == period / 4 || scan == period / 2;
  if (calibrator.on() && !asked_scan_ && (early || scan % period == 0)) ask(false);
}

void CalibrationLoop::ask(bool joint) {
  DWELL_ASSERT(engine_.calibrator().on() && !asked_scan_);
  asked_scan_ = engine_.last().scan;
  // A solve that was given up may take a moment to see it; what is asked meanwhile is given up when it is due.
  if (running_.valid() && !waits_ && !ready()) return;
  if (running_.valid()) running_.wait();
  stop_ = false;
  task_ = engine_.calibrator().task(*asked_scan_, joint);
  running_ = std::async(std::launch::async, [this] {
    EstimatorSettings settings;
    settings.stop = [this] { return stop_.load(); };
    return solve_(task_, settings);
  });
}

}  // namespace dwell
