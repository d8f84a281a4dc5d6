#include <gmock/gmock.h>

#include <chrono>
#include <string>

#include "clients/control_client.hpp"
#include "tests/clients/fake_daemon.hpp"

namespace dwell::client {
namespace {

constexpr const char* kEndpoint = "inproc://control";
// A try that is meant to fail takes this long; one that is meant to succeed never waits for it.
constexpr std::chrono::milliseconds kShortTry{250};

v1::Request pause() {
  v1::Request request;
  request.mutable_pause();
  return request;
}

class ControlClientTest : public testing::Test {
 protected:
  zmq::context_t context_;
  ControlOptions patient_{.endpoint = kEndpoint, .timeout = std::chrono::milliseconds(kPatienceMs)};
  ControlOptions impatient_{.endpoint = kEndpoint, .timeout = kShortTry};
};

TEST_F(ControlClientTest, ReturnsTheAnswer) {
  FakeControl daemon(context_, kEndpoint, 1, [](const auto& request, int) { return accepted(request, 42); });
  patient_.client = "who";
  EXPECT_EQ(ControlClient(context_, patient_).ask(pause()).accepted().effective_scan(), 42u);
  EXPECT_TRUE(daemon.requests()[0].has_pause());
  EXPECT_EQ(daemon.requests()[0].client(), "who");
}

TEST_F(ControlClientTest, EachRequestHasAnIdOfItsOwn) {
  FakeControl daemon(context_, kEndpoint, 2, [](const auto& request, int) { return accepted(request, 1); });
  ControlClient client(context_, patient_);
  client.ask(pause());
  client.ask(pause());
  EXPECT_THAT(daemon.requests()[0].id(), testing::MatchesRegex("[0-9a-f]{32}"));
  EXPECT_NE(daemon.requests()[0].id(), daemon.requests()[1].id());
}

TEST_F(ControlClientTest, AsksAgainWithTheSameIdOnANewSocket) {
  FakeControl daemon(context_, kEndpoint, 2, [](const auto& request, int number) -> std::optional<v1::Reply> {
    if (number == 0) return std::nullopt;
    return accepted(request, 7);
  });
  // Time enough for the second try on a busy machine; the first is lost in any case.
  impatient_.tries = 100;
  EXPECT_EQ(ControlClient(context_, impatient_).ask(pause()).accepted().effective_scan(), 7u);
  EXPECT_EQ(daemon.requests()[0].SerializeAsString(), daemon.requests()[1].SerializeAsString());
  EXPECT_EQ(daemon.peers(), 2u);
}

TEST_F(ControlClientTest, GivesUpAfterTheLastTryAndSaysWhere) {
  FakeControl daemon(context_, kEndpoint, 3, [](const auto&, int) { return std::nullopt; });
  ControlClient client(context_, impatient_);
  try {
    client.ask(pause());
    FAIL() << "an answer from nobody";
  } catch (const NoAnswer& error) {
    EXPECT_STREQ(error.what(), "no answer from inproc://control (3 tries of 0.25 s): is dwelld running there?");
  }
  EXPECT_EQ(client.state(), ControlClient::State::kNoAnswer);
  EXPECT_EQ(daemon.requests().size(), 3u);
}

TEST_F(ControlClientTest, GivesUpWhereNobodyIsBound) {
  impatient_.endpoint = "ipc://" + testing::TempDir() + "nobody_is_here";
  EXPECT_THROW(ControlClient(context_, impatient_).ask(pause()), NoAnswer);
}

TEST_F(ControlClientTest, PassesOnARefusal) {
  FakeControl daemon(context_, kEndpoint, 1, [](const v1::Request& request, int) {
    v1::Reply reply;
    reply.set_id(request.id());
    reply.mutable_refused()->set_reason(v1::Refused::NOT_NOW);
    return reply;
  });
  EXPECT_EQ(ControlClient(context_, patient_).ask(pause()).refused().reason(), v1::Refused::NOT_NOW);
}

TEST_F(ControlClientTest, TakesARefusalWithoutAnIdAsItsOwn) {
  FakeControl daemon(context_, kEndpoint, 1, [](const v1::Request&, int) {
    v1::Reply reply;
    reply.mutable_refused()->set_reason(v1::Refused::MALFORMED);
    return reply;
  });
  EXPECT_EQ(ControlClient(context_, patient_).ask(pause()).refused().reason(), v1::Refused::MALFORMED);
}

TEST_F(ControlClientTest, PassesOverGarbageOtherIdsAndADelimiter) {
  zmq::socket_t router(context_, zmq::socket_type::router);
  router.set(zmq::sockopt::linger, 0);
  router.bind(kEndpoint);
  ControlClient client(context_, patient_);
  client.start(pause());
  zmq::message_t peer;
  zmq::message_t body;
  ASSERT_TRUE(router.recv(peer) && router.recv(body));
  v1::Request request;
  ASSERT_TRUE(request.ParseFromArray(body.data(), static_cast<int>(body.size())));

  const auto send = [&](const std::string& bytes) {
    router.send(zmq::buffer(peer.to_string()), zmq::send_flags::sndmore);
    router.send(zmq::str_buffer(""), zmq::send_flags::sndmore);
    router.send(zmq::buffer(bytes));
  };
  v1::Request other;
  other.set_id("another");
  send("\xff garbage");
  send(accepted(other, 1).SerializeAsString());
  send(accepted(request, 42).SerializeAsString());
  while (client.advance() == ControlClient::State::kWaiting) {
    zmq_pollitem_t item{client.socket(), 0, ZMQ_POLLIN, 0};
    ASSERT_EQ(zmq_poll(&item, 1, kPatienceMs), 1);
  }
  EXPECT_EQ(client.reply().accepted().effective_scan(), 42u);
}

TEST(ClientName, IsPrintableAndFits) { EXPECT_THAT(client_name(), testing::MatchesRegex("[!-~]{1,64}")); }

}  // namespace
}  // namespace dwell::client
