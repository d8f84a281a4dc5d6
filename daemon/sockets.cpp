#include "daemon/sockets.hpp"

#include <stdexcept>
#include <vector>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <zmq_addon.hpp>

namespace dwell {
namespace {

// Chosen against libzmq's defaults: wait for ever on exit, 30 s for a handshake, dead peers unseen, no size limit.
constexpr int kLinger_ms = 1000;  // the end of the stream goes out; SIGTERM still ends within 2 s
constexpr int kHandshake_ms = 2000;
constexpr int kHeartbeat_ms = 2000;
constexpr int kHeartbeatTimeout_ms = 6000;
constexpr std::int64_t kLargestSubscription = 1024;
constexpr std::int64_t kLargestRequest = 64 * 1024;

void prepare(zmq::socket_t& socket, std::int64_t largest_message) {
  socket.set(zmq::sockopt::linger, kLinger_ms);
  socket.set(zmq::sockopt::handshake_ivl, kHandshake_ms);
  socket.set(zmq::sockopt::heartbeat_ivl, kHeartbeat_ms);
  socket.set(zmq::sockopt::heartbeat_timeout, kHeartbeatTimeout_ms);
  socket.set(zmq::sockopt::tcp_keepalive, 1);
  socket.set(zmq::sockopt::maxmsgsize, largest_message);
}

struct InUse : zmq::error_t {
  InUse() : zmq::error_t(EADDRINUSE) {}
};

/// Whether somebody listens on a path. libzmq would unlink the socket file of a living process and bind its own.
bool somebody_listens(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return false;  // bind says what is wrong
  path.copy(address.sun_path, path.size());
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool connected = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(probe);
  return connected;
}

void bind(zmq::socket_t& socket, const char* what, const std::string& endpoint) {
  constexpr std::string_view kIpc = "ipc://";
  try {
    if (endpoint.starts_with(kIpc) && somebody_listens(endpoint.substr(kIpc.size()))) throw InUse();
    socket.bind(endpoint);
  } catch (const zmq::error_t& error) {
    throw std::runtime_error(std::string("cannot bind ") + what + " to " + endpoint + ": " + error.what() +
                             (error.num() == EADDRINUSE ? " (is another dwelld running?)" : ""));
  }
}

}  // namespace

Publisher::Publisher(zmq::context_t& context, const std::string& endpoint, int high_water_mark)
    : socket_(context, zmq::socket_type::xpub) {
  prepare(socket_, kLargestSubscription);
  socket_.set(zmq::sockopt::sndhwm, high_water_mark);
  socket_.set(zmq::sockopt::xpub_verboser, 1);  // every subscription, not only the first of a topic
  socket_.set(zmq::sockopt::xpub_nodrop, 1);    // so that `send` sees a full queue; see there
  bind(socket_, "the stream", endpoint);
}

/// With NODROP a send to a full queue is refused before anything went out. Then it is counted, and sent without
/// NODROP: to all but the stalled subscriber.
void Publisher::send(std::string_view topic, std::string_view envelope) {
  const auto both = [&] {
    const auto sent = socket_.send(zmq::buffer(topic), zmq::send_flags::sndmore | zmq::send_flags::dontwait);
    return sent && socket_.send(zmq::buffer(envelope), zmq::send_flags::dontwait);
  };
  if (both()) return;
  ++overflows_;
  socket_.set(zmq::sockopt::xpub_nodrop, 0);
  (void)both();  // cannot be refused without NODROP
  socket_.set(zmq::sockopt::xpub_nodrop, 1);
}

void Publisher::serve() {
  zmq::message_t message;
  while (socket_.recv(message, zmq::recv_flags::dontwait)) {
    if (message.size() == 0) continue;
    const char first = *message.data<char>();
    if (first == 1) ++subscriptions_;
    if (first == 0 && subscriptions_ > 0) --subscriptions_;
  }
}

ControlSocket::ControlSocket(zmq::context_t& context, const std::string& endpoint)
    : socket_(context, zmq::socket_type::router) {
  prepare(socket_, kLargestRequest);
  bind(socket_, "the control port", endpoint);
}

void ControlSocket::serve(int most, const std::function<std::string(std::string_view)>& handle) {
  for (int i = 0; i < most; ++i) {
    std::vector<zmq::message_t> frames;
    if (!zmq::recv_multipart(socket_, std::back_inserter(frames), zmq::recv_flags::dontwait)) return;
    // identity, request; or identity, empty delimiter, request
    const bool delimited = frames.size() == 3 && frames[1].size() == 0;
    if (frames.size() != 2 && !delimited) {
      ++unreadable_;
      continue;
    }
    const std::string reply = handle(frames.back().to_string_view());
    frames.back().rebuild(reply.data(), reply.size());
    (void)zmq::send_multipart(socket_, frames, zmq::send_flags::dontwait);  // a client that left gets nothing
  }
}

}  // namespace dwell
