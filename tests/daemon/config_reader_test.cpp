#include <gmock/gmock.h>

#include <filesystem>

#include <google/protobuf/text_format.h>

#include "tests/daemon/support.hpp"

namespace dwell::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// One line a violation, as a user sees it.
std::vector<std::string> lines_of(const std::string& refusal) {
  std::vector<std::string> lines;
  std::istringstream input(refusal);
  for (std::string line; std::getline(input, line);) lines.push_back(line);
  return lines;
}

const std::string kRadar = "radar { name: \"r\" }\n";
const std::string kTarget = "target { name: \"t\" y_m: 50e3 }\n";

std::string print(const v1::Config& config) {
  std::string text;
  google::protobuf::TextFormat::PrintToString(config, &text);
  return text;
}

// --- syntax
// ---------------------------------------------------------------------------------------------------

TEST(ConfigReader, SyntaxErrorHasLineAndColumn) {
  EXPECT_EQ(refusal_of("seed: 1\nradar {\n  name \"r\"\n}\n"), "test:3:8: syntax: Expected \":\", found \"\"r\"\".");
  EXPECT_EQ(refusal_of("scan_period_s: 1\n  colour: 3\n"),
            "test:2:9: syntax: Message type \"dwell.v1.Config\" has no field named \"colour\".");
  EXPECT_EQ(violations_of("radar { name: \"r\" ")[0].line, 1);
}

TEST(ConfigReader, FieldGivenTwiceIsASyntaxError) {
  EXPECT_THAT(refusal_of("seed: 1\nseed: 2\n"), HasSubstr("test:2:"));
}

TEST(ConfigReader, EmptyTextLacksRadarAndTarget) {
  EXPECT_THAT(lines_of(refusal_of("")), ElementsAre("test: radar: one radar or linear_sensor at least is required",
                                                    "test: target: one target at least is required"));
}

TEST(ConfigReader, AllViolationsOfAFileAreListedAtOnce) {
  const std::string text = R"(scan_period_s: nan
radar { name: "r" beamwidth_deg: -1 }
radar { name: "r" x_m: inf }
linear_sensor { name: "c" c: [1, 2] }
target {
  leg { start_s: 1 }
  start { covariance: [1, 1, 1, -1] }
}
target { name: "t" recording { file: "no_such.csv" } }
tracker { gate: 0 bank { name: "none" } }
policy { sa_imm { nodes: 1 } }
stream { bind: "tcp://0.0.0.0:5556" }
)";
  EXPECT_THAT(
      lines_of(refusal_of(text)),
      ElementsAre(
          "test:1:1: scan_period_s = nan: must be in [0.001, 3600]",
          "test:10:26: tracker.bank.name = \"none\": must be one of: as_printed, "
          "cruise_and_turn, evans_practical, "
          "liu_hwang, manoeuvring",
          "test:10:11: tracker.gate = 0: must be > 0", "test:2:19: radar[1].beamwidth_deg = -1: must be in (0, 90]",
          "test:3:19: radar[2].x_m = inf: must be in [-1000000000, 1000000000]",
          "test:3:9: radar[2].name = \"r\": must be unique among the sensors",
          "test:4:27: linear_sensor[1].c = 2 values: must have 8 values",
          "test:4:1: linear_sensor[1].r: is required: 2 x 2 values, row-major", "test:5:1: target[1].name: is required",
          "test:6:3: target[1].leg[1].duration_s: is required",
          "test:7:11: target[1].start.covariance: must be symmetric and positive definite",
          "test:9:32: target[2].recording.file = \"no_such.csv\": cannot be read: " + kScenarios + "no_such.csv",
          "test:11:19: policy.sa_imm.nodes = 1: must be a whole number from 2 to 32",
          "test:12:10: stream.bind = \"tcp://0.0.0.0:5556\": must be ipc://PATH or "
          "tcp://127.x.x.x:PORT: there is no "
          "authentication"));
}

