#include "clients/explain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "clients/names.hpp"
#include "clients/table.hpp"
#include "clients/track_table.hpp"

namespace dwell::client {
namespace {

bool is_chosen(const v1::Candidate& candidate, const v1::ScanReport& report) {
  return std::any_of(report.look().begin(), report.look().end(), [&](const v1::Look& look) {
    return look.radar() == candidate.radar() && look.track() == candidate.track();
  });
}

std::string pair_text(std::uint32_t radar, std::uint32_t track, const Names& names) {
  return fmt::format("{} -> {}", names.radar(radar), names.track(track));
}

std::vector<const v1::Candidate*> by_score(const v1::ScanReport& report) {
  std::vector<const v1::Candidate*> sorted;
  for (const v1::Candidate& candidate : report.candidate()) sorted.push_back(&candidate);
  // A score that is not a number goes last: the order must stay a strict one.
  const auto key = [](const v1::Candidate* c) { return std::isnan(c->score()) ? -INFINITY : c->score(); };
  std::stable_sort(sorted.begin(), sorted.end(), [&](const auto* a, const auto* b) { return key(a) > key(b); });
  return sorted;
}

std::string outcome_text(const v1::Look& look) {
  std::string text = fmt::format("{} plot{}", look.plots(), look.plots() == 1 ? "" : "s");
  if (!look.has_used_plot()) return text + ", none in the gate";
  text += fmt::format(", plot {} used", look.used_plot());
  return look.has_nis() ? text + ", nis " + general(look.nis()) : text;
}

/// Of an index policy: what the look is worth now and later, and what it costs.
std::string parts_text(const v1::Candidate& winner, const Names& names) {
  return fmt::format("a look by {} at track {} gains {} now and {} later, for a price of {}: an index of {}",
                     names.radar(winner.radar()), names.track(winner.track()), general(winner.gain_now()),
                     general(winner.value_later()), general(winner.price()), general(winner.score()));
}

std::string gain_text(const v1::Candidate& winner, const Names& names) {
  if (winner.has_gain_now()) return parts_text(winner, names);
  if (!winner.has_cost_without_look() || !winner.has_expected_cost()) {
    return fmt::format("a score of {}", general(winner.score()));
  }
  const double drop = winner.cost_without_look() - winner.expected_cost();
  std::string text =
      fmt::format("a look by {} brings the expected cost of track {} from {} down to {}: a gain of {}",
                  names.radar(winner.radar()), names.track(winner.track()), general(winner.cost_without_look()),
                  general(winner.expected_cost()), general(winner.score()));
  // What is missing between the drop and the gain is what the policy charges for the look. Six digits are
  // shown.
  const double charge = drop - winner.score();
  if (std::abs(charge) > 1e-6 * std::abs(drop))
    text += fmt::format(" after {} for the use of the radar", general(charge));
  return text;
}

/// Whether a look before this one took the candidate's radar or track.
bool was_taken(const v1::Candidate& candidate, const v1::ScanReport& report, int look) {
  return std::any_of(report.look().begin(), report.look().begin() + look, [&](const v1::Look& earlier) {
    return earlier.radar() == candidate.radar() || earlier.track() == candidate.track();
  });
}

/// The sentence: how the winner of a look stands among the candidates that were left to choose from.
std::string reason_text(const v1::Candidate& winner, const v1::ScanReport& report, int look, const Names& names) {
  int left = 0;
  int better = 0;
  int equal = 0;
  for (const v1::Candidate& candidate : report.candidate()) {
    if (is_chosen(candidate, report) || was_taken(candidate, report, look)) continue;
    ++left;
    if (candidate.score() > winner.score()) ++better;
    if (candidate.score() == winner.score()) ++equal;
  }
  const std::string gain = gain_text(winner, names);
  if (left == 0) return gain + "; no other pair was feasible";
  if (better > 0) {
    return fmt::format("{}; {} of the {} candidates left have more: the policy keeps an order or a limit of its own",
                       gain, better, left);
  }
  if (equal > 0) {
    return fmt::format("{}; {} of the {} candidates left have as much: the policy broke the tie", gain, equal, left);
  }
  return fmt::format("{}; none of the {} candidates left has more", gain, left);
}

std::string margin_text(const v1::ScanReport& report, const std::vector<const v1::Candidate*>& sorted,
                        const Names& names) {
  if (!report.has_margin()) return "none: fewer than two candidates";
  const auto runner_up =
      std::find_if(sorted.begin(), sorted.end(), [&](const auto* c) { return !is_chosen(*c, report); });
  if (runner_up == sorted.end()) return general(report.margin());
  return fmt::format("{} over {}", general(report.margin()),
                     pair_text((*runner_up)->radar(), (*runner_up)->track(), names));
}

/// What the looked-at track is believed to be, and what that made it worth when it was chosen; empty without classes.
std::string importance_text(const v1::Candidate& winner, const v1::Snapshot& snapshot, const Names& names) {
  const auto track = std::find_if(snapshot.track().begin(), snapshot.track().end(),
                                  [&](const v1::Track& t) { return t.id() == winner.track(); });
  if (!winner.has_weight() || track == snapshot.track().end()) return "";
  return fmt::format("class   {} after the look; weight {} when it was chosen, {} now", class_text(*track, names),
                     general(winner.weight()), general(track->weight()));
}

Lines head(const v1::ScanReport& report, const std::vector<const v1::Candidate*>& sorted, const Names& names,
           const v1::Snapshot& snapshot, int columns) {
  constexpr int kIndent = 8;
  Lines lines{{fmt::format("scan {}, policy {}, {} candidate{}", report.scan(), printable(report.policy()),
                           report.candidate_size(), report.candidate_size() == 1 ? "" : "s"),
               Mark::kBold}};
  if (report.fell_back()) {
    const std::string other = report.answered_by().empty() ? "a cheaper one" : printable(report.answered_by());
    lines.push_back({"note    the policy could not answer; " + other + " decided", Mark::kWarning});
  }
  if (report.owed())
    lines.push_back({"note    the first look was owed: its track or its radar had waited too long", Mark::kPlain});
  if (report.look().empty()) lines.push_back({"chosen  nothing: no pair was feasible"});
  for (int place = 0; place < report.look_size(); ++place) {
    const v1::Look& look = report.look(place);
    lines.push_back({"chosen  " + pair_text(look.radar(), look.track(), names) + ": " + outcome_text(look)});
    const auto winner = std::find_if(sorted.begin(), sorted.end(), [&](const auto* c) {
      return c->radar() == look.radar() && c->track() == look.track();
    });
    if (winner == sorted.end()) continue;
    for (Line& line : wrap("why     " + reason_text(**winner, report, place, names), columns, kIndent)) {
      lines.push_back(std::move(line));
    }
    if (std::string text = importance_text(**winner, snapshot, names); !text.empty()) {
      lines.push_back({std::move(text)});
    }
  }
  if (report.has_relaxed()) {
    lines.push_back({fmt::format("cost    {} m2 after the scan; reference {} m2 a scan (no bound), {:+.1f} %",
                                 general(report.cost()), general(report.relaxed().reference()),
                                 100.0 * (report.cost() / report.relaxed().reference() - 1.0))});
  }
  if (!sorted.empty()) lines.push_back({"margin  " + margin_text(report, sorted, names)});
  return lines;
}

}  // namespace

Lines explain(const v1::Snapshot& snapshot, const Page& page) {
  if (!snapshot.has_last_scan()) return {{"no scan has been completed yet"}};
  const v1::ScanReport& report = snapshot.last_scan();
  const Names names(snapshot);
  const auto sorted = by_score(report);
  Lines lines = head(report, sorted, names, snapshot, page.columns);
  if (sorted.empty()) return lines;

  const bool parts = sorted.front()->has_gain_now();
  std::vector<Column> columns{
      {"", false, 0}, {"radar", false, 0}, {"track", true, 0}, {"name", false, 3}, {"score", true, 0}};
  if (parts) {
    columns.insert(columns.end(), {{"gain now", true, 0}, {"value later", true, 0}, {"price", true, 1}});
  } else {
    columns.insert(columns.end(), {{"cost without look", true, 2}, {"expected cost", true, 1}});
  }
  const bool weights = sorted.front()->has_weight();
  if (weights) columns.push_back({"weight", true, 0});
  Table table(std::move(columns));
  for (const v1::Candidate* c : sorted) {
    const bool chosen = is_chosen(*c, report);
    std::vector<std::string> cells{chosen ? "*" : "", names.radar(c->radar()), fmt::format("{}", c->track()),
                                   names.track_name(c->track()), general(c->score())};
    if (parts) {
      cells.insert(cells.end(), {general(c->gain_now()), general(c->value_later()), general(c->price())});
    } else {
      cells.push_back(c->has_cost_without_look() ? general(c->cost_without_look()) : "-");
      cells.push_back(c->has_expected_cost() ? general(c->expected_cost()) : "-");
    }
    if (weights) cells.push_back(general(c->weight()));
    table.add(std::move(cells), chosen ? Mark::kBold : Mark::kPlain);
  }
  lines.push_back({""});
  const Page rest{page.columns, page.rows - static_cast<int>(lines.size())};
  for (Line& line : table.lines(rest, "candidates")) lines.push_back(std::move(line));
  return lines;
}

}  // namespace dwell::client
