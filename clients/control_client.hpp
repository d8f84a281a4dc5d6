#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <zmq.hpp>

#include "dwell/v1/control.pb.h"

namespace dwell::client {

struct ControlOptions {
  std::string endpoint = "tcp://127.0.0.1:5557";
  std::chrono::milliseconds timeout{2000};  // of one try
  int tries = 3;
  std::string client = "dwellctl";  // who asks, for the daemon's record
};

/// No answer after the last try.
class NoAnswer : public std::runtime_error {
 public:
  explicit NoAnswer(const ControlOptions& options);
};

/// 128 random bits in hexadecimal.
std::string new_request_id();

/// "user@host", at most 64 printable ASCII characters.
std::string client_name();

/// Asks the daemon: a request goes out again with the SAME id while no answer comes (the Lazy Pirate of the
/// ZeroMQ guide, ch. 4). The daemon applies an id once, so asking twice is safe. One request at a time.
///
/// `ask` waits for the answer. For a loop that has more to wait for: `start`, then `advance` whenever
/// `socket` is readable or `deadline` has passed.
class ControlClient {
 public:
  using Clock = std::chrono::steady_clock;
  enum class State { kIdle, kWaiting, kAnswered, kNoAnswer };

  ControlClient(zmq::context_t& context, ControlOptions options);

  /// The id and the client's name are set here. Throws NoAnswer.
  v1::Reply ask(v1::Request request);

  void start(v1::Request request);
  State advance();

  State state() const { return state_; }
  Clock::time_point deadline() const { return deadline_; }
  const v1::Reply& reply() const { return reply_; }
  /// A null handle before the first request.
  void* socket() { return socket_.handle(); }
  const ControlOptions& options() const { return options_; }

 private:
  void send();
  bool receive();

  zmq::context_t& context_;
  ControlOptions options_;
  zmq::socket_t socket_;
  v1::Request request_;
  v1::Reply reply_;
  State state_ = State::kIdle;
  int tries_left_ = 0;
  Clock::time_point deadline_;
};

}  // namespace dwell::client
