#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <zmq.hpp>

#include "dwell/v1/stream.pb.h"

namespace dwell::client {

/// The socket: one subscription to everything, since the daemon counts subscriptions and only the whole
/// stream can be checked by `sequence`.
class StreamClient {
 public:
  StreamClient(zmq::context_t& context, const std::string& endpoint);

  /// The next message that has arrived; nothing where none has. What is no message of the stream is passed
  /// over: it leaves a hole in the sequence.
  std::optional<v1::Envelope> receive();

  void* socket() { return socket_.handle(); }

 private:
  zmq::socket_t socket_;
};

/// What was seen to go wrong since the start.
struct Losses {
  std::uint64_t holes = 0;
  std::uint64_t messages = 0;  // missing in the holes
  std::uint64_t restarts = 0;  // of the daemon
};

/// Puts a snapshot and the stream together without holes (the Clone pattern of the ZeroMQ guide, ch. 5).
///
/// Messages are held back while a snapshot is wanted: at the start, after a hole in the sequence, and when
/// the epoch changes. Those at or below the snapshot's sequence come out marked as contained in it. A hole
/// before the first message is no loss: the subscription began after the snapshot was taken, and a second one
/// closes it.
class Follower {
 public:
  struct Update {
    v1::Envelope envelope;
    bool in_snapshot;  // the last snapshot already holds it
  };

  void receive(v1::Envelope envelope) { held_.push_back(std::move(envelope)); }
  std::optional<Update> next();

  bool wants_snapshot() const { return wants_snapshot_; }
  void load_snapshot(std::uint64_t epoch, std::uint64_t sequence);
  /// No snapshot can be had: the stream alone then, until one comes.
  void go_on_without();

  const Losses& losses() const { return losses_; }

 private:
  void want_snapshot();
  void start_epoch(std::uint64_t epoch);

  std::deque<v1::Envelope> held_;
  bool wants_snapshot_ = true;
  bool holding_ = true;
  std::optional<std::uint64_t> epoch_;
  std::optional<std::uint64_t> snapshot_;  // its sequence; absent when going on without
  std::optional<std::uint64_t> expected_;  // sequence of the next message; absent before the first of an epoch
  Losses losses_;
};

}  // namespace dwell::client
