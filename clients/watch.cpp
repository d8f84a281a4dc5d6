#include "clients/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include "clients/format.hpp"
#include "clients/picture.hpp"
#include "clients/stream_client.hpp"
#include "clients/terminal.hpp"
#include "clients/track_table.hpp"
#include "clients/watch_frame.hpp"

namespace dwell::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kRefresh{100};  // nobody reads faster
constexpr std::chrono::milliseconds kTick{500};     // so that "no data for N s" counts on

enum class View { kTable, kLines, kJson };

class Watch {
 public:
  Watch(zmq::context_t& context, const std::string& stream, const ControlOptions& control, View view)
      : view_(view), stream_endpoint_(stream), stream_(context, stream), control_(context, control) {
    if (view_ == View::kTable) screen_ = std::make_unique<Screen>();
  }

  int run();

 private:
  void wait();
  void on_signals();
  void on_stream();
  void on_control();
  void on_update(const Follower::Update& update);
  void head_lines();
  void finish(int exit_code, const std::string& why);
  void say(const std::string& what) { notes_ += "dwellctl: " + what + "\n"; }
  void tell_losses();
  void show();
  Supply supply() const;

  View view_;
  std::string stream_endpoint_;
  Signals signals_{SIGINT, SIGTERM, SIGWINCH, SIGTSTP};
  StreamClient stream_;
  ControlClient control_;
  Follower follower_;
  Picture picture_;
  std::unique_ptr<Screen> screen_;
  std::optional<int> exit_code_;

  bool received_ = false;          // a message of the stream
  bool loaded_ = false;            // a snapshot, at least once
  bool without_snapshot_ = false;  // the last attempt to get one failed
  bool dirty_ = true;
  bool silence_told_ = false;
  bool headed_ = false;  // lines have their header
  Losses losses_told_;
  std::string output_;  // for standard output, in the views that are not a table
  std::string notes_;   // for standard error
  Clock::time_point last_message_ = Clock::now();
  Clock::time_point last_draw_{};
};

int Watch::run() {
  while (!exit_code_) {
    if (follower_.wants_snapshot() && control_.state() != ControlClient::State::kWaiting) {
      v1::Request request;
      request.mutable_get_snapshot();
      control_.start(std::move(request));
    }
    show();
    wait();
    on_signals();
    on_stream();
    on_control();
    while (const auto update = follower_.next()) on_update(*update);
    tell_losses();
  }
  Page page = terminal_page();
  page.rows -= 2;  // for what is said below it, and the prompt
  const Lines last_frame = watch_frame(picture_, supply(), page);
  const bool keep = view_ == View::kTable && (loaded_ || received_);
  screen_.reset();
  // The alternate screen takes the table with it; what was last known is worth keeping.
  if (keep) {
    for (const Line& line : last_frame) output_ += paint(line, page.columns, wants_colour()) + "\n";
  }
  write_out(std::exchange(output_, {}));
  fmt::print(stderr, "{}", std::exchange(notes_, {}));
  return *exit_code_;
}

void Watch::wait() {
  std::array<zmq_pollitem_t, 4> items{{{stream_.socket(), 0, ZMQ_POLLIN, 0},
                                       {nullptr, signals_.descriptor(), ZMQ_POLLIN, 0},
                                       {nullptr, 0, 0, 0},
                                       {nullptr, 0, 0, 0}}};
  int count = 2;
  auto until = Clock::now() + (dirty_ && screen_ ? kRefresh : kTick);
  if (control_.state() == ControlClient::State::kWaiting) {
    items.at(count++) = {control_.socket(), 0, ZMQ_POLLIN, 0};
    until = std::min(until, control_.deadline());
  }
  if (screen_ && screen_->keyboard() >= 0) items.at(count++) = {nullptr, screen_->keyboard(), ZMQ_POLLIN, 0};
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
  if (zmq_poll(items.data(), count, std::max(left.count(), 0L)) < 0 && errno != EINTR) throw zmq::error_t();
}

void Watch::on_signals() {
  while (const auto signal = signals_.next()) {
    if (*signal == SIGWINCH) {
      last_draw_ = {};  // at once
      dirty_ = true;
    } else if (*signal == SIGTSTP) {
      if (screen_) {
        screen_->suspend();
      } else {
        raise(SIGSTOP);
      }
      last_draw_ = {};
      dirty_ = true;
    } else {
      finish(0, "");
    }
  }
  if (screen_ && screen_->quit_pressed()) finish(0, "");
}

