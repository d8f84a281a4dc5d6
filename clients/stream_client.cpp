#include "clients/stream_client.hpp"

#include <utility>

namespace dwell::client {

StreamClient::StreamClient(zmq::context_t& context, const std::string& endpoint)
    : socket_(context, zmq::socket_type::sub) {
  // As many as the daemon itself keeps by default: a pause of ours shall not be what makes a hole.
  constexpr int kHighWaterMark = 100'000;
  // Without heartbeats a peer that vanished behind a network is never noticed, and never connected to again.
  constexpr int kHeartbeatMs = 2000;
  constexpr int kHeartbeatTimeoutMs = 6000;
  socket_.set(zmq::sockopt::linger, 0);
  socket_.set(zmq::sockopt::rcvhwm, kHighWaterMark);
  socket_.set(zmq::sockopt::heartbeat_ivl, kHeartbeatMs);
  socket_.set(zmq::sockopt::heartbeat_timeout, kHeartbeatTimeoutMs);
  socket_.set(zmq::sockopt::subscribe, "");
  socket_.connect(endpoint);
}

std::optional<v1::Envelope> StreamClient::receive() {
  for (;;) {
    zmq::message_t frame;  // the topic first, then the envelope
    if (!socket_.recv(frame, zmq::recv_flags::dontwait)) return std::nullopt;
    int frames = 1;
    while (frame.more() && socket_.recv(frame, zmq::recv_flags::dontwait)) ++frames;
    v1::Envelope envelope;
    if (frames == 2 && envelope.ParseFromArray(frame.data(), static_cast<int>(frame.size()))) return envelope;
  }
}

std::optional<Follower::Update> Follower::next() {
  while (!holding_ && !held_.empty()) {
    const v1::Envelope& front = held_.front();
    if (!epoch_) epoch_ = front.epoch();
    if (front.epoch() != *epoch_) {
      start_epoch(front.epoch());
      want_snapshot();
      break;
    }
    if (expected_ && front.sequence() < *expected_) {
      held_.pop_front();
      continue;
    }
    if (expected_ && front.sequence() > *expected_) {
      ++losses_.holes;
      losses_.messages += front.sequence() - *expected_;
    }
    const bool joined = expected_ == front.sequence();
    expected_ = front.sequence();  // so that the same hole is counted, and asked for, once
    if (!joined && snapshot_ && front.sequence() > *snapshot_ + 1) {
      want_snapshot();
      break;
    }
    ++*expected_;
    Update update{std::move(held_.front()), snapshot_ && *expected_ <= *snapshot_ + 1};
    held_.pop_front();
    return update;
  }
  return std::nullopt;
}

void Follower::load_snapshot(std::uint64_t epoch, std::uint64_t sequence) {
  if (epoch_ && epoch != *epoch_) start_epoch(epoch);
  epoch_ = epoch;
  snapshot_ = sequence;
  wants_snapshot_ = false;
  holding_ = false;
  std::erase_if(held_, [&](const v1::Envelope& envelope) { return envelope.epoch() != epoch; });
}

void Follower::go_on_without() {
  if (!holding_) return;
  holding_ = false;
  snapshot_.reset();
}

void Follower::want_snapshot() {
  wants_snapshot_ = true;
  holding_ = true;
}

void Follower::start_epoch(std::uint64_t epoch) {
  ++losses_.restarts;
  epoch_ = epoch;
  expected_.reset();
  snapshot_.reset();
}

}  // namespace dwell::client
