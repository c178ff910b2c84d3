#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/server/host_fixture.hpp"

namespace cycloid::server {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A host with a room "arena" and a folder for reports, and a client in it whose digests are wrong.
class HostDesync : public testing::Test {
 protected:
  void SetUp() override {
    std::string made = (fs::temp_directory_path() / "cycloid-reports-XXXXXX").string();
    ASSERT_NE(::mkdtemp(made.data()), nullptr);
    folder_ = made;
    HostOptions options = quiet_host(lines_);
    options.desync_directory = folder_.string();
    options.rooms.push_back({"arena", two_seat_settings()});
    running_.emplace(std::move(options));
    peer_.emplace(running_->port());
    peer_->greet("arena");
    ASSERT_TRUE(peer_->wait_for<protocol::Welcome>());
    const auto digest = peer_->wait_for<protocol::Digest>();
    ASSERT_TRUE(digest);
    tick_ = digest->tick;
    peer_->send(protocol::Digest{tick_, 0xbad});
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// The one report that there is once the host has ended.
  std::string only_report() {
    running_->stop();
    (void)running_->report();
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().extension() == ".json") found.push_back(entry.path());
    }
    EXPECT_EQ(found.size(), 1u);
    if (found.size() != 1) return "";
    std::ostringstream text;
    text << std::ifstream(found[0]).rdbuf();
    return text.str();
  }

  fs::path folder_;
  HostLines lines_;
  std::optional<RunningHost> running_;
  std::optional<HostPeer> peer_;
  std::uint64_t tick_ = 0;
};

TEST_F(HostDesync, IsReportedToTheFolderTheLogAndTheClient) {
  peer_->send(protocol::TickDigests{tick_, {0xbad}});
  const auto wanted = peer_->wait_for<protocol::StateWanted>();
  ASSERT_TRUE(wanted);
  EXPECT_EQ(wanted->tick, tick_);
  peer_->send(protocol::StatePart{tick_, 100, 0, std::vector<std::byte>(100)});
  std::optional<protocol::RoomNotice> notice;
  do {
    notice = peer_->wait_for<protocol::RoomNotice>();
  } while (notice && notice->kind != protocol::NoticeKind::kReport);
  ASSERT_TRUE(notice) << "the report comes from another thread";
  EXPECT_EQ(notice->tick, tick_);
  EXPECT_THAT(only_report(), HasSubstr("\"noticed_tick\": " + std::to_string(tick_)));
  EXPECT_THAT(lines_.text(), HasSubstr("room arena: client 1: " + notice->text + "; report " +
                                       (folder_ / "desync-arena-tick-").string()));
}

TEST_F(HostDesync, IsReportedWhereTheMatchEndsAtOnce) {
  const auto room = running_->host().find("arena");
  ASSERT_TRUE(eventually([&] { return room->meters().desyncs.get() == 1; }));
  EXPECT_THAT(only_report(), HasSubstr("the match ended before it had sent its state"));
  EXPECT_THAT(lines_.text(), HasSubstr("room arena: client 1: "));
}

}  // namespace
}  // namespace cycloid::server
