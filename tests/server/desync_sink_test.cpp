#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include "server/desync/report_sink.hpp"
#include "tests/server/kept_evidence.hpp"
#include "tests/server/log_disks.hpp"
#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ReportSinkTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string made = (fs::temp_directory_path() / "cycloid-sink-XXXXXX").string();
    ASSERT_NE(::mkdtemp(made.data()), nullptr);
    folder_ = made;
    auto identity = std::make_shared<RoomIdentity>();
    identity->room = "../a b";
    identity->scene = std::make_shared<const scenes::Scene>(two_seat_scene());
    identity->scene_digest = scenes::scene_digest(*identity->scene);
    identity->build = "their server";
    finding_.room = identity;
    finding_.client = {5, "gu\x1b[2Jest", "their client", 1};
    scenes::Simulation simulation = simulation_of(*identity->scene);
    KeptEvidence evidence(10, simulation);
    for (std::uint64_t tick = 1; tick <= 40; ++tick) {
      protocol::InputFrame frame;
      frame.tick = tick;
      frame.seats = {{protocol::Origin::kGiven, push(100)}, {protocol::Origin::kRepeated, {}}};
      std::vector<scenes::SeatInput> inputs = {push(100), {}};
      ASSERT_TRUE(simulation.step(inputs).ok());
      evidence.add(frame, simulation);
      if (tick >= 17) finding_.ticks.push_back({frame, simulation.digest()});
      if (tick == 25) simulation.encode(finding_.client_state);
    }
    finding_.client_state[finding_.client_state.size() / 2] ^= std::byte{1};
    finding_.tick = 25;
    finding_.is_first = true;
    finding_.noticed_tick = 30;
    finding_.server_digest = *evidence.digest_at(25);
    const auto start = evidence.state_at_or_before(24);
    finding_.start = KeptState{start->tick(), start->digest(), {start, &start->bytes()}};
  }
  void TearDown() override { fs::remove_all(folder_); }

  ReportSinkOptions options() {
    ReportSinkOptions options;
    options.folder = folder_.string();
    options.now_ns = [this] { return now_; };
    return options;
  }
  std::size_t files(const std::string& ending) const {
    std::size_t found = 0;
    for (const auto& entry : fs::directory_iterator(folder_))
      found += entry.path().extension() == ending ? 1 : 0;
    return found;
  }
  static std::string text_of(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }

  fs::path folder_;
  Finding finding_;
  std::int64_t now_ = 1;
};

TEST_F(ReportSinkTest, WritesJsonTextAndALogThatBeginsAtAKeyframe) {
  ReportSink sink(options());
  DesyncReport report;
  const auto written = sink.publish(finding_, &report);
  ASSERT_EQ(written.error, "");
  EXPECT_EQ(fs::path(written.report).filename(), "desync-___a_b-tick-25-peer-5.json");
  const std::string json = text_of(written.report);
  EXPECT_THAT(json, HasSubstr("\"schema_version\": 1"));
  EXPECT_THAT(json, HasSubstr("\"repeat\": \"cycloid desync repeat desync-___a_b-tick-25-"));
  std::string error;
  const auto text = report_as_text(json, error);
  ASSERT_TRUE(text) << error;
  EXPECT_THAT(*text, HasSubstr("tick 25, the first that differs; noticed at tick 30"));
  EXPECT_THAT(*text, HasSubstr("their server"));
  EXPECT_EQ(text->find('\x1b'), std::string::npos);
  EXPECT_EQ(text_of(fs::path(written.report).replace_extension(".txt")), *text);

  const std::string bytes = text_of(fs::path(written.report).replace_extension(".cylog"));
  const protocol::Log log = protocol::read_log(std::as_bytes(std::span(bytes)));
  EXPECT_EQ(log.state, protocol::LogState::kComplete) << log.reason;
  EXPECT_EQ(log.header.branch_tick, 20u);
  EXPECT_EQ(log.header.room, "../a b");
  EXPECT_EQ(log.last_tick, 40u);
  ASSERT_EQ(log.keyframes.size(), 2u);
  EXPECT_EQ(log.keyframes[0].tick, 20u);
  EXPECT_EQ(log.keyframes[1].tick, 24u) << "the client's build goes from there, not from 20";
  EXPECT_EQ(log.ticks[4].digest, finding_.server_digest);
}

TEST_F(ReportSinkTest, TheLogHasNoStateThatTheServerDidNotHave) {
  finding_.ticks[22 - 17].digest ^= 1;  // So that tick 22, made again, is not the server's.
  ReportSink sink(options());
  const auto written = sink.publish(finding_);
  ASSERT_EQ(written.error, "");
  const std::string bytes = text_of(fs::path(written.report).replace_extension(".cylog"));
  const protocol::Log log = protocol::read_log(std::as_bytes(std::span(bytes)));
  EXPECT_EQ(log.state, protocol::LogState::kComplete) << log.reason;
  EXPECT_EQ(log.keyframes.size(), 1u);
}

