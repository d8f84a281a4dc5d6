#pragma once

#include <termios.h>
#include <csignal>
#include <initializer_list>
#include <optional>
#include <string>

#include "clients/text.hpp"

namespace dwell::client {

/// Standard output is a terminal that can place the cursor.
bool is_terminal();

/// A terminal, and the user has not set NO_COLOR (no-color.org).
bool wants_colour();

/// The size of the terminal; 80 x 24 where it does not say; no limits on what is piped.
Page terminal_page();

/// Blocks the signals that `watch` answers and hands them out in order, so that they can be polled for beside
/// the sockets. They stay blocked afterwards: a second Ctrl-C on the way out must not change the exit code.
class Signals {
 public:
  explicit Signals(std::initializer_list<int> signals);
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  int descriptor() const { return descriptor_; }
  std::optional<int> next();

 private:
  sigset_t set_;
  int descriptor_;
};

/// The alternate screen, without cursor and echo, for as long as this lives.
class Screen {
 public:
  Screen();
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Redraws in place: line after line over the old ones, then clears what is left below. No flicker.
  void draw(const Lines& lines, const Page& page, bool colour);

  /// Ctrl-Z: gives the terminal back, stops this process, and takes the terminal again when it goes on.
  void suspend();

  /// Keyboard input to poll for, -1 where standard input is no terminal.
  int keyboard() const { return keyboard_; }
  /// 'q' was pressed.
  bool quit_pressed();

 private:
  void enter();
  void leave();

  termios saved_{};  // before keyboard_, whose initialiser fills it
  int keyboard_;
};

/// Writes all of it to standard output; throws std::system_error.
void write_out(const std::string& text);

}  // namespace dwell::client