TEST(ConfigReader, MissingFileAndDirectoryAreRefused) {
  EXPECT_THROW((void)read_config_file("/no/such/file"), InvalidInput);
  EXPECT_THROW((void)read_config_file("/"), InvalidInput);
}

TEST(ConfigReader, UnknownEnumNumberOfAMessageIsRefused) {
  v1::Config message = config_of(kRadar + kTarget).effective;
  message.mutable_tracker()->set_update(static_cast<v1::Tracker::Update>(7));
  try {
    (void)read_config(message, "wire", ".");
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "wire: tracker.update = 7: must be one of: EKF, CONVERTED, CUBATURE");
  }
}

// --- names
// ----------------------------------------------------------------------------------------------------

TEST(ConfigReader, NamesAreUnique) {
  EXPECT_THAT(
      refusal_of("radar { name: \"a\" }\nlinear_sensor { name: \"a\" c: [1,0,0,0,0,0,1,0] r: [1,0,0,1] }\n" + kTarget),
      HasSubstr("test:2:17: linear_sensor[1].name = \"a\": must be unique among the sensors"));
  EXPECT_THAT(refusal_of(kRadar + kTarget + kTarget),
              HasSubstr("target[2].name = \"t\": must be unique among the targets"));
  EXPECT_THAT(refusal_of(kRadar + kTarget +
                         "tracker { bank { mode { name: \"m\" } mode { name: \"m\" } transition: [1, 0, 0, 1] } }"),
              HasSubstr("names must be unique in the bank"));
}

TEST(ConfigReader, NamesAreOneTo200PrintableCharacters) {
  const std::string rule = "must be 1 to 200 printable characters";
  for (const std::string& bad : {std::string(), std::string(201, 'x'), std::string("a\\nb"), std::string("\\x01")}) {
    const auto violations = violations_of("radar { name: \"" + bad + "\" }\n" + kTarget);
    ASSERT_EQ(violations.size(), 1) << bad;
    EXPECT_EQ(violations[0].rule, rule);
  }
  EXPECT_EQ(refusal_of("radar { name: \"" + std::string(200, 'x') + "\" }\n" + kTarget), "");
  EXPECT_EQ(refusal_of("radar { name: \"Münster\" }\n" + kTarget), "");
}

// --- sensors
// --------------------------------------------------------------------------------------------------

TEST(ConfigReader, ClutterIsLimitedByTheFootprint) {
  // 0.01 / (m rad) x 20 km x 1 rad = 200 plots a look; 100 times that is refused.
  const std::string footprint = " dwell_azimuth_deg: 28.6478897565412 dwell_range_m: 10e3 }\n";
  EXPECT_EQ(refusal_of("radar { name: \"r\" clutter_density: 0.01" + footprint + kTarget), "");
  EXPECT_THAT(refusal_of("radar { name: \"r\" clutter_density: 1" + footprint + kTarget),
              HasSubstr("must give at most 10000 false plots a look (density x footprint); gives 20000"));
}

TEST(ConfigReader, LinearSensorNeedsACovariance) {
  const auto with_r = [](const std::string& r) {
    return refusal_of("linear_sensor { name: \"c\" c: [1,0,0,0,0,0,1,0] r: " + r + " }\n" + kTarget);
  };
  EXPECT_EQ(with_r("[2, 1, 1, 2]"), "");
  for (const char* bad : {"[1, 2, 2, 1]", "[1, 0.1, 0, 1]", "[0, 0, 0, 1]", "[-1, 0, 0, -1]"}) {
    EXPECT_EQ(with_r(bad), "test:1:48: linear_sensor[1].r: must be symmetric and positive definite") << bad;
  }
}

// --- targets
// --------------------------------------------------------------------------------------------------

TEST(ConfigReader, StartIsAWholeNumberOfScanPeriods) {
  EXPECT_EQ(refusal_of(kRadar + "scan_period_s: 0.25\ntarget { name: \"t\" start_s: 0.75 }"), "");
  EXPECT_THAT(refusal_of(kRadar + "target { name: \"t\" start_s: 0.75 }"),
              HasSubstr("target[1].start_s = 0.75: must be a whole number of scan periods"));
}

