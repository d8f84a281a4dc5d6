#include "clients/format.hpp"

#include <fmt/format.h>
#include <google/protobuf/text_format.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <utility>
#include <vector>

#include "clients/names.hpp"
#include "clients/table.hpp"
#include "clients/track_table.hpp"

namespace dwell::client {
namespace {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string run_word(v1::Status::Run run) { return lower(v1::Status::Run_Name(run)); }

// A parameter's value as the command line takes it: enumerators in lower case, doubles at their shortest.
std::string value_text(const google::protobuf::Message& message, const google::protobuf::FieldDescriptor& field) {
  using google::protobuf::FieldDescriptor;
  const google::protobuf::Reflection& values = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_ENUM:
      return lower(values.GetEnum(message, &field)->name());
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return fmt::format("{}", values.GetDouble(message, &field));
    case FieldDescriptor::CPPTYPE_UINT32:
      return fmt::format("{}", values.GetUInt32(message, &field));
    case FieldDescriptor::CPPTYPE_BOOL:
      return values.GetBool(message, &field) ? "true" : "false";
    default: {
      std::string text;
      google::protobuf::TextFormat::PrintFieldValueToString(message, &field, -1, &text);
      return text;
    }
  }
}

// Looks left of how many; in brackets while none is due.
std::string budget_text(const v1::RadarState& radar) {
  if (!radar.has_budget()) return "-";
  const v1::BudgetState& budget = radar.budget();
  const std::string text = fmt::format("{}/{}", budget.left(), budget.looks());
  return budget.due() ? text : "(" + text + ")";
}

using Facts = std::vector<std::pair<std::string, std::string>>;

Lines align(const Facts& facts) {
  int widest = 0;
  for (const auto& [name, value] : facts) widest = std::max(widest, display_width(name));
  Lines lines;
  for (const auto& [name, value] : facts) lines.push_back({fmt::format("{:<{}}  {}", name, widest, value)});
  return lines;
}

std::string duration_text(double seconds) {
  if (!(seconds >= 0 && seconds < 1e12)) return "-";
  const auto whole = static_cast<std::int64_t>(seconds);
  const std::string clock = fmt::format("{:02}:{:02}:{:02}", whole / 3600 % 24, whole / 60 % 60, whole % 60);
  return whole < 86400 ? clock : fmt::format("{} d {}", whole / 86400, clock);
}

std::string reason_text(v1::Refused::Reason reason) {
  switch (reason) {
    case v1::Refused::MALFORMED:
      return "the daemon could not read the request";
    case v1::Refused::UNSUPPORTED:
      return "the daemon does not know a part of the request; is it older than this dwellctl?";
    case v1::Refused::INVALID:
      return "invalid";
    case v1::Refused::ID_REUSED:
      return "the id of the request was used before";
    case v1::Refused::NOT_NOW:
      return "not now";
    default:
      return "no reason given";
  }
}

}  // namespace

std::string policy_text(const v1::Policy& policy) {
  std::vector<const google::protobuf::FieldDescriptor*> set;
  policy.GetReflection()->ListFields(policy, &set);
  if (set.empty()) return "unknown";
  std::string text = set.front()->name();
  const google::protobuf::Message& parameters = policy.GetReflection()->GetMessage(policy, set.front());
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  parameters.GetReflection()->ListFields(parameters, &fields);
  for (const auto* field : fields) text += fmt::format(":{}={}", field->name(), value_text(parameters, *field));
  return text;
}

std::string headline(const v1::Status& status, std::int64_t time_ns) {
  std::string text = fmt::format("{}  scan {}  t {} s  radars {}/{} up  tracks {}", run_word(status.run()),
                                 status.scan(), fixed(static_cast<double>(time_ns) / 1e9, 1), status.radars_up(),
                                 status.radars(), status.tracks_confirmed() + status.tracks_coasting());
  if (status.tracks_coasting() > 0) text += fmt::format(" ({} coasting)", status.tracks_coasting());
  if (status.tracks_lost() > 0) text += fmt::format("  lost {}", status.tracks_lost());
  return text;
}

Lines format_status(const v1::Status& status) {
  Facts facts{{"run", run_word(status.run())},
              {"scan", fmt::format("{}", status.scan())},
              {"policy", printable(status.policy())},
              {"radars", fmt::format("{} of {} up", status.radars_up(), status.radars())},
              {"tracks", fmt::format("{} confirmed, {} coasting", status.tracks_confirmed(), status.tracks_coasting())},
              {"tracks given up", fmt::format("{} lost, {} dropped after their target had ended", status.tracks_lost(),
                                              status.tracks_dropped())},
              {"filter failures", fmt::format("{}", status.filter_failures())},
              {"seed", fmt::format("{}", status.seed())},
              {"messages", fmt::format("{} published", status.last_sequence())}};
  if (status.has_cost()) {
    std::string text = general(status.cost()) + " m2 after the last scan";
    if (status.has_reference()) {
      text += fmt::format(", {:+.1f} % of a reference of {} m2 (not a bound)",
                          100.0 * (status.cost() / status.reference() - 1.0), general(status.reference()));
    }
    facts.emplace_back("cost", text);
  }
  if (!status.has_wall_clock()) {
    facts.emplace_back("wall clock", "none: a fast run");
    return align(facts);
  }
  const v1::WallClock& clock = status.wall_clock();
  facts.emplace_back("slow readers", fmt::format("{} overflows", clock.subscriber_overflows()));
  facts.emplace_back("up", duration_text(clock.uptime_s()));
  facts.emplace_back("scan duration",
                     fmt::format("{} us median, {} us 99th percentile", general(clock.scan_duration_p50_us()),
                                 general(clock.scan_duration_p99_us())));
  facts.emplace_back("missed scans", fmt::format("{}", clock.missed_scans()));
  facts.emplace_back("requests",
                     fmt::format("{} refused, {} unreadable", clock.requests_refused(), clock.requests_unreadable()));
  return align(facts);
}

