#include "daemon/journal.hpp"

#include <gmock/gmock.h>

#include <system_error>

#include "bandit/value_table.hpp"
#include "tests/daemon/support.hpp"

namespace dwell::testing {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

v1::JournalHeader header() {
  v1::JournalHeader message;
  *message.mutable_config() = config_of(kBusy).effective;
  message.set_config_directory("/somewhere");
  return message;
}

v1::Request command(const std::string& id) {
  v1::Request request;
  request.set_id(id);
  request.mutable_set_policy()->set_text("fixed");
  return request;
}

v1::JournalRecord request_record(std::uint64_t scan, const std::string& id) {
  v1::JournalRecord record;
  record.mutable_request()->set_scan(scan);
  *record.mutable_request()->mutable_request() = command(id);
  return record;
}

v1::JournalRecord end_record(std::uint64_t scan) {
  v1::JournalRecord record;
  record.mutable_end()->set_scan(scan);
  record.mutable_end()->set_reason("done");
  return record;
}

class JournalTest : public ::testing::Test {
 protected:
  /// A journal of a header, three requests and an end; where each record ends.
  std::vector<std::size_t> write() {
    std::vector<std::size_t> ends;
    std::string problem;
    JournalWriter writer(file_, header());
    const auto note = [&] { ends.push_back(std::filesystem::file_size(file_)); };
    note();
    for (std::uint64_t scan : {1U, 5U, 5U}) {
      EXPECT_TRUE(writer.append(request_record(scan, "r" + std::to_string(ends.size())), problem));
      note();
    }
    EXPECT_TRUE(writer.append(end_record(9), problem));
    note();
    return ends;
  }

