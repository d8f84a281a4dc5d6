#include "clients/terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <system_error>

namespace dwell::client {
namespace {

bool set_in_environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

}  // namespace

bool is_terminal() {
  const char* term = std::getenv("TERM");
  return isatty(STDOUT_FILENO) == 1 && term != nullptr && std::string_view(term) != "dumb";
}

bool wants_colour() { return is_terminal() && !set_in_environment("NO_COLOR"); }

Page terminal_page() {
  if (isatty(STDOUT_FILENO) != 1) return {};
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {80, 24};
  return {size.ws_col, size.ws_row};
}

void write_out(const std::string& text) {
  std::string_view left = text;
  while (!left.empty()) {
    const ssize_t written = write(STDOUT_FILENO, left.data(), left.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && errno == EAGAIN) {  // someone sharing the terminal has made it non-blocking
      pollfd writable{STDOUT_FILENO, POLLOUT, 0};
      poll(&writable, 1, -1);
      continue;
    }
    if (written < 0) throw std::system_error(errno, std::generic_category(), "cannot write to standard output");
    left.remove_prefix(static_cast<std::size_t>(written));
  }
}

Signals::Signals(std::initializer_list<int> signals) {
  sigemptyset(&set_);
  for (const int signal : signals) sigaddset(&set_, signal);
  pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  descriptor_ = signalfd(-1, &set_, SFD_NONBLOCK | SFD_CLOEXEC);
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "signalfd");
}

Signals::~Signals() { close(descriptor_); }

std::optional<int> Signals::next() {
  signalfd_siginfo info{};
  if (read(descriptor_, &info, sizeof info) != sizeof info) return std::nullopt;
  return static_cast<int>(info.ssi_signo);
}

Screen::Screen() : keyboard_(isatty(STDIN_FILENO) == 1 && tcgetattr(STDIN_FILENO, &saved_) == 0 ? STDIN_FILENO : -1) {
  enter();
}

Screen::~Screen() {
  try {
    leave();
  } catch (const std::system_error&) {
    // The terminal is gone: there is nothing left to restore.
  }
}

void Screen::enter() {
  if (keyboard_ >= 0) {
    termios quiet = saved_;
    quiet.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(keyboard_, TCSANOW, &quiet);
  }
  write_out("\x1b[?1049h\x1b[?25l\x1b[2J");
}

void Screen::leave() {
  if (keyboard_ >= 0) tcsetattr(keyboard_, TCSANOW, &saved_);
  write_out("\x1b[?25h\x1b[?1049l");
}

void Screen::draw(const Lines& lines, const Page& page, bool colour) {
  std::string frame = "\x1b[H";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i > 0) frame += "\r\n";
    frame += paint(lines[i], page.columns, colour);
    // Behind a line that fills the row the cursor still stands on its last character: nothing to clear there.
    if (display_width(lines[i].text) < page.columns) frame += "\x1b[K";
  }
  if (static_cast<int>(lines.size()) < page.rows) frame += "\r\n\x1b[J";
  write_out(frame);
}

void Screen::suspend() {
  leave();
  raise(SIGSTOP);
  enter();
}

bool Screen::quit_pressed() {
  pollfd readable{keyboard_, POLLIN, 0};
  std::array<char, 64> keys{};
  while (keyboard_ >= 0 && poll(&readable, 1, 0) > 0) {
    const ssize_t count = read(keyboard_, keys.data(), keys.size());
    if (count <= 0) {
      keyboard_ = -1;  // hung up: no more keys
    } else if (std::string_view(keys.data(), static_cast<std::size_t>(count)).find('q') != std::string_view::npos) {
      return true;
    }
  }
  return false;
}

}  // namespace dwell::client
