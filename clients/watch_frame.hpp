#pragma once

#include <cstdint>
#include <string>

#include "clients/picture.hpp"
#include "clients/stream_client.hpp"
#include "clients/text.hpp"

namespace dwell::client {

/// How well the picture is supplied.
struct Supply {
  std::string stream;  // the endpoints
  std::string control;
  std::int64_t silent_s = 0;  // whole seconds since the last message
  Losses losses{};
  bool started = true;            // a snapshot or a message has come
  bool without_snapshot = false;  // the control endpoint does not answer
};

inline constexpr std::int64_t kSilenceSeconds = 3;  // three status messages, one a second, have not come

/// "last look: west -> 7 two, margin 340.2"
std::string decision_text(const Picture& picture);

/// What `watch` shows: the head, the marks of what is wrong, the tracks. Fits the page.
Lines watch_frame(const Picture& picture, const Supply& supply, const Page& page);

}  // namespace dwell::client
