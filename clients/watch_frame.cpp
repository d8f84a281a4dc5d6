#include "clients/watch_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "clients/format.hpp"
#include "clients/track_table.hpp"

namespace dwell::client {
namespace {

// One line for all: the table must not jump up and down when a mark comes or goes.
Line marks(const Supply& supply) {
  std::string text;
  const auto add = [&](const std::string& mark) { text += (text.empty() ? "" : "; ") + mark; };
  const bool silent = supply.silent_s > kSilenceSeconds;
  if (silent) add(fmt::format("NO DATA for {} s from {}", supply.silent_s, supply.stream));
  if (supply.without_snapshot) add("NO SNAPSHOT: no answer from " + supply.control);
  if (supply.losses.holes > 0) {
    add(fmt::format("{} messages missed in {} gap{}", supply.losses.messages, supply.losses.holes,
                    supply.losses.holes == 1 ? "" : "s"));
  }
  if (supply.losses.restarts > 0) {
    add(fmt::format("daemon restarted{}",
                    supply.losses.restarts == 1 ? "" : fmt::format(" {} times", supply.losses.restarts)));
  }
  return {text, silent || supply.without_snapshot ? Mark::kAlarm : Mark::kWarning};
}

bool looked_at(const Picture& picture, std::uint32_t track) {
  const auto& scan = picture.last_scan();
  return scan && std::any_of(scan->look().begin(), scan->look().end(),
                             [&](const v1::Look& look) { return look.track() == track; });
}

}  // namespace

std::string decision_text(const Picture& picture) {
  const auto& scan = picture.last_scan();
  if (!scan) return "last look: none yet";
  if (scan->look().empty()) return "last look: none, no pair was feasible";
  std::string text;
  for (const v1::Look& look : scan->look()) {
    text += fmt::format("{}{} -> {}{}", text.empty() ? "last look: " : ", ", picture.names().radar(look.radar()),
                        picture.names().track(look.track()), look.has_used_plot() ? "" : " (no plot)");
  }
  if (scan->has_margin()) text += ", margin " + general(scan->margin());
  if (scan->owed()) text += ", owed";
  if (scan->fell_back()) text += ", fell back to a cheaper policy";
  return text;
}

Lines watch_frame(const Picture& picture, const Supply& supply, const Page& page) {
  if (!supply.started) return {{"waiting for an answer from " + supply.control}};
  Lines lines{{headline(picture.status(), picture.time_ns()), Mark::kBold},
              {"policy " + printable(picture.status().policy())}};
  lines.push_back({decision_text(picture)});
  std::string modes = "modes:";
  for (const std::string& name : picture.mode_names()) modes += " " + printable(name);
  lines.push_back({picture.mode_names().empty() ? "" : modes});
  lines.push_back(marks(supply));

  TrackTable table(page.columns, picture.names());
  // The lost ones last: where rows are short, what lives comes first.
  for (const bool lost : {false, true}) {
    for (const auto& [id, entry] : picture.tracks()) {
      if ((entry.track.status() == v1::Track::LOST) != lost) continue;
      table.add(entry.track, picture.names(), picture.time_ns(), looked_at(picture, id));
    }
  }
  const Page rest{page.columns, page.rows - static_cast<int>(lines.size())};
  for (Line& line : table.lines(rest)) lines.push_back(std::move(line));
  if (static_cast<int>(lines.size()) > page.rows) lines.resize(static_cast<std::size_t>(std::max(page.rows, 1)));
  return lines;
}

}  // namespace dwell::client
