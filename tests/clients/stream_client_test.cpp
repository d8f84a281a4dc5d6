#include <gmock/gmock.h>

#include <random>
#include <string>
#include <vector>

#include "clients/stream_client.hpp"
#include "tests/clients/fake_daemon.hpp"

namespace dwell::client {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

v1::Envelope envelope(std::uint64_t epoch, std::uint64_t sequence) {
  v1::Envelope envelope;
  envelope.set_epoch(epoch);
  envelope.set_sequence(sequence);
  envelope.mutable_status();
  return envelope;
}

void receive(Follower& follower, std::uint64_t epoch, const std::vector<std::uint64_t>& sequences) {
  for (const std::uint64_t sequence : sequences) follower.receive(envelope(epoch, sequence));
}

/// The sequences of the updates that come out now, of those that the snapshot does not hold.
std::vector<std::uint64_t> updates(Follower& follower) {
  std::vector<std::uint64_t> sequences;
  while (const auto update = follower.next()) {
    if (!update->in_snapshot) sequences.push_back(update->envelope.sequence());
  }
  return sequences;
}

TEST(Follower, HoldsMessagesBackUntilTheSnapshotIsThere) {
  Follower follower;
  receive(follower, 1, {4, 5, 6, 7});
  EXPECT_TRUE(follower.wants_snapshot());
  EXPECT_THAT(updates(follower), IsEmpty());
  follower.load_snapshot(1, 5);
  EXPECT_FALSE(follower.wants_snapshot());
  EXPECT_THAT(updates(follower), ElementsAre(6, 7));
}

TEST(Follower, MarksWhatTheSnapshotHoldsButPassesItOn) {
  Follower follower;
  receive(follower, 1, {4, 5, 6});
  follower.load_snapshot(1, 5);
  EXPECT_TRUE(follower.next()->in_snapshot);   // 4
  EXPECT_TRUE(follower.next()->in_snapshot);   // 5
  EXPECT_FALSE(follower.next()->in_snapshot);  // 6
}

TEST(Follower, AsksOnceMoreWhereTheSubscriptionBeganTooLate) {
  Follower follower;
  follower.load_snapshot(1, 5);
  receive(follower, 1, {8, 9});
  EXPECT_THAT(updates(follower), IsEmpty());
  EXPECT_TRUE(follower.wants_snapshot());
  follower.load_snapshot(1, 8);
  EXPECT_THAT(updates(follower), ElementsAre(9));
  EXPECT_EQ(follower.losses().holes, 0u);  // nothing was lost: the listener came late
}

TEST(Follower, CountsAHoleAndWantsASnapshot) {
  Follower follower;
  follower.load_snapshot(1, 5);
  receive(follower, 1, {6, 7, 11, 12});
  EXPECT_THAT(updates(follower), ElementsAre(6, 7));
  EXPECT_TRUE(follower.wants_snapshot());
  EXPECT_EQ(follower.losses().holes, 1u);
  EXPECT_EQ(follower.losses().messages, 3u);
  follower.load_snapshot(1, 11);
  EXPECT_THAT(updates(follower), ElementsAre(12));
  EXPECT_EQ(follower.losses().holes, 1u);
}

TEST(Follower, ASnapshotOlderThanTheHoleDoesNotMakeItAskForEver) {
  Follower follower;
  follower.load_snapshot(1, 5);
  receive(follower, 1, {6, 9});
  EXPECT_THAT(updates(follower), ElementsAre(6));
  follower.load_snapshot(1, 7);
  EXPECT_THAT(updates(follower), ElementsAre(9));
  EXPECT_FALSE(follower.wants_snapshot());
}

TEST(Follower, PassesOverWhatComesTwice) {
  Follower follower;
  follower.load_snapshot(1, 5);
  receive(follower, 1, {6, 6, 7, 6, 8});
  EXPECT_THAT(updates(follower), ElementsAre(6, 7, 8));
  EXPECT_EQ(follower.losses().holes, 0u);
}

TEST(Follower, ANewEpochIsARestartAndNoHole) {
  Follower follower;
  follower.load_snapshot(1, 5);
  receive(follower, 1, {6});
  receive(follower, 2, {1, 2});
  EXPECT_THAT(updates(follower), ElementsAre(6));
  EXPECT_TRUE(follower.wants_snapshot());
  EXPECT_EQ(follower.losses().restarts, 1u);
  follower.load_snapshot(2, 1);
  EXPECT_THAT(updates(follower), ElementsAre(2));
  EXPECT_EQ(follower.losses().restarts, 1u);
  EXPECT_EQ(follower.losses().holes, 0u);
}

TEST(Follower, ASnapshotOfANewEpochDropsWhatWasHeldOfTheOld) {
  Follower follower;
  follower.load_snapshot(1, 5);
  receive(follower, 1, {6, 9});
  EXPECT_THAT(updates(follower), ElementsAre(6));
  follower.load_snapshot(2, 3);
  EXPECT_THAT(updates(follower), IsEmpty());
  receive(follower, 2, {4});
  EXPECT_THAT(updates(follower), ElementsAre(4));
  EXPECT_EQ(follower.losses().restarts, 1u);
}

TEST(Follower, GoesOnWithTheStreamAloneAndTakesASnapshotLater) {
  Follower follower;
  receive(follower, 1, {4, 5, 7});
  follower.go_on_without();
  EXPECT_THAT(updates(follower), ElementsAre(4, 5, 7));
  EXPECT_EQ(follower.losses().messages, 1u);
  EXPECT_TRUE(follower.wants_snapshot());
  receive(follower, 1, {8});
  EXPECT_THAT(updates(follower), ElementsAre(8));
  follower.load_snapshot(1, 8);
  receive(follower, 1, {9});
  EXPECT_THAT(updates(follower), ElementsAre(9));
}

// The law: what comes out is in order, each once, and with what is counted as lost it is everything since the
// first.
TEST(Follower, LosesNothingUnseen) {
  std::mt19937_64 random(1);
  for (int run = 0; run < 200; ++run) {
    Follower follower;
    std::uint64_t first = 0;
    std::uint64_t last = 0;
    std::uint64_t delivered = 0;
    for (std::uint64_t sequence = 1; sequence <= 300; ++sequence) {
      if (random() % 10 != 0) follower.receive(envelope(1, sequence));
      if (follower.wants_snapshot() && random() % 4 == 0) follower.load_snapshot(1, sequence);
      while (const auto update = follower.next()) {
        if (first == 0) first = update->envelope.sequence();
        ASSERT_GT(update->envelope.sequence(), last);
        last = update->envelope.sequence();
        ++delivered;
      }
    }
    ASSERT_GT(delivered, 0u);
    // A hole that has been counted may still be waiting for its snapshot; those behind it are held back.
    if (!follower.wants_snapshot()) {
      ASSERT_EQ(delivered + follower.losses().messages, last - first + 1);
    }
  }
}

TEST(StreamClient, SubscribesOnceAndPassesOverWhatIsNoMessage) {
  zmq::context_t context;
  zmq::socket_t publisher(context, zmq::socket_type::xpub);
  publisher.set(zmq::sockopt::linger, 0);
  publisher.set(zmq::sockopt::rcvtimeo, kPatienceMs);
  publisher.bind("inproc://stream");
  StreamClient stream(context, "inproc://stream");
  zmq::message_t subscription;
  ASSERT_TRUE(publisher.recv(subscription));
  EXPECT_EQ(subscription.to_string(), std::string("\x01"));  // to everything
  EXPECT_FALSE(publisher.recv(subscription, zmq::recv_flags::dontwait));

  const std::string good = envelope(1, 7).SerializeAsString();
  publisher.send(zmq::buffer(good));
  for (const auto& frames : std::vector<std::vector<std::string>>{
           {"status.", "\xff garbage"}, {"status.", good, "more"}, {"status.", good}}) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      publisher.send(zmq::buffer(frames[i]), i + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
    }
  }
  zmq_pollitem_t item{stream.socket(), 0, ZMQ_POLLIN, 0};
  std::optional<v1::Envelope> received;
  while (!received && zmq_poll(&item, 1, kPatienceMs) == 1) received = stream.receive();
  ASSERT_TRUE(received);
  EXPECT_EQ(received->sequence(), 7u);
  EXPECT_FALSE(stream.receive());
}

}  // namespace
}  // namespace dwell::client
