// The program itself: exit codes, pipes, and a terminal that must be left as it was found.
#include <gmock/gmock.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utmp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/clients/fake_daemon.hpp"

namespace dwell::client {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kProgram = DWELL_BINARY_DIR "/bin/dwellctl";
const std::string kCommand = "timeout 30 " + kProgram;  // one that does not end fails, and does not hang

struct Result {
  int code;
  std::string out;
};

Result finish(std::FILE* pipe) {
  std::string out;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) out.append(buffer.data(), count);
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, out};
}

Result run(const std::string& arguments) { return finish(popen((kCommand + " " + arguments).c_str(), "r")); }

/// Both ends of a daemon on ipc endpoints, for one listener.
class DwellctlProgram : public testing::Test {
 protected:
  DwellctlProgram() {
    publisher_.set(zmq::sockopt::linger, kPatienceMs);
    publisher_.set(zmq::sockopt::rcvtimeo, kPatienceMs);
    publisher_.bind(stream_);
  }

  ~DwellctlProgram() override { std::filesystem::remove_all(directory_); }

  std::string endpoints() const { return "--control " + control_ + " --stream " + stream_; }

  /// Until the program has subscribed and has its snapshot.
  void await_listener() {
    zmq::message_t subscription;
    ASSERT_TRUE(publisher_.recv(subscription));
    ASSERT_EQ(daemon_.requests().size(), 1u);
  }

  void publish(const std::string& topic, v1::Envelope envelope) {
    envelope.set_epoch(1);
    envelope.set_sequence(++sequence_);
    envelope.set_time_ns(13'000'000'000);
    publisher_.send(zmq::buffer(topic), zmq::send_flags::sndmore);
    publisher_.send(zmq::buffer(envelope.SerializeAsString()));
  }

  void publish_track() {
    v1::Envelope envelope;
    *envelope.mutable_track() = track(2, "moved");
    publish("track.2.", envelope);
  }

  void publish_end() {
    v1::Envelope envelope;
    envelope.mutable_end_of_stream()->set_reason("all scans run");
    publish("end.", envelope);
  }

  static std::filesystem::path new_directory() {
    std::string name = testing::TempDir() + "dwellctl_XXXXXX";
    return mkdtemp(name.data());
  }

  const std::filesystem::path directory_ = new_directory();
  const std::string control_ = "ipc://" + (directory_ / "control").string();
  const std::string stream_ = "ipc://" + (directory_ / "stream").string();
  zmq::context_t context_;
  zmq::socket_t publisher_{context_, zmq::socket_type::xpub};
  FakeControl daemon_{context_, control_, 1, [](const v1::Request& request, int) {
                        v1::Reply reply = accepted(request, 12);
                        *reply.mutable_accepted()->mutable_snapshot() = snapshot(3);
                        return reply;
                      }};
  std::uint64_t sequence_ = 100;  // of the snapshot
};

TEST(Dwellctl, ExitCodesAreAsDocumented) {
  EXPECT_EQ(run("--help").code, 0);
  EXPECT_EQ(run("nonsense 2>&1").code, 2);
  const std::string nobody = "--timeout 0.01 --control ipc://" + testing::TempDir() + "nobody_is_here ";
  for (const char* verb : {"status", "watch"}) {
    const Result result = run(nobody + verb + " 2>&1");
    EXPECT_EQ(result.code, 1) << verb;
    EXPECT_THAT(result.out, HasSubstr("(3 tries of 0.01 s): is dwelld running there?")) << verb;
  }
}

TEST_F(DwellctlProgram, SaysWhenItsOutputCannotBeWritten) {
  const Result result = run(endpoints() + " snapshot 2>&1 > /dev/full");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.out, HasSubstr("cannot write to standard output"));
}

TEST_F(DwellctlProgram, WatchIntoAPipeIsALineATrackAndScan) {
  std::FILE* pipe = popen((kCommand + " " + endpoints() + " watch 2>&1").c_str(), "r");
  await_listener();
  publish_track();
  publish_end();
  const Result result = finish(pipe);
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.out, testing::MatchesRegex("# +time_s .*\n +13.000 +2 moved .*\n"
                                                "dwellctl: the stream ended at scan 12, t 13.0 s: all scans run\n"));
}

TEST_F(DwellctlProgram, WatchAsJsonIsEachMessageOnALine) {
  std::FILE* pipe = popen((kCommand + " --json " + endpoints() + " watch 2>/dev/null").c_str(), "r");
  await_listener();
  publish_track();
  publish_end();
  const Result result = finish(pipe);
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.out, testing::MatchesRegex("[{]\"epoch\":\"1\",\"sequence\":\"101\",.*\"name\":\"moved\".*\n"
                                                "[{]\"epoch\":\"1\",\"sequence\":\"102\",.*\"end_of_stream\".*\n"));
}

/// Reads from the terminal until the text has come.
std::string read_until(int terminal, const std::string& text) {
  std::string seen;
  std::array<char, 4096> buffer{};
  pollfd readable{terminal, POLLIN, 0};
  const auto patience = std::chrono::steady_clock::now() + std::chrono::milliseconds(kPatienceMs);
  while (seen.find(text) == std::string::npos && poll(&readable, 1, kPatienceMs) > 0) {
    if (std::chrono::steady_clock::now() > patience) break;  // it is redrawn for ever
    const ssize_t count = read(terminal, buffer.data(), buffer.size());
    if (count <= 0) break;
    seen.append(buffer.data(), static_cast<std::size_t>(count));
  }
  return seen;
}

TEST_F(DwellctlProgram, WatchOnATerminalLeavesItAsItWas) {
  int master = -1;
  int slave = -1;
  const winsize size{20, 100, 0, 0};
  ASSERT_EQ(openpty(&master, &slave, nullptr, nullptr, &size), 0);
  termios before{};
  ASSERT_EQ(tcgetattr(slave, &before), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(master);  // so that the program gets its hang-up should this test die
    login_tty(slave);
    setenv("TERM", "xterm", 1);
    execl(kProgram.c_str(), "dwellctl", "--control", control_.c_str(), "--stream", stream_.c_str(), "watch", nullptr);
    _exit(127);
  }
  await_listener();
  publish_track();
  EXPECT_THAT(read_until(master, "moved"), AllOf(HasSubstr("\x1b[?1049h"), HasSubstr("policy sa_imm:cost=x")));
  ASSERT_EQ(write(master, "\x03", 1), 1);  // Ctrl-C
  const std::string farewell = read_until(master, "\x1b[?1049l");
  EXPECT_THAT(farewell, HasSubstr("\x1b[?25h\x1b[?1049l"));
  if (farewell.find("\x1b[?1049l") == std::string::npos) kill(child, SIGKILL);
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  termios after{};
  ASSERT_EQ(tcgetattr(slave, &after), 0);
  EXPECT_EQ(after.c_lflag, before.c_lflag);
  EXPECT_TRUE(std::equal(std::begin(after.c_cc), std::end(after.c_cc), std::begin(before.c_cc)));
  close(master);
  close(slave);
}

}  // namespace
}  // namespace dwell::client
