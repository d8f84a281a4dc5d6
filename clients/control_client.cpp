#include "clients/control_client.hpp"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <random>
#include <utility>
#include <vector>

namespace dwell::client {

NoAnswer::NoAnswer(const ControlOptions& options)
    : std::runtime_error(fmt::format("no answer from {} ({} tries of {} s): is dwelld running there?", options.endpoint,
                                     options.tries, std::chrono::duration<double>(options.timeout).count())) {}

std::string new_request_id() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}{:08x}{:08x}", random(), random(), random(), random());
}

std::string client_name() {
  constexpr std::size_t kLongest = 64;  // Request.client
  std::array<char, 256> host{};
  const passwd* user = getpwuid(geteuid());
  if (user == nullptr || gethostname(host.data(), host.size() - 1) != 0) return "dwellctl";
  std::string name = fmt::format("{}@{}", user->pw_name, host.data()).substr(0, kLongest);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c <= ' ' || c > '~'; }, '?');
  return name;
}

ControlClient::ControlClient(zmq::context_t& context, ControlOptions options)
    : context_(context), options_(std::move(options)) {}

v1::Reply ControlClient::ask(v1::Request request) {
  start(std::move(request));
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline_ - Clock::now());
    zmq_pollitem_t item{socket(), 0, ZMQ_POLLIN, 0};
    // EINTR comes when the terminal stops and continues us; `advance` sees that nothing has arrived.
    if (zmq_poll(&item, 1, std::max(left.count(), 0L)) < 0 && errno != EINTR) throw zmq::error_t();
    switch (advance()) {
      case State::kAnswered:
        return reply_;
      case State::kNoAnswer:
        throw NoAnswer(options_);
      default:
        break;
    }
  }
}

void ControlClient::start(v1::Request request) {
  request_ = std::move(request);
  request_.set_id(new_request_id());
  request_.set_client(options_.client);
  tries_left_ = options_.tries;
  state_ = State::kWaiting;
  send();
}

ControlClient::State ControlClient::advance() {
  if (state_ != State::kWaiting) return state_;
  if (receive()) {
    state_ = State::kAnswered;
  } else if (Clock::now() >= deadline_) {
    if (tries_left_ > 0) {
      send();
    } else {
      state_ = State::kNoAnswer;
      socket_.close();
    }
  }
  return state_;
}

void ControlClient::send() {
  // A new socket for each try: what the old one still holds for a daemon that is gone is never sent.
  socket_ = zmq::socket_t(context_, zmq::socket_type::dealer);
  socket_.set(zmq::sockopt::linger, 0);
  socket_.connect(options_.endpoint);
  const std::string bytes = request_.SerializeAsString();
  // A fresh socket has room for its first message whether or not anybody is there.
  socket_.send(zmq::buffer(bytes), zmq::send_flags::dontwait);
  --tries_left_;
  deadline_ = Clock::now() + options_.timeout;
}

bool ControlClient::receive() {
  for (;;) {
    zmq::message_t frame;
    if (!socket_.recv(frame, zmq::recv_flags::dontwait)) return false;
    while (frame.more() && socket_.recv(frame, zmq::recv_flags::dontwait)) {
    }  // the answer is the last frame, behind a delimiter if there is one
    v1::Reply reply;
    if (!reply.ParseFromArray(frame.data(), static_cast<int>(frame.size()))) continue;
    // A daemon that could not read the request cannot know its id.
    const bool nameless = reply.id().empty() && reply.has_refused();
    if (reply.id() != request_.id() && !nameless) continue;
    reply_ = std::move(reply);
    return true;
  }
}

}  // namespace dwell::client