  std::string refusal() const {
    try {
      (void)read_journal(file_);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  }

  TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "journal";
};

TEST_F(JournalTest, ReadsBackWhatWasWritten) {
  (void)write();
  const Journal journal = read_journal(file_);
  v1::JournalHeader expected = header();
  expected.set_version(journal.header.version());
  EXPECT_EQ(journal.header.SerializeAsString(), expected.SerializeAsString());
  ASSERT_EQ(journal.requests.size(), 3);
  EXPECT_EQ(journal.requests[2].scan(), 5);
  EXPECT_EQ(journal.requests[2].request().SerializeAsString(), command("r3").SerializeAsString());
  ASSERT_TRUE(journal.end);
  EXPECT_EQ(journal.end->scan(), 9);
}

TEST_F(JournalTest, ExistingFileIsLeftAlone) {
  write_file(file_, "precious");
  EXPECT_THROW(JournalWriter(file_, header()), std::system_error);
  EXPECT_EQ(read_file(file_), "precious");
  EXPECT_THROW(JournalWriter("/no/such/directory/journal", header()), std::system_error);
}

TEST_F(JournalTest, CutAtAnyByteIsAWholePrefixOrARefusalWithTheOffset) {
  const std::vector<std::size_t> ends = write();
  std::size_t record = ends.size() - 1;  // that the cut falls into
  for (std::size_t cut = ends.back() - 1; cut > 0; --cut) {
    std::filesystem::resize_file(file_, cut);
    while (record > 0 && cut < ends[record - 1]) --record;
    if (record > 0 && cut == ends[record - 1]) {
      const Journal journal = read_journal(file_);
      EXPECT_EQ(journal.requests.size(), record - 1);
      EXPECT_FALSE(journal.end);
    } else {
      const std::size_t start = record == 0 ? 0 : ends[record - 1];
      EXPECT_THAT(refusal(), HasSubstr("at byte " + std::to_string(start) + ": is damaged or cut off")) << cut;
    }
  }
}

TEST_F(JournalTest, AnyFlippedBitIsRefusedWithAnOffset) {
  (void)write();
  const std::string whole = read_file(file_);
  std::fstream file(file_, std::ios::in | std::ios::out | std::ios::binary);
  const auto put = [&](std::size_t place, int byte) {
    file.seekp(static_cast<std::streamoff>(place));
    file.put(static_cast<char>(byte)).flush();
  };
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    put(bit / 8, whole[bit / 8] ^ (1 << (bit % 8)));
    ASSERT_THAT(refusal(), HasSubstr(": is damaged or cut off")) << "bit " << bit % 8 << " of byte " << bit / 8;
    put(bit / 8, whole[bit / 8]);
  }
}

TEST_F(JournalTest, FileThatIsNoJournalIsRefused) {
  for (const std::string& bytes : {std::string(), std::string("radar { name: \"r\" }"), std::string(4096, '\0')}) {
    write_file(file_, bytes);
    EXPECT_THAT(refusal(), AnyOf(HasSubstr("at byte 0"), HasSubstr("is empty")));
  }
  EXPECT_THROW((void)read_journal("/no/such/journal"), InvalidInput);
  EXPECT_THROW((void)read_journal("/"), InvalidInput);
}

TEST_F(JournalTest, RecordsOutOfPlaceAreRefused) {
  std::string problem;
  {
    JournalWriter writer(file_, header());
    v1::JournalRecord second;
    *second.mutable_header() = header();
    ASSERT_TRUE(writer.append(second, problem));
  }
  EXPECT_THAT(refusal(), HasSubstr("is out of place"));
  std::filesystem::remove(file_);
  {
    JournalWriter writer(file_, header());
    ASSERT_TRUE(writer.append(request_record(7, "a"), problem));
    ASSERT_TRUE(writer.append(request_record(6, "b"), problem));
  }
  EXPECT_THAT(refusal(), HasSubstr("request.scan = 6: must not go back"));
  std::filesystem::remove(file_);
  {
    JournalWriter writer(file_, header());
    ASSERT_TRUE(writer.append(end_record(7), problem));
    ASSERT_TRUE(writer.append(request_record(8, "a"), problem));
  }
  EXPECT_THAT(refusal(), HasSubstr("is out of place"));
}

/// What a user does: commands between scans, recorded; then the same run from the journal alone.
TEST_F(JournalTest, ReplayPublishesTheSameBytes) {
  v1::Request down;
  down.set_id("down");
  down.mutable_set_radar()->set_name("west");
  JournalWriter writer(file_, header());
  RecordedRun recorded(config_of(kBusy), &writer);
  recorded.scan(20);
  EXPECT_TRUE(recorded.run.handle(command("policy")).has_accepted());
  EXPECT_TRUE(recorded.run.handle(command("policy")).has_accepted()) << "a retry, not a second one";
  recorded.scan(57);
  EXPECT_TRUE(recorded.run.handle(down).has_accepted());
  recorded.scan(13);
  EXPECT_TRUE(recorded.run.handle(command("")).has_refused());
  recorded.scan(210);
  recorded.run.publish_end("done");

  const Journal journal = read_journal(file_);
  ASSERT_EQ(journal.requests.size(), 2);
  RecordedRun again(read_config(journal.header.config(), "journal", kScenarios));
  again.run.set_replaying();
  std::size_t next = 0;
  for (std::uint64_t scan = 1; scan <= journal.end->scan(); ++scan) {
    for (; next < journal.requests.size() && journal.requests[next].scan() == scan; ++next) {
      EXPECT_TRUE(again.run.replay(journal.requests[next].request()));
    }
    again.scan(1);
  }
  again.run.publish_end("done");
  EXPECT_TRUE(again.stream.bytes == recorded.stream.bytes);
  EXPECT_FALSE(again.stream.bytes.empty());
}

/// Value sets that are built beside the scans, some of them too late: the journal says which.
TEST_F(JournalTest, ReplayRepeatsWhichValueSetsWereLate) {
  DaemonConfig config = config_of(kBusy);
  config.engine.policy = IndexSettings{};
  config.engine.value_table = std::make_shared<ValueTable>(ValueTable::OnDue::kGoOn);
  JournalWriter writer(file_, header());
  RecordedRun recorded(config, &writer);
  recorded.scan(15);  // nothing is built
  bool answered = false;
  for (int scan = 0; scan < 1000 && !answered; ++scan) {
    recorded.scan(1);
    answered = recorded.run.engine().last().decision.relaxed.has_value();
    while (config.engine.value_table->waiting() > 0) config.engine.value_table->build_next();
  }
  EXPECT_TRUE(answered);
  recorded.scan(50);
  recorded.run.publish_end("done");

  const Journal journal = read_journal(file_);
  EXPECT_GE(journal.late.value_sets.size(), 2U);
  config.engine.value_table = nullptr;
  RecordedRun again(config);
  again.run.set_replaying(journal.late);
  again.scan(static_cast<int>(journal.end->scan()));
  again.run.publish_end("done");
  EXPECT_TRUE(again.stream.bytes == recorded.stream.bytes);
}

TEST_F(JournalTest, ReplayRefusesCommandsThatWouldChangeIt) {
  RecordedRun recorded(config_of(kBusy));
  recorded.run.set_replaying();
  const v1::Reply reply = recorded.run.handle(command("a"));
  EXPECT_EQ(reply.refused().reason(), v1::Refused::NOT_NOW);
  v1::Request pause;
  pause.set_id("b");
  pause.mutable_pause();
  EXPECT_TRUE(recorded.run.handle(pause).has_accepted());
}

/// /dev/full takes no byte: a command that cannot be written down is not applied.
TEST_F(JournalTest, CommandThatCannotBeRecordedIsRefused) {
  EXPECT_THROW(JournalWriter("/dev/full", header()), std::exception);
}

}  // namespace
}  // namespace dwell::testing
