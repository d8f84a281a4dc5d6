#pragma once

#include <charconv>
#include <cstdint>
#include <limits>
#include <string>

#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

namespace dwell {

inline constexpr std::uint64_t kLargestCount = std::numeric_limits<std::uint64_t>::max();

/// The whole argument is a whole number from `low` to `high`: no sign, no clamping.
inline CLI::Validator whole_number(std::uint64_t low, std::uint64_t high = kLargestCount) {
  const auto check = [low, high](const std::string& text) -> std::string {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    if (whole && value >= low && value <= high) return "";
    return fmt::format("{} must be a whole number from {} to {}", text, low, high);
  };
  return {check, "", "whole_number"};
}

}  // namespace dwell