void Watch::on_stream() {
  // A flood must not keep the table from being drawn, nor Ctrl-C from being seen.
  const auto until = Clock::now() + kRefresh;
  while (Clock::now() < until) {
    auto envelope = stream_.receive();
    if (!envelope) return;
    received_ = true;
    last_message_ = Clock::now();
    silence_told_ = false;
    if (view_ == View::kJson) output_ += json(*envelope) + "\n";
    const bool end = envelope->has_end_of_stream();
    follower_.receive(std::move(*envelope));
    if (end) {
      // Nobody is left to ask for a snapshot: what is held back comes out now, the end as its last.
      follower_.go_on_without();
      return;
    }
  }
}

void Watch::on_control() {
  const bool was_waiting = control_.state() == ControlClient::State::kWaiting;
  const auto state = control_.advance();
  if (!was_waiting || state == ControlClient::State::kWaiting) return;
  if (state == ControlClient::State::kAnswered && control_.reply().accepted().has_snapshot()) {
    const v1::Snapshot& snapshot = control_.reply().accepted().snapshot();
    if (!follower_.wants_snapshot()) return;
    loaded_ = true;
    without_snapshot_ = false;
    picture_.load(snapshot);
    head_lines();
    follower_.load_snapshot(snapshot.epoch(), snapshot.sequence());
    dirty_ = true;
    return;
  }
  if (!received_ && !loaded_ && !exit_code_) {
    const bool refused = state == ControlClient::State::kAnswered;
    return finish(1, refused ? "the daemon refuses a snapshot" : NoAnswer(control_.options()).what());
  }
  without_snapshot_ = true;
  head_lines();
  follower_.go_on_without();
}

/// The names of the columns, once it is known which there are.
void Watch::head_lines() {
  if (view_ == View::kLines && !std::exchange(headed_, true)) output_ += track_line_header(picture_.names()) + "\n";
}

void Watch::on_update(const Follower::Update& update) {
  const v1::Envelope& envelope = update.envelope;
  if (!update.in_snapshot) picture_.apply(envelope);
  dirty_ = true;
  if (view_ == View::kLines && envelope.has_track()) {
    output_ += track_line(envelope.track(), picture_.names(), envelope.time_ns()) + "\n";
  }
  if (envelope.has_end_of_stream()) {
    finish(0, fmt::format("the stream ended at scan {}, t {} s: {}", picture_.status().scan(),
                          fixed(static_cast<double>(envelope.time_ns()) / 1e9, 1),
                          printable(envelope.end_of_stream().reason())));
  }
}

void Watch::finish(int exit_code, const std::string& why) {
  if (!exit_code_) exit_code_ = exit_code;
  if (!why.empty()) say(why);
}

void Watch::tell_losses() {
  if (view_ == View::kTable) return;  // stands in its head
  const Losses& losses = follower_.losses();
  if (losses.messages > losses_told_.messages) {
    say(fmt::format("{} messages missed", losses.messages - losses_told_.messages));
  }
  if (losses.restarts > losses_told_.restarts) say("the daemon restarted");
  losses_told_ = losses;
  const Supply now = supply();
  if (now.silent_s > kSilenceSeconds && !silence_told_) {
    say(fmt::format("no data for {} s from {}", now.silent_s, now.stream));
    silence_told_ = true;
  }
}

Supply Watch::supply() const {
  const auto silent = std::chrono::floor<std::chrono::seconds>(Clock::now() - last_message_);
  // A fast run sends its status by stream time: while it is paused there is nothing to hear.
  const bool may_be_silent = picture_.status().run() == v1::Status::PAUSED && !picture_.status().has_wall_clock();
  return {.stream = stream_endpoint_,
          .control = control_.options().endpoint,
          .silent_s = may_be_silent ? 0 : silent.count(),
          .losses = follower_.losses(),
          .started = loaded_ || received_,
          .without_snapshot = without_snapshot_};
}

void Watch::show() {
  if (!screen_) {
    if (!output_.empty()) write_out(std::exchange(output_, {}));
    if (!notes_.empty()) fmt::print(stderr, "{}", std::exchange(notes_, {}));
    return;
  }
  const auto now = Clock::now();
  if (now - last_draw_ < (dirty_ ? kRefresh : kTick)) return;
  const Page page = terminal_page();
  screen_->draw(watch_frame(picture_, supply(), page), page, wants_colour());
  last_draw_ = now;
  dirty_ = false;
}

}  // namespace

int watch(zmq::context_t& context, const std::string& stream, const ControlOptions& control, bool json) {
  const View view = json ? View::kJson : is_terminal() ? View::kTable : View::kLines;
  return Watch(context, stream, control, view).run();
}

}  // namespace dwell::client