TEST_F(ReportSinkTest, IsBoundedByTheHourAndByTheFolder) {
  ReportSinkOptions bounded = options();
  bounded.reports_per_hour = 2;
  bounded.reports_max = 3;
  ReportSink sink(bounded);
  EXPECT_NE(sink.publish(finding_).report, "");
  EXPECT_NE(sink.publish(finding_).report, "");
  EXPECT_THAT(sink.publish(finding_).error, HasSubstr("2 reports in this hour"));
  now_ += 3'600'000'000'000;
  EXPECT_NE(sink.publish(finding_).report, "");
  EXPECT_THAT(sink.publish(finding_).error, HasSubstr("3 reports, of at most 3"));
  EXPECT_EQ(sink.dropped(), 2u);
  EXPECT_EQ(files(".json"), 3u);
  EXPECT_EQ(files(".cylog"), 3u);
}

TEST_F(ReportSinkTest, SaysWhyThereIsNoLogOrNoReport) {
  ReportSink sink(options());
  finding_.start.reset();
  const auto written = sink.publish(finding_);
  ASSERT_NE(written.report, "");
  EXPECT_EQ(files(".cylog"), 0u);
  EXPECT_THAT(text_of(written.report), HasSubstr("no longer has the state and the frames"));

  ReportSinkOptions nowhere = options();
  nowhere.folder = written.report + "/below-a-file";
  ReportSink lost(nowhere);
  EXPECT_NE(lost.publish(finding_).error, "");
  EXPECT_EQ(lost.dropped(), 1u);
}

TEST_F(ReportSinkTest, ManyAtOnceWriteOneReportEach) {
  ReportSinkOptions many = options();
  many.reports_per_hour = 100;
  ReportSink sink(many);
  constexpr int kThreads = 4;
  constexpr int kReports = 8;
  std::vector<std::vector<std::string>> reports(kThreads);
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      for (int j = 0; j < kReports; ++j) reports[i].push_back(sink.publish(finding_).report);
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::set<std::string> names;
  for (const auto& of_thread : reports) names.insert(of_thread.begin(), of_thread.end());
  EXPECT_EQ(names.size(), std::size_t{kThreads * kReports});
  EXPECT_FALSE(names.contains("")) << "none was refused";
  for (const std::string& name : names) {
    std::string error;
    const auto text = report_as_text(text_of(name), error);
    ASSERT_TRUE(text) << name << ": " << error;
    EXPECT_EQ(text_of(fs::path(name).replace_extension(".txt")), *text);
    EXPECT_THAT(*text, HasSubstr(fs::path(name).stem().string() + ".cylog"));
  }
  EXPECT_EQ(files(".cylog"), std::size_t{kThreads * kReports});
}

TEST_F(ReportSinkTest, AReportThatDoesNotFitLeavesNothing) {
  for (const int good : {0, 1, 2}) {
    const auto disk = std::make_shared<ScriptedDisk>();
    int writes = 0;
    disk->on_write = [&](int file, std::span<const std::byte> bytes, std::size_t& written) {
      return writes++ == good ? ENOSPC : system_disk()->write(file, bytes, written);
    };
    ReportSinkOptions full = options();
    full.disk = disk;
    ReportSink sink(full);
    const auto written = sink.publish(finding_);
    if (good == 0) {  // Of the log, which is not the report.
      EXPECT_EQ(written.error, "");
      EXPECT_THAT(text_of(written.report), HasSubstr("No space left on device"));
      fs::remove(written.report);
      fs::remove(fs::path(written.report).replace_extension(".txt"));
      continue;
    }
    EXPECT_EQ(written.report, "");
    EXPECT_THAT(written.error, HasSubstr(good == 1 ? ".json: No space left" : ".txt: No space"));
    EXPECT_EQ(sink.dropped(), 1u);
    EXPECT_TRUE(fs::is_empty(folder_)) << "after " << good << " files";
  }
}

TEST_F(ReportSinkTest, WhatIsThereIsNeverWrittenOver) {
  const fs::path there = folder_ / "desync-___a_b-tick-25-peer-5.cylog";
  std::ofstream(there) << "of somebody else";
  ReportSink sink(options());
  const auto written = sink.publish(finding_);
  EXPECT_EQ(fs::path(written.report).filename(), "desync-___a_b-tick-25-peer-5-2.json");
  EXPECT_EQ(text_of(there), "of somebody else");
}

TEST(DesyncReportText, RefusesWhatIsNoReport) {
  for (const char* json : {"", "[]", "{}", "{\"schema_version\": 2, \"kind\": \"desync\"}",
                           "{\"schema_version\": 1, \"kind\": \"desync\"}"}) {
    std::string error;
    EXPECT_FALSE(report_as_text(json, error)) << json;
    EXPECT_NE(error, "") << json;
  }
}

}  // namespace
}  // namespace cycloid::server
