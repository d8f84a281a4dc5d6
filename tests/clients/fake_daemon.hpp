#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>
#include <zmq.hpp>

#include "dwell/v1/control.pb.h"

namespace dwell::client {

/// Waits for a message at most this long, so that a test that goes wrong fails and does not hang.
inline constexpr int kPatienceMs = 10'000;

/// The control end of a daemon: a ROUTER that serves a known number of requests in a thread of its own.
class FakeControl {
 public:
  /// Called with each request and its number, from 0; nothing is sent where it returns nothing.
  using Answer = std::function<std::optional<v1::Reply>(const v1::Request&, int)>;

  FakeControl(zmq::context_t& context, const std::string& endpoint, int requests, Answer answer)
      : socket_(context, zmq::socket_type::router) {
    socket_.set(zmq::sockopt::linger, 0);
    socket_.set(zmq::sockopt::rcvtimeo, kPatienceMs);
    socket_.bind(endpoint);
    thread_ = std::jthread([this, requests, answer = std::move(answer)] {
      for (int i = 0; i < requests; ++i) {
        if (!serve(answer, i)) return;
      }
    });
  }

  /// The requests served, in order; waits for the last.
  const std::vector<v1::Request>& requests() {
    if (thread_.joinable()) thread_.join();
    return requests_;
  }

  /// How many different peers sent them.
  std::size_t peers() {
    requests();
    return peers_.size();
  }

 private:
  bool serve(const Answer& answer, int number) {
    zmq::message_t peer;
    zmq::message_t body;
    if (!socket_.recv(peer) || !socket_.recv(body)) return false;
    peers_.insert(peer.to_string());
    v1::Request request;
    if (!request.ParseFromArray(body.data(), static_cast<int>(body.size()))) return false;
    requests_.push_back(request);
    if (const auto reply = answer(request, number)) {
      socket_.send(peer, zmq::send_flags::sndmore);
      socket_.send(zmq::buffer(reply->SerializeAsString()));
    }
    return true;
  }

  zmq::socket_t socket_;
  std::vector<v1::Request> requests_;
  std::set<std::string> peers_;
  std::jthread thread_;
};

inline v1::Reply accepted(const v1::Request& request, std::uint64_t scan) {
  v1::Reply reply;
  reply.set_id(request.id());
  reply.mutable_accepted()->set_effective_scan(scan);
  return reply;
}

inline v1::Track track(std::uint32_t id, const std::string& name) {
  v1::Track track;
  track.set_id(id);
  track.set_name(name);
  track.set_status(v1::Track::CONFIRMED);
  for (const double value : {120e3, 300.0, -40e3, 400.0}) track.add_state(value);
  for (const double value : {2500.0, 0.0, 0.0, 0.0, 100.0, 0.0, 0.0, 900.0, 0.0, 100.0}) track.add_covariance(value);
  for (const double value : {0.9, 0.08, 0.02}) track.add_mode_probability(value);
  return track;
}

/// A daemon with three radars, the third a linear sensor without a place; radar 2 is down.
inline v1::Snapshot snapshot(int tracks) {
  v1::Snapshot snapshot;
  snapshot.set_epoch(1);
  snapshot.set_sequence(100);
  snapshot.set_time_ns(12'000'000'000);
  snapshot.set_scan_period_s(1);
  for (const char* name : {"cruise", "slow_turn", "hard_turn"}) snapshot.add_mode_name(name);
  for (const char* name : {"west", "east", "linear"}) {
    v1::RadarState& radar = *snapshot.add_radar();
    radar.set_number(static_cast<std::uint32_t>(snapshot.radar_size()));
    radar.set_name(name);
    radar.set_up(radar.number() != 2);
  }
  v1::Status& status = *snapshot.mutable_status();
  status.set_run(v1::Status::RUNNING);
  status.set_scan(12);
  status.set_policy("sa_imm:cost=x");
  status.set_radars(3);
  status.set_radars_up(2);
  status.set_tracks_confirmed(static_cast<std::uint32_t>(tracks));
  for (int i = 1; i <= tracks; ++i) {
    *snapshot.add_track() = track(static_cast<std::uint32_t>(i), fmt::format("target{}", i));
  }
  return snapshot;
}

}  // namespace dwell::client
