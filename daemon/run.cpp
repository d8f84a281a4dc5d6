#include "daemon/run.hpp"

#include <algorithm>
#include <utility>

#include "bandit/value_table.hpp"
#include "daemon/config/policy_reader.hpp"
#include "daemon/encode.hpp"

namespace dwell {
namespace {

constexpr std::size_t kRememberedAnswers = 4096;    // a client retries within seconds; 1000 commands/s for 4 s
constexpr std::size_t kRememberedBytes = 16 << 20;  // of requests and answers in all
constexpr std::size_t kLongestName = 64;
constexpr std::size_t kLongestPolicyText = 200;
constexpr std::uint64_t kMostSteps = 1'000'000;

void refuse(v1::Reply& reply, v1::Refused::Reason reason, const std::vector<Violation>& violations) {
  v1::Refused& refused = *reply.mutable_refused();
  refused.set_reason(reason);
  for (const Violation& violation : violations) {
    v1::Violation& out = *refused.add_violation();
    out.set_field(violation.field);
    out.set_value(violation.value);
    out.set_rule(violation.rule);
  }
}

bool has_unknown_fields(const google::protobuf::Message& message) {
  const auto* reflection = message.GetReflection();
  if (!reflection->GetUnknownFields(message).empty()) return true;
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  reflection->ListFields(message, &fields);
  return std::any_of(fields.begin(), fields.end(), [&](const auto* field) {
    return field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE && !field->is_repeated() &&
           has_unknown_fields(reflection->GetMessage(message, field));
  });
}

bool is_query(v1::Request::BodyCase body) {
  return body == v1::Request::kGetStatus || body == v1::Request::kListPolicies || body == v1::Request::kGetPolicy ||
         body == v1::Request::kListRadars || body == v1::Request::kGetSnapshot;
}

std::vector<Violation> check_names(const v1::Request& request) {
  std::vector<Violation> violations;
  if (request.id().empty() || request.id().size() > kLongestName) {
    violations.push_back({"id", shortened(request.id(), 80), "must be 1 to 64 bytes"});
  }
  if (request.client().size() > kLongestName) {
    violations.push_back({"client", shortened(request.client(), 80), "must be at most 64 bytes"});
  }
  return violations;
}

}  // namespace

Run::Run(const DaemonConfig& config, Sink& sink, std::uint64_t epoch, JournalWriter* journal)
    : engine_(config.engine),
      calibration_(engine_),
      stream_(sink, epoch),
      journal_(journal),
      policy_(config.effective.policy()),
      policy_text_(policy_text(policy_)) {}

void Run::scan() {
  take_calibration();
  expect_late_values();
  const ScanReport& report = engine_.scan();
  record_late_values();
  if (steps_ > 0) --steps_;
  for (const Track& track : engine_.tracks()) {
    encode(track, *stream_.envelope(Topic::kTrack).mutable_track());
    stream_.publish(Topic::kTrack, report.time, track.id.number);
  }
  for (const LookReport& look : report.looks) {
    const Sensor& sensor = *engine_.sensors()[look.dwell.radar.number - 1];
    for (std::size_t plot = look.first_plot; plot < look.first_plot + look.plots; ++plot) {
      encode(report, look, plot, sensor, *stream_.envelope(Topic::kPlot).mutable_plot());
      stream_.publish(Topic::kPlot, report.time);
    }
  }
  encode(report, engine_.tracks(), *stream_.envelope(Topic::kScan).mutable_scan_report());
  stream_.publish(Topic::kScan, report.time);
  calibration_.after_scan();
}

/// The outcome that is due, given up where it is not there: which of the two it was is journalled.
void Run::take_calibration() {
  const auto event = calibration_.before_scan(late_.calibrations.contains(scans() + 1));
  if (event == CalibrationLoop::Event::kNone) return;
  if (event == CalibrationLoop::Event::kGivenUp && journal_ != nullptr) {
    v1::JournalRecord record;
    record.mutable_late_calibration()->set_scan(scans() + 1);
    std::string problem;
    (void)journal_->append(record, problem);  // a disk that is full refuses commands; scans go on
  }
  publish_calibration();
}

void Run::publish_calibration() {
  for (std::size_t i = 0; i < engine_.sensors().size(); ++i) {
    v1::RadarCalibration& message = *stream_.envelope(Topic::kCalibration).mutable_radar_calibration();
    if (encode_calibration(engine_, i, message)) stream_.publish(Topic::kCalibration, engine_.last().time);
  }
}

void Run::expect_late_values() {
  if (!replaying_) return;
  const auto late = late_.value_sets.find(scans() + 1);
  engine_.value_table().expect_late(late == late_.value_sets.end() ? std::vector<std::uint64_t>() : late->second);
}

/// What depends on how fast sets are built is on the disk before the scan is published.
void Run::record_late_values() {
  const std::vector<std::uint64_t> late = engine_.value_table().take_late();
  if (late.empty() || journal_ == nullptr) return;
  v1::JournalRecord record;
  record.mutable_late_values()->set_scan(scans());
  for (const std::uint64_t key : late) record.mutable_late_values()->add_key(key);
  std::string problem;
  (void)journal_->append(record, problem);  // a disk that is full refuses commands; scans go on
}

v1::Reply Run::handle(const v1::Request& request) {
  v1::Reply reply = answer(request);
  if (reply.has_refused()) ++requests_refused_;
  return reply;
}

v1::Reply Run::answer(const v1::Request& request) {
  v1::Reply reply;
  reply.set_id(shortened(request.id(), kLongestName));
  if (const auto violations = check_names(request); !violations.empty()) {
    refuse(reply, v1::Refused::INVALID, violations);
  } else if (has_unknown_fields(request)) {
    refuse(reply, v1::Refused::UNSUPPORTED, {{"request", "", "holds fields that this version does not know"}});
  } else if (request.body_case() == v1::Request::BODY_NOT_SET) {
    refuse(reply, v1::Refused::MALFORMED, {{"body", "", "is required: a command or a query"}});
  } else if (is_query(request.body_case())) {
    query(request, *reply.mutable_accepted());
  } else if (const auto known = answers_.find(request.id()); known != answers_.end()) {
    if (known->second.request == request.SerializeAsString()) return known->second.reply;
    refuse(reply, v1::Refused::ID_REUSED, {{"id", request.id(), "was used for another request"}});
  } else {
    reply = command(request);
    remember(request, reply);
  }
  return reply;
}

bool Run::replay(const v1::Request& request) {
  const bool replaying = std::exchange(replaying_, false);
  const bool accepted = command(request).has_accepted();
  replaying_ = replaying;
  return accepted;
}

v1::Reply Run::command(const v1::Request& request) {
  v1::Reply reply;
  reply.set_id(request.id());
  const bool changes = request.has_set_policy() || request.has_set_radar() || request.has_calibrate();
  if (ending_ || stop_requested()) {
    refuse(reply, v1::Refused::NOT_NOW, {{"run", "ending", "must not be ending"}});
  } else if (replaying_ && changes) {
    refuse(reply, v1::Refused::NOT_NOW, {{"run", "replaying", "must not repeat a journal"}});
  } else if (request.has_set_policy()) {
    set_policy(request, reply);
  } else if (request.has_set_radar()) {
    set_radar(request, reply);
  } else if (request.has_calibrate()) {
    calibrate(request, reply);
  } else if (request.has_step()) {
    step(request.step(), reply);
  } else {
    pause(request, reply);
  }
  if (!reply.has_accepted()) return reply;
  reply.mutable_accepted()->set_effective_scan(request.has_calibrate() ? *calibration_.due() : scans() + 1);
  return reply;
}

void Run::set_policy(const v1::Request& request, v1::Reply& reply) {
  const std::string& text = request.set_policy().text();
  if (text.size() > kLongestPolicyText) {
    return refuse(reply, v1::Refused::INVALID, {{"set_policy.text", shortened(text, 80), "must be at most 200 bytes"}});
  }
  std::vector<Violation> violations;
  std::optional<v1::Policy> wanted = request.set_policy().policy();
  if (request.set_policy().has_text()) wanted = parse_policy_text(text, violations);
  std::optional<PolicySettings> settings;
  if (wanted) settings = read_policy(*wanted, sensors(), has_classes(), violations);
  if (!settings || !violations.empty()) return refuse(reply, v1::Refused::INVALID, violations);
  if (!record(request, reply)) return;
  engine_.set_policy(*settings);
  v1::PolicyChange& change = *stream_.envelope(Topic::kPolicy).mutable_policy_change();
  change.Clear();
  change.set_scan(scans() + 1);
  change.set_client(request.client());
  change.set_request_id(request.id());
  *change.mutable_from() = policy_;
  *change.mutable_to() = *wanted;
  policy_ = std::move(*wanted);
  policy_text_ = policy_text(policy_);
  stream_.publish(Topic::kPolicy, engine_.last().time);
  *reply.mutable_accepted()->mutable_policy() = policy_;
}

void Run::set_radar(const v1::Request& request, v1::Reply& reply) {
  const std::string& name = request.set_radar().name();
  const auto& sensors = engine_.config().sensors;
  const auto found =
      std::find_if(sensors.begin(), sensors.end(), [&](const SensorConfig& sensor) { return sensor.name == name; });
  if (found == sensors.end()) {
    std::string names;
    for (const SensorConfig& sensor : sensors) names += (names.empty() ? "" : ", ") + sensor.name;
    return refuse(reply, v1::Refused::INVALID, {{"set_radar.name", shortened(name, 80), "must be one of: " + names}});
  }
  if (!record(request, reply)) return;
  const auto index = static_cast<std::size_t>(found - sensors.begin());
  engine_.set_sensor(index, request.set_radar().up());
  v1::RadarChange& change = *stream_.envelope(Topic::kRadar).mutable_radar_change();
  change.Clear();
  change.set_scan(scans() + 1);
  change.set_client(request.client());
  change.set_request_id(request.id());
  change.set_radar(static_cast<std::uint32_t>(index + 1));
  change.set_name(name);
  change.set_up(request.set_radar().up());
  stream_.publish(Topic::kRadar, engine_.last().time);
  fill_radars(*reply.mutable_accepted()->mutable_radar_list());
}

void Run::calibrate(const v1::Request& request, v1::Reply& reply) {
  if (!engine_.calibrator().on()) {
    return refuse(reply, v1::Refused::NOT_NOW, {{"calibration.mode", "OFF", "must be OBSERVE or APPLY, with a radar"}});
  }
  if (calibration_.due()) {
    return refuse(reply, v1::Refused::NOT_NOW, {{"calibrate", "running", "must not be running already"}});
  }
  if (!record(request, reply)) return;
  calibration_.ask(true);
  fill_radars(*reply.mutable_accepted()->mutable_radar_list());
}

/// Pause, resume and stop change when scans run, not what they do: they are not journalled.
void Run::pause(const v1::Request& request, v1::Reply& reply) {
  if (request.has_stop()) {
    stop_reason_ = "stopped by " + (request.client().empty() ? std::string("a client") : request.client());
  } else {
    paused_ = request.has_pause();
    steps_ = 0;
  }
  fill_status(*reply.mutable_accepted()->mutable_status());
}

void Run::step(const v1::Step& step, v1::Reply& reply) {
  const std::uint64_t scans = step.has_scans() ? step.scans() : 1;
  if (scans < 1 || scans > kMostSteps) {
    return refuse(reply, v1::Refused::INVALID,
                  {{"step.scans", std::to_string(scans), "must be a whole number from 1 to 1000000"}});
  }
  if (!paused_) return refuse(reply, v1::Refused::NOT_NOW, {{"run", "running", "must be paused to step"}});
  steps_ = std::min(steps_ + scans, kMostSteps);
  fill_status(*reply.mutable_accepted()->mutable_status());
}

/// On the disk before it is applied and acknowledged.
bool Run::record(const v1::Request& request, v1::Reply& reply) {
  if (journal_ == nullptr) return true;
  v1::JournalRecord record;
  record.mutable_request()->set_scan(scans() + 1);
  *record.mutable_request()->mutable_request() = request;
  std::string problem;
  if (journal_->append(record, problem)) return true;
  refuse(reply, v1::Refused::NOT_NOW, {{"journal", problem, "must be writable"}});
  return false;
}

void Run::remember(const v1::Request& request, const v1::Reply& reply) {
  const auto bytes = [](const Answer& answer) { return answer.request.size() + answer.reply.ByteSizeLong(); };
  Answer answer{request.SerializeAsString(), reply};
  remembered_bytes_ += bytes(answer);
  answers_.emplace(request.id(), std::move(answer));
  answered_ids_.push_back(request.id());
  while (answered_ids_.size() > kRememberedAnswers || remembered_bytes_ > kRememberedBytes) {
    const auto oldest = answers_.find(answered_ids_.front());
    remembered_bytes_ -= bytes(oldest->second);
    answers_.erase(oldest);
    answered_ids_.pop_front();
  }
}

void Run::query(const v1::Request& request, v1::Accepted& accepted) const {
  accepted.set_effective_scan(scans());
  switch (request.body_case()) {
    case v1::Request::kGetStatus:
      fill_status(*accepted.mutable_status());
      if (wall_clock_) *accepted.mutable_status()->mutable_wall_clock() = wall_clock_();
      break;
    case v1::Request::kListPolicies:
      fill_policies(*accepted.mutable_policy_list());
      break;
    case v1::Request::kGetPolicy:
      *accepted.mutable_policy() = policy_;
      break;
    case v1::Request::kListRadars:
      fill_radars(*accepted.mutable_radar_list());
      break;
    default:
      fill_snapshot(*accepted.mutable_snapshot());
      break;
  }
}

void Run::publish_status(const v1::WallClock* wall_clock) {
  v1::Status& status = *stream_.envelope(Topic::kStatus).mutable_status();
  fill_status(status);
  if (wall_clock != nullptr) *status.mutable_wall_clock() = *wall_clock;
  stream_.publish(Topic::kStatus, engine_.last().time);
}

void Run::publish_end(const std::string& reason) {
  ending_ = true;
  v1::EndOfStream& end = *stream_.envelope(Topic::kEnd).mutable_end_of_stream();
  end.set_final_sequence(stream_.last_sequence() + 1);
  end.set_reason(reason);
  stream_.publish(Topic::kEnd, engine_.last().time);
  if (journal_ == nullptr) return;
  v1::JournalRecord record;
  record.mutable_end()->set_scan(scans());
  record.mutable_end()->set_reason(reason);
  std::string problem;
  // A journal without its end is whole all the same: the reader is told how many scans to run.
  (void)journal_->append(record, problem);
}

void Run::fill_status(v1::Status& status) const {
  status.Clear();
  status.set_run(ending_ || stop_requested() ? v1::Status::ENDING : paused_ ? v1::Status::PAUSED : v1::Status::RUNNING);
  status.set_scan(scans());
  status.set_last_sequence(stream_.last_sequence());
  status.set_seed(engine_.config().seed);
  status.set_policy(policy_text_);
  status.set_radars(static_cast<std::uint32_t>(engine_.sensors().size()));
  for (std::size_t i = 0; i < engine_.sensors().size(); ++i) {
    const SensorState& sensor = engine_.sensor_state(i);
    if (sensor.up) status.set_radars_up(status.radars_up() + 1);
    if (sensor.up && !sensor.budget.allows()) status.set_radars_over_budget(status.radars_over_budget() + 1);
  }
  for (const Track& track : engine_.tracks()) {
    if (track.status == TrackStatus::kConfirmed) status.set_tracks_confirmed(status.tracks_confirmed() + 1);
    if (track.status == TrackStatus::kCoasting) status.set_tracks_coasting(status.tracks_coasting() + 1);
  }
  status.set_tracks_lost(engine_.counts().tracks_lost);
  status.set_tracks_dropped(engine_.counts().tracks_dropped);
  status.set_filter_failures(engine_.counts().filter_failures);
  if (scans() == 0) return;
  status.set_cost(weighted_cost(engine_.tracks()));
  if (const auto& relaxed = engine_.last().decision.relaxed) status.set_reference(relaxed->reference);
}

void Run::fill_policies(v1::PolicyList& list) const {
  for (const PolicyDescription& description : describe_policies(sensors(), has_classes())) {
    v1::PolicyEntry& entry = *list.add_entry();
    entry.set_name(description.name);
    entry.set_summary(description.summary);
    entry.set_active(description.name == engine_.policy_name());
    for (const FieldDescription& field : description.parameters) {
      v1::PolicyParameter& parameter = *entry.add_parameter();
      parameter.set_name(field.name);
      parameter.set_rule(field.rule);
      parameter.set_default_value(field.default_value);
    }
  }
}

void Run::fill_radars(v1::RadarList& list) const {
  for (std::size_t i = 0; i < engine_.sensors().size(); ++i) encode_radar(engine_, i, *list.add_radar());
}

void Run::fill_snapshot(v1::Snapshot& snapshot) const {
  snapshot.set_epoch(stream_.epoch());
  snapshot.set_sequence(stream_.last_sequence());
  snapshot.set_time_ns(engine_.last().time.time_since_epoch().count());
  fill_status(*snapshot.mutable_status());
  if (wall_clock_) *snapshot.mutable_status()->mutable_wall_clock() = wall_clock_();
  *snapshot.mutable_policy() = policy_;
  for (std::size_t i = 0; i < engine_.sensors().size(); ++i) encode_radar(engine_, i, *snapshot.add_radar());
  for (const Mode& mode : engine_.config().bank.modes) snapshot.add_mode_name(mode.name);
  for (const std::string& name : engine_.config().tracker.classes.names) snapshot.add_class_name(name);
  for (const Track& track : engine_.tracks()) encode(track, *snapshot.add_track());
  if (scans() > 0) encode(engine_.last(), engine_.tracks(), *snapshot.mutable_last_scan());
  snapshot.set_scan_period_s(to_seconds(engine_.config().scan_period));
}

}  // namespace dwell