TEST(ConfigReader, LegsDoNotOverlap) {
  const std::string one = "leg { start_s: 1 duration_s: 3 turn_rate_dps: 2 } ";
  EXPECT_EQ(refusal_of(kRadar + "target { name: \"t\" " + one + "leg { start_s: 4 duration_s: 1 } }"), "");
  EXPECT_THAT(refusal_of(kRadar + "target { name: \"t\" " + one + "leg { start_s: 3.5 duration_s: 1 } }"),
              HasSubstr("target[1].leg[2].start_s = 3.5: must not be before the end of the leg above"));
  EXPECT_THAT(
      refusal_of(kRadar + "target { name: \"t\" leg { start_s: 1 duration_s: 1 ax_mps2: 1 turn_rate_dps: 1 } }"),
      HasSubstr("must not stand with an acceleration"));
}

TEST(ConfigReader, OneKindOfTruthATarget) {
  const std::string recording = "recording { file: \"flights/flights.csv\" id: \"belevingsvlucht\" } ";
  const auto target = [](const std::string& fields) {
    return lines_of(refusal_of(kRadar + "target { name: \"t\" " + fields + "}"));
  };
  EXPECT_THAT(target(recording), IsEmpty());
  EXPECT_EQ(target(recording + "x_m: 1 altitude_m: 2 start_s: 3 leg { start_s: 1 duration_s: 1 } ").size(), 4);
  EXPECT_EQ(target(recording + "jump_markov {} ").size(), 1);
  EXPECT_EQ(
      target("jump_markov {} leg { start_s: 1 duration_s: 1 } process_noise { diagonal { b: [1,1,1,1] } } ").size(), 2);
  EXPECT_EQ(target("start { covariance: [1,1,1,1] first_plot {} } ").size(), 1);
}

TEST(ConfigReader, InitialModeIsOfItsBank) {
  EXPECT_EQ(refusal_of(kRadar + "target { name: \"t\" jump_markov { initial_mode: \"turn\" } }"), "");
  EXPECT_THAT(refusal_of(kRadar + "target { name: \"t\" jump_markov { initial_mode: \"climb\" } }"),
              HasSubstr("target[1].jump_markov.initial_mode = \"climb\": must be the name of a mode of its bank"));
}

// --- recordings
// -----------------------------------------------------------------------------------------------

