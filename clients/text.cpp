#include "clients/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace dwell::client {
namespace {

struct CodePoint {
  char32_t value;
  std::size_t bytes;
};

// Strings of a proto3 message are valid UTF-8; a byte that is not is taken alone and shown as '?'.
CodePoint decode(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  const std::size_t bytes = lead < 0x80 ? 1 : lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC2 ? 2 : 0;
  if (bytes == 0 || bytes > text.size()) return {0, 1};
  char32_t value = bytes == 1 ? lead : lead & (0x7Fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xC0) != 0x80) return {0, 1};
    value = (value << 6) | (next & 0x3Fu);
  }
  return {value, bytes};
}

// Besides the control characters proper: line breaks, and the marks that turn the direction of the text
// round.
bool is_control(char32_t c) {
  return c < 0x20 || (c >= 0x7F && c < 0xA0) || (c >= 0x200B && c <= 0x200F) || (c >= 0x2028 && c <= 0x202E) ||
         (c >= 0x2066 && c <= 0x2069) || c == 0xFEFF;
}

// The ranges of East Asian Width W and F (Unicode TR 11), coarsely; and the combining marks that take no
// cell.
int cells(char32_t c) {
  if (c >= 0x300 && c <= 0x36F) return 0;
  static constexpr std::array<std::pair<char32_t, char32_t>, 8> kWide{{{0x1100, 0x115F},
                                                                       {0x2E80, 0xA4CF},
                                                                       {0xAC00, 0xD7A3},
                                                                       {0xF900, 0xFAFF},
                                                                       {0xFE30, 0xFE6F},
                                                                       {0xFF00, 0xFF60},
                                                                       {0x1F300, 0x1FAFF},
                                                                       {0x20000, 0x3FFFD}}};
  for (const auto& [first, last] : kWide) {
    if (c >= first && c <= last) return 2;
  }
  return 1;
}

}  // namespace

std::string printable(std::string_view utf8) {
  std::string result;
  while (!utf8.empty()) {
    const CodePoint c = decode(utf8);
    if (is_control(c.value)) {
      result += '?';
    } else {
      result += utf8.substr(0, c.bytes);
    }
    utf8.remove_prefix(c.bytes);
  }
  return result;
}

int display_width(std::string_view utf8) {
  int width = 0;
  while (!utf8.empty()) {
    const CodePoint c = decode(utf8);
    width += cells(c.value);
    utf8.remove_prefix(c.bytes);
  }
  return width;
}

std::string clip(std::string_view utf8, int columns) {
  std::size_t end = 0;
  int width = 0;
  while (end < utf8.size()) {
    const CodePoint c = decode(utf8.substr(end));
    width += cells(c.value);
    if (width > columns) break;
    end += c.bytes;
  }
  return std::string(utf8.substr(0, end));
}

Lines wrap(std::string_view utf8, int columns, int indent) {
  Lines lines{{""}};
  bool at_start = true;  // of a line: no space before its first word
  while (!utf8.empty()) {
    const std::size_t end = std::min(utf8.find(' ', 1), utf8.size());
    std::string_view word = utf8.substr(0, end);
    if (!at_start && display_width(lines.back().text) + display_width(word) > columns) {
      lines.push_back({std::string(static_cast<std::size_t>(indent), ' ')});
      word.remove_prefix(1);
    }
    lines.back().text += word;
    at_start = false;
    utf8.remove_prefix(end);
  }
  return lines;
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  // The largest finite double has 309 digits: no table has room for what has more than 12.
  return std::abs(value) < 1e12 ? fmt::format("{:.{}f}", value, decimals) : fmt::format("{:.3e}", value);
}

std::string general(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "-"; }

std::string paint(const Line& line, int columns, bool colour) {
  std::string text = clip(line.text, columns);
  if (!colour || line.mark == Mark::kPlain) return text;
  const char* sgr = line.mark == Mark::kBold ? "1" : line.mark == Mark::kWarning ? "33" : "31";
  return fmt::format("\x1b[{}m{}\x1b[0m", sgr, text);
}

}  // namespace dwell::client
