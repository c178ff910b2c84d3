#ifdef CYCLOID_NETWORK

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "server/desync/report.hpp"
#include "tests/cli/logs.hpp"
#include "tests/cli/program.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

/// A log of a run, and reports of its tick 30 as a server writes them.
class RepeatedReport : public testing::Test {
 protected:
  static constexpr std::uint64_t kTick = 30;

  /// @param keyframe_every  29: the log has the state of the tick before.
  void write_log(const std::string& keyframe_every) {
    const Ran ran = run_program({"run", "wall", "--ticks", "40", "--keyframe-every", keyframe_every,
                                 "--log", folder_.file("match.cylog")});
    ASSERT_EQ(ran.exit, 0) << ran.err;
  }
  std::string report(std::uint64_t client_digest) const {
    const std::string text = read_text(folder_.file("match.cylog"));
    const protocol::Log log = protocol::read_log(std::as_bytes(std::span(text)));
    auto found = scenes::find("wall");
    server::DesyncReport report;
    report.room.scene = std::make_shared<const scenes::Scene>(std::move(*found.scene));
    report.tick = kTick;
    report.server_digest = log.ticks[kTick - 1].digest;
    report.client_digest = client_digest;
    write_text(folder_.file("r.json"),
               server::report_json_text(report, {"r.json", "match.cylog", ""}));
    return folder_.file("r.json");
  }
  static Ran repeat_wrongly(const std::string& report, bool json) {
    std::vector<std::string> arguments = {"desync", "repeat", report};
    if (json) arguments.emplace_back("--json");
    return run_other(places::wrong_friction_program(), arguments);
  }

  const Folder folder_;
};

TEST_F(RepeatedReport, BeginsWithTheStateOfTheTickBeforeAndAgreesWithTheClientsBuild) {
  write_log("29");
  const Ran neither = repeat_wrongly(report(1), true);
  EXPECT_EQ(neither.exit, 1) << neither.err;
  EXPECT_EQ(neither.json()["from_tick"], kTick - 1);
  EXPECT_EQ(neither.json()["parted_tick"], nullptr);
  EXPECT_EQ(neither.json()["agrees_with"], "neither");

  const auto client = std::stoull(neither.json()["digest"].get<std::string>(), nullptr, 16);
  const std::string file = report(client);
  const Ran with_client = repeat_wrongly(file, false);
  EXPECT_EQ(with_client.exit, 1);
  EXPECT_THAT(with_client.out, HasSubstr("made again from tick 29:"));
  EXPECT_THAT(with_client.out, HasSubstr("agrees with the client; to go on: cycloid bisect "));
  EXPECT_EQ(run_program({"desync", "repeat", file}).exit, 0) << "the server's build";
}

TEST_F(RepeatedReport, WithoutThatStateSaysWhereTheBuildLeavesTheMatch) {
  write_log("0");
  const std::string file = report(1);
  const nlohmann::json parted = repeat_wrongly(file, true).json();
  EXPECT_EQ(parted["from_tick"], 0);
  ASSERT_TRUE(parted["parted_tick"].is_number()) << parted;
  EXPECT_LT(parted["parted_tick"], kTick);
  EXPECT_THAT(repeat_wrongly(file, false).out,
              HasSubstr("agrees with neither: it leaves the recorded match at tick " +
                        parted["parted_tick"].dump() + " already; to go on: cycloid bisect "));
  EXPECT_EQ(run_program({"desync", "repeat", file}).exit, 0) << "the server's build";
}

}  // namespace
}  // namespace cycloid::cli

#endif  // CYCLOID_NETWORK