class Recordings : public ::testing::Test {
 protected:
  /// The refusal of a config with a target of this recording.
  std::string refusal(const std::string& csv, const std::string& fields = "", int targets = 1) {
    write_file(directory_ / "f.csv", csv);
    std::string text = kRadar;
    for (int i = 0; i < targets; ++i) {
      text += "target { name: \"t" + std::to_string(i) + "\" recording { file: \"f.csv\" " + fields + "} }\n";
    }
    try {
      (void)read_config_text(text, "test", directory_.path());
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  }
  std::string csv() const { return (directory_ / "f.csv").string(); }

  static constexpr const char* kGood =
      "time_s,lat,lon,alt_m,id\n0,52,5,100,a\n1,52.001,5,100,a\n2,52.002,5,100,a\n3,52.003,5,100,a\n"
      "0,52,6,100,b\n1,52.001,6,100,b\n2,52.002,6,100,b\n3,52.003,6,100,b\n";

 private:
  TemporaryDirectory directory_;
};

TEST_F(Recordings, BadRowsAreReportedWithTheRecordingsFileAndLine) {
  const std::string refused = refusal("time_s,lat,lon,alt_m,id\n0,52,5,100,a\n1,95,5,x,a\n2,52\n", "", 2);
  EXPECT_THAT(lines_of(refused),
              ElementsAre("test: " + csv() + ":3: lat = 95: must be a number from -90 to 90",
                          "test: " + csv() + ":3: alt_m = x: must be a number from -1000000 to 1000000",
                          "test: " + csv() + ":4: row = 2,52: must have 5 columns: time_s,lat,lon,alt_m,id"));
}

TEST_F(Recordings, IdIsOfTheFile) {
  EXPECT_EQ(refusal(kGood, "id: \"b\" "), "");
  EXPECT_EQ(refusal(kGood), "test:2:21: target[1].recording.id: is required: the file has a, b");
  EXPECT_EQ(refusal(kGood, "id: \"c\" "), "test:2:47: target[1].recording.id = \"c\": must be one of the file's: a, b");
}

TEST_F(Recordings, BeginLeavesFourRows) {
  EXPECT_EQ(refusal(kGood, "id: \"a\" begin_s: 0 "), "");
  EXPECT_THAT(refusal(kGood, "id: \"a\" begin_s: 0.5 "), HasSubstr("must leave at least 4 rows of the recording"));
  EXPECT_THAT(refusal(kGood, "id: \"a\" begin_s: 3e9 "), HasSubstr("must leave at least 4 rows of the recording"));
}

TEST_F(Recordings, MissingFileIsReportedForEachTarget) {
  const auto violations =
      violations_of(kRadar + "target { name: \"a\" recording { file: \"x\" } }\n" +
                    "target { name: \"b\" recording { file: \"x\" } }\n" + "target { name: \"c\" recording { } }\n");
  ASSERT_EQ(violations.size(), 3);
  EXPECT_EQ(violations[0].line, 2);
  EXPECT_EQ(violations[1].line, 3);
  EXPECT_EQ(violations[2].rule, "is required");
}

// --- banks
// ----------------------------------------------------------------------------------------------------

std::string bank(const std::string& fields) {
  return refusal_of(kRadar + kTarget + "tracker { bank { " + fields + " } }");
}
const std::string kTwo = "mode { name: \"a\" } mode { name: \"b\" } ";

TEST(ConfigReader, UnknownBankListsTheKnown) {
  EXPECT_THAT(bank("name: \"cruise\""),
              HasSubstr("must be one of: as_printed, cruise_and_turn, evans_practical, liu_hwang, manoeuvring"));
}

TEST(ConfigReader, TrackSplittingHasNoTrailingStates) {
  EXPECT_EQ(refusal_of(kRadar + kTarget + "tracker { association: ITS }"), "");
  EXPECT_THAT(refusal_of(kRadar + kTarget +
                         "tracker { association: ITS bank { mode { name: \"a\" singer { sigma_mps2: 1 time_constant_s: "
                         "20 } } } }"),
              HasSubstr("must stand with a bank without trailing states"));
}

TEST(ConfigReader, TrackSplittingHasNoClasses) {
  EXPECT_THAT(refusal_of(kRadar + kTarget + "tracker { association: ITS } " +
                         "classes { class { name: \"a\" } class { name: \"b\" } }"),
              HasSubstr("must stand without classes"));
}

TEST(ConfigReader, ParticlesTakeTheNearestPlotInTheEkfForm) {
  const auto refused = [](const std::string& tracker) {
    return refusal_of(kRadar + kTarget + "tracker { particles {} " + tracker + " }");
  };
  EXPECT_EQ(refused(""), "");
  EXPECT_THAT(refused("association: PDA"), HasSubstr("tracker.particles: must stand with association NEAREST"));
  EXPECT_THAT(refused("update: CUBATURE"), HasSubstr("tracker.particles: must stand with update EKF"));
  EXPECT_THAT(refused("bank { mode { name: \"a\" singer { sigma_mps2: 1 time_constant_s: 20 } } }"),
              HasSubstr("must stand with a bank without guards and trailing states"));
}

TEST(ConfigReader, TransitionRowsSumToOne) {
  EXPECT_EQ(bank(kTwo + "transition: [.9, .1, .3, .7]"), "");
  EXPECT_EQ(bank(kTwo + "transition: [.3333333, .6666667, .3, .7]"), "") << "printed probabilities are rounded";
  EXPECT_THAT(bank(kTwo + "transition: [.9, .2, .3, .6]"),
              AllOf(HasSubstr("transition = row 1 sums to 1.1: rows must sum to 1"),
                    HasSubstr("transition = row 2 sums to 0.9: rows must sum to 1")));
  EXPECT_THAT(bank(kTwo + "transition: [.9, .1, .3]"), HasSubstr("3 values: must have 4 values"));
  EXPECT_THAT(bank(kTwo), HasSubstr("transition: is required with more than one mode"));
  EXPECT_THAT(bank(kTwo + "transition: [1, 0, 0, 1] initial_probability: [.5, .4]"),
              HasSubstr("initial_probability = row 1 sums to 0.9"));
}

TEST(ConfigReader, ModesWithMoreStatesHaveTheirOwnNoiseAndAreNoTruth) {
  const std::string singer = "mode { name: \"s\" singer { sigma_mps2: 5 time_constant_s: 20 } ";
  EXPECT_EQ(bank(singer + "}"), "");
  EXPECT_THAT(bank(singer + "process_noise { white_noise_acceleration: 1 } }"),
              HasSubstr("process_noise: must not stand with a motion that has its own noise"));
  EXPECT_THAT(bank("mode { name: \"s\" singer {} }"), HasSubstr("singer.sigma_mps2: is required"));
  EXPECT_THAT(refusal_of(kRadar + "target { name: \"t\" jump_markov { bank { " + singer + "} } } }"),
              HasSubstr("jump_markov.bank: must have modes of position and velocity alone"));
}

TEST(ConfigReader, GuardsAreCheckedAgainstTheirBank) {
  const auto guard = [](const std::string& fields) {
    return bank(kTwo + "transition: [1, 0, 0, 1] guard { " + fields + " }");
  };
  const std::string names = "from: \"a\" to: \"b\" ";
  EXPECT_EQ(guard(names + "l: [1, 0, 0, 0] b: 1"), "");
  EXPECT_EQ(guard(names + "l: [1, 0, 0, 0,  0, 1, 0, 0] b: [1, 2] noise: [1, 1, 1, 1]"), "") << "of rank one";
  EXPECT_THAT(guard("to: \"b\" l: [1, 0, 0, 0] b: 1"), HasSubstr("guard[1].from: is required"));
  EXPECT_THAT(guard("from: \"c\" to: \"b\" l: [1, 0, 0, 0] b: 1"),
              HasSubstr("guard[1].from = \"c\": must be the name of a mode of the bank"));
  EXPECT_THAT(guard("from: \"b\" to: \"b\" l: [1, 0, 0, 0] b: 1"),
              HasSubstr("guard[1].to = \"b\": must be another mode than from"));
  EXPECT_THAT(guard(names + "l: [1, 0, 0, 0]"), HasSubstr("guard[1].b = 0 values: must have 1 to 8 values"));
  EXPECT_THAT(guard(names + "b: 1"), HasSubstr("guard[1].l: is required: 4 values for each of b"));
  EXPECT_THAT(guard(names + "l: [1, 0, 0, 0] b: [1, 2]"), HasSubstr("guard[1].l = 4 values: must have 8 values"));
  EXPECT_THAT(guard(names + "l: [1, 0, 0, 0] b: 1 noise: -1"),
              HasSubstr("guard[1].noise: must be symmetric and positive semidefinite"));
}

TEST(ConfigReader, ChainWithoutAGeneratorIsRefusedForOtherIntervals) {
  // It swaps the modes every second: no chain of continuous time does.
  const std::string swap = kTwo + "transition: [0, 1, 1, 0]";
  EXPECT_EQ(bank(swap), "");
  EXPECT_THAT(refusal_of(kRadar + kTarget + "scan_period_s: 0.5 tracker { bank { " + swap + " } }"),
              HasSubstr("tracker.bank.transition: has no root for a scan period"));
}

TEST(ConfigReader, BankHasAtMostSixteenModes) {
  std::string modes, ones, rows;
  for (int i = 0; i < 17; ++i) {
    modes += "mode { name: \"" + std::to_string(i) + "\" } ";
    for (int j = 0; j < 17; ++j) rows += std::string(i + j > 0 ? ", " : "") + (i == j ? "1" : "0");
  }
  EXPECT_EQ(bank(modes + "transition: [" + rows + "]"), "test:3:18: tracker.bank.mode = 17 modes: must be at most 16");
}

TEST(ConfigReader, FieldsOfABankThatWouldBeIgnoredAreRefused) {
  for (const std::string field :
       {"mode { name: \"m\" }", "transition: 1", "initial_probability: 1", "transition_interval_s: 2"}) {
    EXPECT_THAT(lines_of(bank("name: \"as_printed\" " + field)),
                ElementsAre("test:3:18: tracker.bank.name = \"as_printed\": must stand alone: the named bank has its "
                            "modes and its chain"))
        << field;
  }
  for (const std::string field : {"transition: 1", "initial_probability: 1", "transition_interval_s: 2", "guard {}"}) {
    EXPECT_THAT(lines_of(bank(field)),
                ElementsAre("test:3:11: tracker.bank.mode: is required where the chain of a bank is given"))
        << field;
  }
}

TEST(ConfigReader, NoiseStepsDivideTheScanPeriod) {
  const auto step = [](const std::string& s) {
    return bank("mode { name: \"a\" process_noise { piecewise_acceleration: 1 step_s: " + s + " } }");
  };
  EXPECT_EQ(step("0.25"), "");
  for (const char* bad : {"0.3", "2", "3600"}) EXPECT_THAT(step(bad), HasSubstr("must divide scan_period_s")) << bad;
  EXPECT_THAT(refusal_of(kRadar + kTarget + "scan_period_s: 1.5 tracker { bank { name: \"as_printed\" } }"),
              HasSubstr("must divide scan_period_s"));
}

// --- endpoints
// ------------------------------------------------------------------------------------------------

TEST(ConfigReader, EndpointsAreOfThisMachineAlone) {
  const auto refused = [](const std::string& bind) {
    return !violations_of(kRadar + kTarget + "stream { bind: \"" + bind + "\" }").empty() &&
           !violations_of(kRadar + kTarget + "control { bind: \"" + bind + "\" }").empty();
  };
  for (const char* good : {"ipc:///run/dwell", "ipc://@abstract", "tcp://127.0.0.1:0", "tcp://127.0.0.1:65535",
                           "tcp://127.255.0.9:5556"}) {
    EXPECT_FALSE(refused(good)) << good;
  }
  for (const char* bad : {"",
                          "ipc://",
                          "tcp://*:5556",
                          "tcp://0.0.0.0:5556",
                          "tcp://192.168.0.1:5556",
                          "tcp://eth0:5556",
                          "tcp://127.0.0.1",
                          "tcp://127.0.0.1:",
                          "tcp://127.0.0.1:65536",
                          "tcp://127.0.0.1:99999999999",
                          "tcp://127.0.0.1:*",
                          "tcp://127.0.0.1:-1",
                          "tcp://127.0.0.1:+5",
                          "tcp://127.0.0.1:05",
                          "tcp://127.0.0.1.example.org:1",
                          "tcp://127.0.0.1;0.0.0.0:5556",
                          "tcp://[::]:5556",
                          "tcp://localhost:5556",
                          "inproc://x",
                          "udp://127.0.0.1:1",
                          "tcp:/127.0.0.1:1",
                          " tcp://127.0.0.1:1"}) {
    EXPECT_TRUE(refused(bad)) << bad;
  }
}

// --- the effective config
// -------------------------------------------------------------------------------------

/// What two runs publish is the same to the last bit.
void expect_same_stream(const DaemonConfig& a, const DaemonConfig& b, int scans) {
  RecordedRun first(a);
  RecordedRun second(b);
  first.scan(scans);
  second.scan(scans);
  EXPECT_TRUE(first.stream.bytes == second.stream.bytes);
}

TEST(EffectiveConfig, OfEveryScenarioIsAFixedPointAndTheSameRun) {
  int scenarios = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kScenarios)) {
    if (entry.path().extension() != ".textproto") continue;
    SCOPED_TRACE(entry.path());
    ++scenarios;
    const DaemonConfig config = read_config_file(entry.path());
    const DaemonConfig again = config_of(print(config.effective));
    EXPECT_EQ(print(again.effective), print(config.effective));
    expect_same_stream(config, again, 20);
  }
  EXPECT_GE(scenarios, 4);
}

