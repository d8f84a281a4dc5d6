#include "daemon/stream.hpp"

#include <map>
#include <set>

#include "tests/daemon/support.hpp"

namespace dwell::testing {
namespace {

std::string first_word(const std::string& topic) { return topic.substr(0, topic.find('.')); }

TEST(Stream, SequencesHaveNoGapsOverAllTopicsAndWithinEach) {
  RecordedRun recorded(config_of(kBusy));
  v1::Request request;
  for (int i = 0; i < 300; ++i) {
    recorded.run.scan();
    if (i % 7 == 0) recorded.run.publish_status(nullptr);
    if (i % 50 != 0) continue;
    request.set_id(std::to_string(i));
    request.mutable_set_policy()->set_text(i % 100 == 0 ? "fixed" : "sa_imm");
    (void)recorded.run.handle(request);
    request.mutable_set_radar()->set_name("east");
    request.mutable_set_radar()->set_up(i % 100 == 0);
    request.set_id(std::to_string(i) + "r");
    (void)recorded.run.handle(request);
  }
  recorded.run.publish_end("done");
  std::uint64_t sequence = 0;
  std::map<std::string, std::uint64_t> topic_sequence;
  for (std::size_t i = 0; i < recorded.stream.topics.size(); ++i) {
    const std::string& topic = recorded.stream.topics[i];
    const v1::Envelope& envelope = recorded.stream.envelopes[i];
    EXPECT_EQ(topic.back(), '.');
    EXPECT_EQ(envelope.sequence(), ++sequence);
    EXPECT_EQ(envelope.topic_sequence(), ++topic_sequence[first_word(topic)]);
    EXPECT_EQ(envelope.epoch(), 1);
  }
  EXPECT_EQ(topic_sequence.size(), 8) << "track, scan, plot, status, policy, radar, calibration, end";
  EXPECT_EQ(topic_sequence["scan"], 300);
  EXPECT_EQ(topic_sequence["end"], 1);
}

TEST(Stream, TopicTellsTheBody) {
  RecordedRun recorded(config_of(kBusy));
  recorded.scan(20);
  for (std::size_t i = 0; i < recorded.stream.topics.size(); ++i) {
    const v1::Envelope& envelope = recorded.stream.envelopes[i];
    const std::string& topic = recorded.stream.topics[i];
    EXPECT_EQ(topic == "scan.", envelope.has_scan_report());
    EXPECT_EQ(topic == "plot.", envelope.has_plot());
    EXPECT_EQ(topic == "track." + std::to_string(envelope.track().id()) + ".", envelope.has_track());
  }
}

TEST(Stream, ScanIsItsTracksThenItsPlotsThenItsReport) {
  RecordedRun recorded(config_of(kBusy));
  recorded.scan(100);
  const std::vector<std::string> order{"track", "plot", "scan"};
  std::size_t stage = 0;
  std::uint64_t scan = 0;
  std::size_t plots = 0;
  for (std::size_t i = 0; i < recorded.stream.topics.size(); ++i) {
    const std::string word = first_word(recorded.stream.topics[i]);
    if (word == "calibration") {  // before the first of a scan
      EXPECT_EQ(stage, 0);
      continue;
    }
    while (stage < order.size() && order[stage] != word) ++stage;
    ASSERT_LT(stage, order.size()) << "message " << i;
    if (word == "plot") ++plots;
    if (word != "scan") continue;
    const v1::ScanReport& report = recorded.stream.envelopes[i].scan_report();
    EXPECT_EQ(report.scan(), ++scan);
    EXPECT_EQ(recorded.stream.envelopes[i].time_ns(), static_cast<std::int64_t>(scan) * 1'000'000'000);
    std::size_t told = 0;
    for (const v1::Look& look : report.look()) told += look.plots();
    EXPECT_EQ(told, plots);
    stage = plots = 0;
  }
}

/// The wire says for each plot whether it was used; the report says which; both mean the same.
TEST(Stream, UsedPlotsOfReportAndPlotsAgree) {
  RecordedRun recorded(config_of(kBusy));
  recorded.scan(200);
  std::set<std::uint32_t> used;
  int looks_with_plot = 0;
  for (const v1::Envelope& envelope : recorded.stream.envelopes) {
    if (envelope.has_plot() && envelope.plot().used()) used.insert(envelope.plot().number());
    if (!envelope.has_scan_report()) continue;
    for (const v1::Look& look : envelope.scan_report().look()) {
      EXPECT_EQ(used, look.has_used_plot() ? std::set{look.used_plot()} : std::set<std::uint32_t>{});
      EXPECT_EQ(look.has_nis(), look.has_used_plot());
      looks_with_plot += look.has_used_plot() ? 1 : 0;
    }
    used.clear();
  }
  EXPECT_GT(looks_with_plot, 100);
}

}  // namespace
}  // namespace dwell::testing
