#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dwell::client {

inline constexpr int kUnlimited = 1'000'000'000;

/// The room there is to write on, in character cells. What is piped has no limits.
struct Page {
  int columns = kUnlimited;
  int rows = kUnlimited;
};

enum class Mark { kPlain, kBold, kWarning, kAlarm };

struct Line {
  std::string text;
  Mark mark = Mark::kPlain;
};
using Lines = std::vector<Line>;

/// Names come over the wire: a control character in one must not reach the terminal. Each becomes '?'.
std::string printable(std::string_view utf8);

/// Cells that the text takes on a terminal: two for the wide East Asian characters.
int display_width(std::string_view utf8);

/// The longest prefix of at most `columns` cells; never half a character.
std::string clip(std::string_view utf8, int columns);

/// Breaks a sentence at its spaces into lines of at most `columns` cells; the later ones begin with `indent`
/// spaces.
Lines wrap(std::string_view utf8, int columns, int indent);

/// Fixed decimals; "-" for what is not finite.
std::string fixed(double value, int decimals);

/// Six significant digits; "-" for what is not finite.
std::string general(double value);

/// The line cut to the page, with its colour where colours are wanted.
std::string paint(const Line& line, int columns, bool colour);

}  // namespace dwell::client