TEST(EffectiveConfig, OfAnyBeamwidthGivesTheSameFigures) {
  RandomStream random(3);
  for (int i = 0; i < 1000; ++i) {
    const std::string beamwidth = std::to_string(random.uniform(0.01, 60.0));
    const DaemonConfig config = config_of("radar { name: \"r\" beamwidth_deg: " + beamwidth + " }\n" + kTarget);
    const DaemonConfig again = config_of(print(config.effective));
    const auto& figures = std::get<RadarFigures>(config.engine.sensors[0].figures);
    const auto& figures_again = std::get<RadarFigures>(again.engine.sensors[0].figures);
    ASSERT_EQ(figures.dwell_azimuth_rad, figures_again.dwell_azimuth_rad) << beamwidth;
    ASSERT_EQ(figures.beamwidth_rad, figures_again.beamwidth_rad) << beamwidth;
    ASSERT_EQ(figures.snr_reference, figures_again.snr_reference);
  }
}

TEST(EffectiveConfig, WritesEveryDefaultOut) {
  const std::string text = print(config_of(kRadar + kTarget).effective);
  for (const char* line : {"scan_period_s: 1\n",
                           "seed: 1\n",
                           "looks_per_scan: 1\n",
                           "beamwidth_deg: 1\n",
                           "pulse_length_s: 5e-08\n",
                           "snr_reference_db: 50\n",
                           "reference_range_m: 100000\n",
                           "range_noise_floor_m: 0\n",
                           "azimuth_noise_floor_deg: 0\n",
                           "max_range_m: inf\n",
                           "sector_width_deg: 360\n",
                           "dwell_azimuth_deg: 3\n",
                           "dwell_range_m: 10000\n",
                           "usage_cost: 0\n",
                           "down: false\n",
                           "weight: 1\n",
                           "update: EKF\n",
                           "gate: 16\n",
                           "lost_probability: 1e-08\n",
                           "lost_sigma_m: 20000\n",
                           "lost_squared_distance: 9\n",
                           "name: \"cruise_and_turn\"\n",
                           "cost: POSITION\n",
                           "nodes: 5\n",
                           "high_water_mark: 100000\n",
                           "bind: \"tcp://127.0.0.1:5556\"\n",
                           "bind: \"tcp://127.0.0.1:5557\"\n",
                           "covariance: 10000\n"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
}

TEST(EffectiveConfig, SurvivesTheJournal) {
  TemporaryDirectory directory;
  const DaemonConfig config = config_of(kBusy);
  v1::JournalHeader header;
  *header.mutable_config() = config.effective;
  { JournalWriter writer(directory / "journal", header); }
  const Journal journal = read_journal(directory / "journal");
  const DaemonConfig again = read_config(journal.header.config(), "journal", ".");
  EXPECT_EQ(print(again.effective), print(config.effective));
  expect_same_stream(config, again, 200);
}

TEST(Budget, IsRefusedWhereItCannotBeMeant) {
  const auto with = [](const std::string& budget) {
    return refusal_of("radar { name: \"r\" budget { " + budget + " } }\n" + kTarget);
  };
  EXPECT_EQ(with("looks: 3 window_s: 10"), "");
  EXPECT_EQ(with("looks: 3 horizon_s: 10 spread: FREE"), "");
  EXPECT_THAT(with("window_s: 10"), HasSubstr("budget.looks"));
  EXPECT_THAT(with("looks: 3"), HasSubstr("one of window_s, horizon_s is required"));
  EXPECT_THAT(with("looks: 3 window_s: 10.5"), HasSubstr("must be a whole number of scan periods"));
  EXPECT_THAT(with("looks: 10 window_s: 10"), HasSubstr("must be less than the 10 scans of window_s"));
}

}  // namespace
}  // namespace dwell::testing