Lines format_policies(const v1::PolicyList& policies, const Page& page) {
  Table table({{"", false, 0},
               {"policy", false, 0},
               {"parameter", false, 0},
               {"default", false, 1},
               {"may be", false, 2},
               {"what", false, 3}});
  for (const v1::PolicyEntry& entry : policies.entry()) {
    const Mark mark = entry.active() ? Mark::kBold : Mark::kPlain;
    std::string star = entry.active() ? "*" : "";
    std::string name = printable(entry.name());
    std::string what = printable(entry.summary());
    if (entry.parameter().empty()) table.add({star, name, "-", "", "", what}, mark);
    for (const v1::PolicyParameter& p : entry.parameter()) {
      table.add({star, name, printable(p.name()), printable(p.default_value()), printable(p.rule()), what}, mark);
      star = name = what = "";  // stand once, in the policy's first row
    }
  }
  return table.lines(page, "rows");
}

Lines format_radars(const v1::RadarList& radars, const Page& page) {
  Table table({{"no", true, 0},
               {"name", false, 0},
               {"state", false, 0},
               {"looks", true, 0},
               {"plots", true, 2},
               {"detected", true, 3},
               {"budget", true, 2},
               {"E km", true, 1},
               {"N km", true, 1}});
  for (const v1::RadarState& radar : radars.radar()) {
    const double share = static_cast<double>(radar.detections()) / static_cast<double>(radar.looks());
    const bool good = radar.calibration().fault() == v1::RadarCalibration::NONE;
    const std::string fault =
        good ? "" : ", " + lower(v1::RadarCalibration::Fault_Name(radar.calibration().fault())) + " fault";
    table.add(
        {fmt::format("{}", radar.number()), printable(radar.name()), (radar.up() ? "up" : "down") + fault,
         fmt::format("{}", radar.looks()), fmt::format("{}", radar.detections()),
         radar.looks() > 0 ? fixed(100 * share, 1) + " %" : "-", budget_text(radar),
         radar.has_x_m() ? fixed(radar.x_m() / 1e3, 3) : "-", radar.has_y_m() ? fixed(radar.y_m() / 1e3, 3) : "-"},
        radar.up() && good ? Mark::kPlain : Mark::kWarning);
  }
  return table.lines(page, "radars");
}

Lines format_calibration(const v1::RadarList& radars, const Page& page) {
  Table table({{"radar", false, 0},
               {"parameter", false, 0},
               {"value", true, 0},
               {"sigma", true, 0},
               {"observable", false, 1},
               {"NIS", true, 2},
               {"P_d x", true, 2},
               {"fault", false, 3}});
  for (const v1::RadarState& radar : radars.radar()) {
    if (!radar.has_calibration()) continue;
    const v1::RadarCalibration& known = radar.calibration();
    const bool good = known.fault() == v1::RadarCalibration::NONE;
    const Mark mark = good ? Mark::kPlain : Mark::kAlarm;
    std::string name = printable(radar.name());
    std::string nis = known.has_nis_after() ? fixed(known.nis_before(), 2) + " -> " + fixed(known.nis_after(), 2) : "-";
    std::string detection = fixed(known.detection_scale(), 2);
    std::string fault = good ? "-" : lower(v1::RadarCalibration::Fault_Name(known.fault()));
    if (known.parameter().empty()) {
      const std::string why = known.failure().empty() ? "no solve yet" : printable(known.failure());
      table.add({name, why, "-", "-", "-", nis, detection, fault}, mark);
    }
    for (const v1::CalibrationParameter& p : known.parameter()) {
      const std::string seen = p.observable() ? "yes" : p.difference_observable().empty() ? "no" : "differences only";
      table.add(
          {name, printable(p.name()), general(p.value()), general(p.standard_error()), seen, nis, detection, fault},
          mark);
      name = nis = detection = fault = "";  // stand once, in the radar's first row
    }
  }
  return table.lines(page, "parameters");
}

Lines format_snapshot(const v1::Snapshot& snapshot, const Page& page) {
  Lines lines{{headline(snapshot.status(), snapshot.time_ns()), Mark::kBold},
              {"policy " + printable(snapshot.status().policy())},
              {fmt::format("epoch {}  sequence {}  scan period {} s", snapshot.epoch(), snapshot.sequence(),
                           general(snapshot.scan_period_s()))}};
  std::string modes = "modes:";
  for (const std::string& name : snapshot.mode_name()) modes += " " + printable(name);
  if (snapshot.mode_name_size() > 0) lines.push_back({modes});
  if (snapshot.track().empty()) {
    lines.push_back({"no tracks"});
    return lines;
  }
  const Names names(snapshot);
  TrackTable table(page.columns, names);
  for (const v1::Track& track : snapshot.track()) table.add(track, names, snapshot.time_ns(), false);
  const Page rest{page.columns, page.rows - static_cast<int>(lines.size())};
  for (Line& line : table.lines(rest)) lines.push_back(std::move(line));
  return lines;
}

Lines format_refusal(const v1::Refused& refused) {
  Lines lines{{"refused: " + reason_text(refused.reason())}};
  for (const v1::Violation& violation : refused.violation()) {
    lines.push_back({fmt::format("  {} = {}: {}", printable(violation.field()), printable(violation.value()),
                                 printable(violation.rule()))});
  }
  return lines;
}

std::string json(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(message, &text, options);
  if (!status.ok()) throw std::runtime_error("cannot write the message as JSON: " + status.ToString());
  return text;
}

}  // namespace dwell::client
