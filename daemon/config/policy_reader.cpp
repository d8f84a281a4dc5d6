#include "daemon/config/policy_reader.hpp"

#include <algorithm>

#include "bandit/index.hpp"
#include "bandit/look_ahead.hpp"
#include "bandit/predicted_paths.hpp"

namespace dwell {
namespace {

using google::protobuf::FieldDescriptor;

PolicySettings read(FieldReader in, RoundRobinSettings settings, int /*sensors*/) {
  in.choice("order", settings.order);
  return settings;
}

PolicySettings read(FieldReader in, FixedSettings settings, int sensors) {
  in.integer("sensor", 1, std::max(sensors, 1), settings.sensor);
  return settings;
}

PolicySettings read(FieldReader /*in*/, LargestVarianceSettings settings, int /*sensors*/) { return settings; }

PolicySettings read(FieldReader in, SaImmSettings settings, int /*sensors*/) {
  in.choice("cost", settings.cost);
  in.number("beta", within(0.0, 1e12), 1.0, settings.beta);
  in.integer("nodes", 2, 32, settings.nodes);
  return settings;
}

PolicySettings read(FieldReader /*in*/, BhattacharyyaSettings settings, int /*sensors*/) { return settings; }

void read_horizon(FieldReader& in, const char* field, int& scans) {
  in.integer(field, 1, PredictedPaths::kMostScans, scans);
}

PolicySettings read(FieldReader in, RandomSettings settings, int /*sensors*/) {
  in.choice("q", settings.q);
  read_horizon(in, "horizon", settings.horizon);
  return settings;
}

PolicySettings read(FieldReader in, WindowSettings settings, int /*sensors*/) {
  read_horizon(in, "d", settings.d);
  return settings;
}

PolicySettings read(FieldReader in, ThresholdSettings settings, int /*sensors*/) {
  in.number("f", within(1.0, 1e9), 1.0, settings.f);
  read_horizon(in, "horizon", settings.horizon);
  return settings;
}

PolicySettings read(FieldReader in, RelaxedDpSettings settings, int /*sensors*/) {
  in.number("alpha", within(1.0, 1e3), 1.0, settings.alpha);
  read_horizon(in, "horizon", settings.horizon);
  return settings;
}

PolicySettings read(FieldReader in, BeamSettings settings, int /*sensors*/) {
  in.integer("width", 1, 10'000, settings.width);
  read_horizon(in, "horizon", settings.horizon);
  return settings;
}

PolicySettings read(FieldReader in, OptimumSettings settings, int /*sensors*/) {
  read_horizon(in, "horizon", settings.horizon);
  return settings;
}

PolicySettings read(FieldReader in, LookAheadSettings settings, int /*sensors*/) {
  in.integer("depth", 1, LookAhead::kMostDepth, settings.depth);
  return settings;
}

PolicySettings read(FieldReader in, OrbitSettings settings, int /*sensors*/) {
  in.number("discount", within(0.5, 0.9999), 1.0, settings.discount);
  in.integer("steps", 2, 2000, settings.steps);
  return settings;
}

PolicySettings read(FieldReader in, IndexSettings settings, int /*sensors*/) {
  in.integer("depth", 1, Index::kMostDepth, settings.depth);
  return settings;
}

PolicySettings read(FieldReader in, GittinsHmmSettings settings, int /*sensors*/) {
  in.number("discount", within(0.01, 0.95), 1.0, settings.discount);
  return settings;
}

/// One row for each policy: the field of dwell.v1.Policy, what it does, and how its message is read.
struct Row {
  const char* field;
  const char* summary;
  PolicySettings (*read)(FieldReader in, int sensors);
  bool needs_classes = false;
};

template <class Settings>
PolicySettings read_row(FieldReader in, int sensors) {
  return read(std::move(in), Settings{}, sensors);
}

constexpr Row kRows[] = {
    {"round_robin", "sensors and tracks in turn", read_row<RoundRobinSettings>},
    {"fixed", "one sensor, its tracks in turn", read_row<FixedSettings>},
    {"largest_variance", "the largest predicted position variance, by the sensor that reduces it most",
     read_row<LargestVarianceSettings>},
    {"sa_imm", "the least expected cost one step ahead", read_row<SaImmSettings>},
    {"bhattacharyya", "the least bound on mode errors", read_row<BhattacharyyaSettings>},
    {"random", "pairs at random, with probabilities of a small bound", read_row<RandomSettings>},
    {"window", "the best schedule of the next d scans", read_row<WindowSettings>},
    {"threshold", "the best of the schedules that stay within a factor of the cheapest", read_row<ThresholdSettings>},
    {"relaxed_dp", "a plan within alpha^2 of the cheapest", read_row<RelaxedDpSettings>},
    {"beam", "the best schedule of a beam: the one for many tracks", read_row<BeamSettings>},
    {"optimum", "the best schedule of the horizon, by branch and bound", read_row<OptimumSettings>},
    {"lookahead", "the least expected cost when later looks follow what is measured", read_row<LookAheadSettings>},
    {"orbit", "the largest price at which a track would be looked at now", read_row<OrbitSettings>},
    {"index", "the largest gain now and later, less the price of a look", read_row<IndexSettings>},
    {"gittins_hmm", "the largest Gittins index of a class belief: identification alone", read_row<GittinsHmmSettings>,
     true},
};

}  // namespace

std::vector<PolicyDescription> describe_policies(int sensors, bool classes) {
  std::vector<PolicyDescription> all;
  for (const Row& row : kRows) {
    if (row.needs_classes && !classes) continue;
    v1::Policy policy;
    std::vector<Violation> none;
    PolicyDescription description{row.field, row.summary, {}};
    FieldReader in = FieldReader(policy, nullptr, none).child(row.field);
    in.describe_into(&description.parameters);
    row.read(in, sensors);
    for (FieldDescription& parameter : description.parameters) {
      parameter.rule = lower(parameter.rule);  // as parse_policy_text takes the names of enums
      parameter.default_value = lower(parameter.default_value);
    }
    all.push_back(std::move(description));
  }
  return all;
}

std::optional<PolicySettings> read_policy(v1::Policy& policy, FieldReader& reader, int sensors, bool classes) {
  const FieldDescriptor* kind = policy_kind(policy);
  if (kind == nullptr) {
    reader.refuse(v1::Policy::descriptor()->field(0)->name().c_str(), "",
                  "policy must be one of: " + policy_names(policy));
    return std::nullopt;
  }
  for (const Row& row : kRows) {
    if (kind->name() != row.field) continue;
    if (row.needs_classes && !classes) reader.refuse(row.field, "", "needs classes of targets");
    return row.read(reader.child(row.field), sensors);
  }
  return std::nullopt;
}

std::optional<PolicySettings> read_policy(v1::Policy& policy, int sensors, bool classes,
                                          std::vector<Violation>& violations) {
  if (policy_kind(policy) == nullptr) {
    violations.push_back({"policy", "", "must be one of: " + policy_names(policy)});
    return std::nullopt;
  }
  const std::size_t before = violations.size();
  FieldReader reader(policy, nullptr, violations);
  auto settings = read_policy(policy, reader, sensors, classes);
  return violations.size() == before ? settings : std::nullopt;
}

std::optional<v1::Policy> parse_policy_text(std::string_view text, std::vector<Violation>& violations) {
  v1::Policy policy;
  if (!parse_policy(text, policy, violations)) return std::nullopt;
  return policy;
}

}  // namespace dwell
