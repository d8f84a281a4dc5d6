#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include <zmq.hpp>

#include "daemon/stream.hpp"

namespace dwell {

/// The XPUB socket of the stream. A subscriber that stalls loses messages and nobody waits for it.
class Publisher final : public Sink {
 public:
  /// Binds. Errors: std::runtime_error naming the endpoint.
  Publisher(zmq::context_t& context, const std::string& endpoint, int high_water_mark);

  void send(std::string_view topic, std::string_view envelope) override;

  /// Takes in what subscribers said. Each SUB counts once for each topic that it subscribes to.
  void serve();
  int subscriptions() const { return subscriptions_; }
  /// Times that a subscriber's queue was found full.
  std::uint64_t overflows() const { return overflows_; }

  zmq::socket_ref socket() { return socket_; }
  std::string endpoint() const { return socket_.get(zmq::sockopt::last_endpoint); }

 private:
  zmq::socket_t socket_;
  int subscriptions_ = 0;
  std::uint64_t overflows_ = 0;
};

/// The ROUTER socket of the control port: frames in, frames out; garbage is counted and dropped.
class ControlSocket {
 public:
  ControlSocket(zmq::context_t& context, const std::string& endpoint);

  /// Answers at most `most` waiting requests with `handle` (bytes of a Request to bytes of a Reply).
  void serve(int most, const std::function<std::string(std::string_view)>& handle);
  /// Messages with frames that no client of ours sends.
  std::uint64_t unreadable() const { return unreadable_; }

  zmq::socket_ref socket() { return socket_; }
  std::string endpoint() const { return socket_.get(zmq::sockopt::last_endpoint); }

 private:
  zmq::socket_t socket_;
  std::uint64_t unreadable_ = 0;
};

}  // namespace dwell
