#include "daemon/service.hpp"

#include <algorithm>
#include <array>
#include <csignal>

#include <spdlog/spdlog.h>

#include <sys/signalfd.h>
#include <unistd.h>

namespace dwell {
namespace {

using namespace std::chrono_literals;

constexpr auto kStatusPeriod = 1s;
constexpr std::size_t kDurations = 1000;
constexpr int kRequestsAtOnce = 64;  // then the clock is looked at again

float percentile(std::vector<float> values, double share) {
  if (values.empty()) return 0.0F;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

double seconds(std::chrono::steady_clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

}  // namespace

Service::Service(Run& run, Publisher& publisher, ControlSocket& control, int signals, const ServiceOptions& options)
    : run_(run),
      publisher_(publisher),
      control_(control),
      signals_(signals),
      options_(options),
      subscribers_came_(options.wait_subscribers == 0),
      started_(Clock::now()),
      next_scan_(started_),
      next_status_(started_) {
  durations_us_.reserve(kDurations);
  if (options_.replaying) run_.set_replaying(options_.late);
  if (options_.fast) return;
  run_.set_wall_clock([this] { return wall_clock(); });
  run_.set_real_time();
}

void Service::loop(const std::function<void(const Engine&)>& after_scan) {
  std::optional<std::string> reason;
  for (;;) {
    serve();
    if ((reason = reason_to_end())) break;
    if (ready_to_scan()) {
      scan();
      after_scan(run_.engine());
    }
    publish_status();
    wait();
  }
  spdlog::info("ending: {}", *reason);
  run_.publish_end(*reason);
}

/// Whether the next scan is due, and accounts for those that were missed.
bool Service::ready_to_scan() {
  if (!subscribers_came_) {
    subscribers_came_ = publisher_.subscriptions() >= options_.wait_subscribers;
    if (!subscribers_came_) return false;
  }
  const Clock::duration period = run_.engine().config().scan_period;
  const Clock::time_point now = Clock::now();
  const bool running = !run_.paused();
  if (running && !was_running_) next_scan_ = now + (run_.scans() == 0 ? Clock::duration::zero() : period);
  was_running_ = running;
  if (run_.steps() > 0) return true;
  if (!running) return false;
  if (options_.fast) return true;
  if (now < next_scan_) return false;
  const auto missed = (now - next_scan_) / period;
  missed_scans_ += static_cast<std::uint64_t>(missed);
  next_scan_ += (missed + 1) * period;
  return true;
}

void Service::scan() {
  apply_replay();
  const Clock::time_point before = Clock::now();
  run_.scan();
  const auto duration_us = static_cast<float>(1e6 * seconds(Clock::now() - before));
  if (durations_us_.size() < kDurations) durations_us_.push_back(duration_us);
  durations_us_[next_duration_] = duration_us;
  next_duration_ = (next_duration_ + 1) % kDurations;
}

void Service::apply_replay() {
  const auto& requests = options_.replay;
  for (; replayed_ < requests.size() && requests[replayed_].scan() <= run_.scans() + 1; ++replayed_) {
    if (!run_.replay(requests[replayed_].request())) {
      spdlog::warn("the journal's request {} was refused", requests[replayed_].request().id());
    }
  }
}

/// Every second: of stream time in a fast run, else of wall time, also while nothing is scanned.
void Service::publish_status() {
  if (options_.fast) {
    const TimePoint now = run_.engine().last().time;
    if (run_.scans() == 0 || now < next_stream_status_) return;
    while (next_stream_status_ <= now) next_stream_status_ += kStatusPeriod;
    run_.publish_status(nullptr);
  } else if (Clock::now() >= next_status_) {
    while (next_status_ <= Clock::now()) next_status_ += kStatusPeriod;
    const v1::WallClock figures = wall_clock();
    run_.publish_status(&figures);
  }
}

/// Until the next scan or status is due, or somebody wants something.
void Service::wait() {
  const bool scanning = subscribers_came_ && !run_.paused();
  if (subscribers_came_ && run_.steps() > 0) return;
  if (options_.fast && scanning) return;
  Clock::time_point until = options_.fast ? Clock::now() + kStatusPeriod : next_status_;
  if (scanning) until = std::min(until, next_scan_);
  // Rounded down, so that a scan is never late: the last fraction of a millisecond is spent asking again.
  const auto left = std::chrono::floor<std::chrono::milliseconds>(until - Clock::now());
  std::array<zmq::pollitem_t, 3> items{{{publisher_.socket().handle(), 0, ZMQ_POLLIN, 0},
                                        {control_.socket().handle(), 0, ZMQ_POLLIN, 0},
                                        {nullptr, signals_, ZMQ_POLLIN, 0}}};
  zmq::poll(items.data(), items.size(), std::max(left, 0ms));
}

void Service::serve() {
  publisher_.serve();
  control_.serve(kRequestsAtOnce, [this](std::string_view bytes) {
    v1::Request request;
    if (request.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
      return run_.handle(request).SerializeAsString();
    }
    ++malformed_;
    v1::Reply reply;
    v1::Refused& refused = *reply.mutable_refused();
    refused.set_reason(v1::Refused::MALFORMED);
    v1::Violation& violation = *refused.add_violation();
    violation.set_field("request");
    violation.set_rule("must be a dwell.v1.Request");
    return reply.SerializeAsString();
  });
}

std::optional<std::string> Service::reason_to_end() {
  signalfd_siginfo signal{};
  if (::read(signals_, &signal, sizeof signal) == sizeof signal) {
    return signal.ssi_signo == SIGINT ? "interrupted" : "terminated";
  }
  if (run_.stop_requested()) return run_.stop_reason();
  if (options_.scans && run_.scans() >= *options_.scans) {
    apply_replay();  // what was asked for after the last scan
    return options_.end_reason;
  }
  return std::nullopt;
}

v1::WallClock Service::wall_clock() const {
  v1::WallClock figures;
  figures.set_uptime_s(seconds(Clock::now() - started_));
  figures.set_scan_duration_p50_us(percentile(durations_us_, 0.50));
  figures.set_scan_duration_p99_us(percentile(durations_us_, 0.99));
  figures.set_missed_scans(missed_scans_);
  figures.set_subscriber_overflows(publisher_.overflows());
  figures.set_requests_refused(run_.requests_refused());
  figures.set_requests_unreadable(control_.unreadable() + malformed_);
  return figures;
}

}  // namespace dwell
