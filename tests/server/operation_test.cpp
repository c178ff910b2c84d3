#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <vector>

#include "server/operation/admin_fields.hpp"
#include "tests/server/operation_fixture.hpp"

namespace cycloid::server {
namespace {

using namespace std::chrono_literals;

TEST_F(OperationTest, MetricsAreWhatPrometheusReads) {
  open();
  HostPeer peer(server_->port());
  peer.greet("arena");
  ASSERT_TRUE(peer.wait_for<protocol::Welcome>());
  HostPeer stranger(server_->port());
  stranger.greet("nowhere");
  ASSERT_TRUE(stranger.wait_for<protocol::Refused>());
  const auto room = server_->host().find("arena");
  ASSERT_TRUE(eventually(
      [&] { return room->meters().tick.get() >= 10 && room->meters().clients.get() == 1; }));
  const Answer answer = get("/metrics");
  ASSERT_EQ(answer.status, 200);
  EXPECT_NE(answer.head.find("text/plain; version=0.0.4"), std::string::npos);

  const std::regex kSample(
      R"re(^([a-z_]+)(\{([a-z_]+="[^"]*",?)+\})? (-?[0-9.e+-]+|\+Inf|NaN)$)re");
  std::set<std::string> typed;
  std::map<std::string, double> values;
  std::istringstream lines(answer.body);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string mark, keyword, name;
    if (line.starts_with("#")) {
      words >> mark >> keyword >> name;
      if (keyword == "TYPE") {
        EXPECT_TRUE(typed.insert(name).second) << "twice: " << name;
      }
      continue;
    }
    std::smatch match;
    ASSERT_TRUE(std::regex_match(line, match, kSample)) << line;
    std::string family = match[1];
    for (const char* suffix : {"_bucket", "_sum", "_count"}) {
      const std::string base = family.substr(0, family.rfind(suffix));
      if (family.ends_with(suffix) && typed.contains(base)) family = base;
    }
    EXPECT_TRUE(typed.contains(family)) << line;
    values[match[1].str() + match[2].str()] = std::stod(match[4]);
  }
  EXPECT_GE(values.at("cycloid_room_tick{room=\"arena\"}"), 10.0);
  EXPECT_EQ(values.at("cycloid_room_clients{room=\"arena\"}"), 1.0);
  EXPECT_EQ(values.at("cycloid_rooms{stage=\"running\"}"), 1.0);
  EXPECT_EQ(values.at("cycloid_refusals_total{room=\"\",code=\"no_such_room\"}"), 1.0);
  EXPECT_GE(values.at("cycloid_room_tick_lateness_seconds_count{room=\"arena\"}"), 10.0);
  EXPECT_GE(values.at("cycloid_room_tick_seconds_count{room=\"arena\"}"), 10.0);
  for (const char* name :
       {"cycloid_room_inputs_replaced_total", "cycloid_room_hash_mismatches_total",
        "cycloid_room_desync_inquiries_skipped_total", "cycloid_desync_reports_dropped_total",
        "cycloid_room_queue_bytes", "cycloid_room_catch_up_ticks_total",
        "cycloid_room_slowed_seconds_total", "cycloid_room_encodes_total",
        "cycloid_log_sync_seconds", "cycloid_connections"}) {
    EXPECT_TRUE(typed.contains(name)) << name;
  }
  const double least = values.at("cycloid_room_tick_seconds_bucket{room=\"arena\",le=\"5e-05\"}");
  EXPECT_LE(least, values.at("cycloid_room_tick_seconds_bucket{room=\"arena\",le=\"+Inf\"}"));
}

TEST_F(OperationTest, LivezFailsWhileATickIsStuckAndReadyzWhileDraining) {
  const std::string log =
      testing::TempDir() + "cycloid-livez-" + std::to_string(::getpid()) + ".log";
  std::filesystem::remove(log);
  std::atomic<bool> hangs{false};
  open(waiting_host(lines_, log, hangs));
  EXPECT_TRUE(eventually([&] { return get("/livez").status == 200; }));
  EXPECT_EQ(get("/readyz").status, 200);
  hangs = true;
  EXPECT_TRUE(eventually([&] {
    const Answer answer = get("/livez");
    return answer.status == 503 && answer.body.find("room arena is") != std::string::npos;
  }));
  EXPECT_EQ(get("/metrics").status, 200);  // A scrape does not wait for the tick.
  hangs = false;
  EXPECT_TRUE(eventually([&] { return get("/livez").status == 200; }));
  HostPeer peer(server_->port());
  peer.greet("arena");
  ASSERT_TRUE(peer.wait_for<protocol::Welcome>());
  EXPECT_EQ(post("/admin/drain", R"({"deadline_ms": 60000})").status, 202);
  EXPECT_TRUE(eventually([&] { return get("/readyz").status == 503; }));
  EXPECT_TRUE(eventually([&] { return get("/livez").status == 200; }));
  peer.hang_up();
  (void)close();
  std::filesystem::remove(log);
}

TEST_F(OperationTest, AnAdminSteersRoomsAndEveryActIsOnRecord) {
  open();
  EXPECT_EQ(post("/admin/rooms", R"({"name": "duel-1", "template": "hall"})").status, 201);
  HostPeer peer(server_->port());
  peer.greet("duel-1", 1);
  ASSERT_TRUE(peer.wait_for<protocol::Welcome>());
  const auto listed = nlohmann::json::parse(get("/admin/rooms").body);
  ASSERT_EQ(listed.at("rooms").size(), 2u);
  EXPECT_EQ(listed.at("rooms")[1].at("name"), "duel-1");
  EXPECT_EQ(listed.at("rooms")[1].at("seats"), 2);

  EXPECT_EQ(post("/admin/rooms/duel-1/lock").status, 200);
  EXPECT_TRUE(nlohmann::json::parse(get("/admin/rooms/duel-1").body).at("locked").get<bool>());
  EXPECT_EQ(post("/admin/rooms/duel-1/unlock").status, 200);
  EXPECT_EQ(post("/admin/rooms/duel-1/pause").status, 200);
  EXPECT_EQ(nlohmann::json::parse(get("/admin/rooms/duel-1").body).at("stage"), "paused");
  EXPECT_EQ(post("/admin/rooms/duel-1/resume").status, 200);

  const std::string file = "cycloid-snapshot-" + std::to_string(::getpid());
  const std::string path = testing::TempDir() + "/" + file;
  std::filesystem::remove(path);
  const std::string wanted = R"({"file": ")" + file + R"("})";
  EXPECT_EQ(post("/admin/rooms/duel-1/snapshot", wanted).status, 200);
  EXPECT_GT(std::filesystem::file_size(path), 100u);
  EXPECT_EQ(post("/admin/rooms/duel-1/snapshot", wanted).status, 409);  // Never over another.
  std::filesystem::remove(path);

  const auto tick = [&] { return server_->host().find("duel-1")->meters().tick.get(); };
  ASSERT_TRUE(eventually([&] { return tick() > 70; }));
  EXPECT_EQ(post("/admin/rooms/duel-1/rewind", R"({"tick": 60})").status, 200);
  EXPECT_EQ(post("/admin/rooms/duel-1/rewind", R"({"tick": 999999})").status, 409);

  EXPECT_EQ(post("/admin/rooms/duel-1/kick", R"({"seat": 0})").status, 404);
  EXPECT_EQ(post("/admin/rooms/duel-1/kick", R"({"seat": 1, "reason": "afk"})").status, 200);
  const auto refused = peer.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, protocol::Refusal::kKicked);
  EXPECT_EQ(refused->reason, "afk");

  EXPECT_EQ(post("/admin/rooms/duel-1/end", R"({"reason": "over"})").status, 200);
  EXPECT_TRUE(eventually([&] { return get("/admin/rooms/duel-1").status == 404; }));
  const std::string lines = close();
  for (const char* verb :
       {"create", "lock", "unlock", "pause", "resume", "snapshot", "rewind", "kick", "end"}) {
    EXPECT_NE(lines.find("\"audit\":\"" + std::string(verb) + "\""), std::string::npos) << verb;
  }
  EXPECT_NE(lines.find(R"("fields":{"reason":"afk","seat":1})"), std::string::npos);
}

TEST_F(OperationTest, ActsAreOnRecordWhateverTheLevelOfTheLog) {
  open();
  server_->host().logger()->set_level(spdlog::level::err);
  EXPECT_EQ(post("/admin/rooms/arena/lock").status, 200);
  EXPECT_EQ(post("/admin/rooms/arena/end", std::string(70000, ' ')).status, 413);
  EXPECT_EQ(http(operation_->port(), "POST", "/admin/drain", "", "wrong").status, 401);
  const std::string lines = close();
  EXPECT_NE(lines.find(R"("audit":"lock")"), std::string::npos) << lines;
  EXPECT_NE(lines.find(R"("audit":"/admin/rooms/arena/end")"), std::string::npos) << lines;
  EXPECT_NE(lines.find(R"("audit":"refused")"), std::string::npos) << lines;
  EXPECT_EQ(lines.find("is gone"), std::string::npos) << lines;
}

TEST_F(OperationTest, AReservedSeatIsKeptForWhoItIsFor) {
  open();
  EXPECT_EQ(post("/admin/rooms/arena/reserve", R"({"seat": 0, "identity": "ann", "ticks": 100000})")
                .status,
            200);
  HostPeer stranger(server_->port());
  stranger.greet("arena", 0);
  const auto refused = stranger.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, protocol::Refusal::kSeatTaken);
  HostPeer other(server_->port());
  other.greet("arena", 1);
  ASSERT_TRUE(other.wait_for<protocol::Welcome>());
  const Answer held = post("/admin/rooms/arena/reserve", R"({"seat": 1, "ticks": 5})");
  EXPECT_EQ(held.status, 409);
  EXPECT_EQ(error_of(held), "seat: 1 is held or waits for its player");
  EXPECT_EQ(post("/admin/rooms/arena/kick", R"({"seat": 0})").status, 200) << "freed by a kick";
  HostPeer third(server_->port());
  third.greet("arena", 0);
  EXPECT_TRUE(third.wait_for<protocol::Welcome>());
}

TEST_F(OperationTest, EveryMistakeOfAnAdminGetsAStatusAndNamesTheField) {
  open();
  const struct {
    const char* path;
    std::string body;
    int status;
    const char* begins;
  } kRows[] = {
      {"/admin/rooms", "{", 400, "body: it is not JSON"},
      {"/admin/rooms", "[1]", 400, "body: it is not a JSON object"},
      {"/admin/rooms", "{}", 400, "name: it is missing"},
      {"/admin/rooms", R"({"name": "x"})", 400, "template: it is missing"},
      {"/admin/rooms", R"({"name": 7, "template": "hall"})", 400, "name: it is number"},
      {"/admin/rooms", R"({"name": "a b", "template": "hall"})", 400, "name: a name is made of"},
      {"/admin/rooms", R"({"name": "x", "template": "none"})", 404, "template: there is none"},
      {"/admin/rooms", R"({"name": "arena", "template": "hall"})", 409, "name: there is a room"},
      {"/admin/rooms", R"({"name": "x", "template": "hall", "seats": 3})", 400,
       "seats: there is no such field"},
      {"/admin/rooms", std::string(70000, ' '), 413, "body: more than"},
      {"/admin/rooms/none/lock", "", 404, "path: there is no room"},
      {"/admin/rooms/arena/explode", "", 404, "path: a room has no act"},
      {"/admin/rooms/arena/unlock", "", 409, "the room is not locked"},
      {"/admin/rooms/arena/resume", "", 409, "the room is running"},
      {"/admin/rooms/arena/pause", R"({"why": 1})", 400, "why: there is no such field"},
      {"/admin/rooms/arena/kick", "{}", 400, "seat: it is missing"},
      {"/admin/rooms/arena/kick", R"({"seat": -1})", 400, "seat: it is -1"},
      {"/admin/rooms/arena/kick", R"({"seat": 1.5})", 400, "seat: it is 1.5"},
      {"/admin/rooms/arena/kick", R"({"seat": 2})", 404, "seat: it is 2"},
      {"/admin/rooms/arena/kick", R"({"seat": 0, "reason": "a\nb"})", 400, "reason: it holds"},
      {"/admin/rooms/arena/rewind", R"({"tick": "x"})", 400, "tick: it is"},
      {"/admin/rooms/arena/reserve", R"({"ticks": 5})", 400, "seat: it is missing"},
      {"/admin/rooms/arena/reserve", R"({"seat": 0})", 400, "ticks: it is missing"},
      {"/admin/rooms/arena/reserve", R"({"seat": 0, "ticks": 0})", 400, "ticks: it is 0"},
      {"/admin/rooms/arena/reserve", R"({"seat": 2, "ticks": 5})", 404, "seat: it is 2"},
      {"/admin/rooms/arena/reserve",
       R"({"seat": 0, "ticks": 5, "identity": ")" + std::string(65, 'x') + "\"}", 400,
       "identity: it has 65 bytes"},
      {"/admin/rooms/arena/snapshot", R"({"file": "../x"})", 400, "file: "},
      {"/admin/rooms/arena/snapshot", "{}", 400, "file: it is missing"},
      {"/admin/rooms/arena/end", R"({"reason": ["a"]})", 400, "reason: it is array"},
      {"/admin/rooms/arena/end", R"({"reason": {"a": 1}})", 400, "reason: it is object"},
      {"/admin/rooms/arena/end",
       R"({"reason": )" + std::string(30000, '[') + std::string(30000, ']') + "}", 400,
       "reason: it is array"},
      {"/admin/rooms/arena/rotate", "", 409, "rotate: the room writes no log"},
      {"/admin/rooms/arena/drain", R"({"deadline_ms": 1e99})", 400, "deadline_ms: it is"},
      {"/admin/reload", "", 409, "reload: the server was started without"},
      {"/admin/nothing", "", 404, "path: there is no /admin/nothing"},
  };
  for (const auto& row : kRows) {
    const Answer answer = post(row.path, row.body);
    EXPECT_EQ(answer.status, row.status) << row.path << ' ' << row.body.substr(0, 60);
    ASSERT_FALSE(answer.body.empty()) << row.path;
    EXPECT_TRUE(error_of(answer).starts_with(row.begins)) << answer.body;
  }
  const Answer wrong = get("/admin/rooms/arena/lock");
  EXPECT_EQ(wrong.status, 405);
  EXPECT_NE(wrong.head.find("Allow: POST"), std::string::npos);
  EXPECT_EQ(server_->host().rooms().size(), 1u);
  EXPECT_EQ(server_->host().find("arena")->stage(), LifeStage::kRunning);
}

TEST_F(OperationTest, ADrainWithoutADeadlineLastsAsLongAsTheHostSaysNow) {
  open();
  HostPeer peer(server_->port());
  peer.greet("arena");
  ASSERT_TRUE(peer.wait_for<protocol::Welcome>());
  server_->host().set_drain(50s);
  EXPECT_EQ(post("/admin/rooms/arena/drain").status, 200);
  const auto notice = peer.wait_for<protocol::RoomNotice>();
  ASSERT_TRUE(notice);
  EXPECT_EQ(notice->kind, protocol::NoticeKind::kDraining);
  EXPECT_EQ(notice->value, 50'000u);
}

TEST_F(OperationTest, ARotatedLogGoesOnInAnotherFile) {
  const std::filesystem::path folder = open_with_logs("rotated");
  const auto tick = [&] { return server_->host().find("arena")->meters().tick.get(); };
  ASSERT_TRUE(eventually([&] { return tick() > 5; }));
  EXPECT_EQ(post("/admin/rooms/arena/rotate").status, 200);
  const std::uint64_t rotated = tick();
  ASSERT_TRUE(eventually([&] { return tick() > rotated + 5; }));
  EXPECT_NE(close().find(R"("audit":"rotate")"), std::string::npos);
  std::uint64_t ticks = 0;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
    const protocol::Log read = protocol::read_log(std::as_bytes(std::span(text)));
    EXPECT_NE(read.state, protocol::LogState::kCorrupt) << read.reason;
    ticks += read.ticks.size();
    ++files;
  }
  std::filesystem::remove_all(folder);
  EXPECT_EQ(files, 2);
  EXPECT_GT(ticks, rotated + 5);
}

TEST_F(OperationTest, ALogThatCannotBeRotatedForItsDiskIsAnErrorOfTheServer) {
  const std::filesystem::path folder = open_with_logs("rotates-not");
  std::filesystem::remove_all(folder);
  const Answer answer = post("/admin/rooms/arena/rotate");
  EXPECT_EQ(answer.status, 500);
  EXPECT_TRUE(error_of(answer).starts_with("rotate: " + folder.string())) << answer.body;
}

TEST_F(OperationTest, WithoutTheTokenNothingIsToldAndNothingDone) {
  open();
  for (const std::string token :
       {"", "wrong", "a-token-for-tests-onlY", "a-token-for-tests-only2"}) {
    EXPECT_EQ(http(operation_->port(), "GET", "/admin/rooms", "", token).status, 401) << token;
    EXPECT_EQ(http(operation_->port(), "POST", "/admin/rooms/arena/end", "", token).status, 401);
  }
  EXPECT_EQ(server_->host().find("arena")->stage(), LifeStage::kRunning);
  EXPECT_TRUE(equal_secrets("abc", "abc"));
  EXPECT_FALSE(equal_secrets("abc", "abcd"));
  const std::string lines = close();
  EXPECT_NE(lines.find(R"("audit":"refused")"), std::string::npos);
  EXPECT_LE(std::ranges::count(lines, '\n'), 10);  // Once in a second, not once for each.
}

TEST_F(OperationTest, WithoutATokenThereIsNoAdminInterface) {
  open(false);
  EXPECT_EQ(get("/admin/rooms").status, 404);
  EXPECT_TRUE(eventually([&] { return get("/livez").status == 200; }));
  EXPECT_EQ(post("/metrics").status, 405);
  EXPECT_EQ(get("/anything").status, 404);
}

}  // namespace
}  // namespace cycloid::server
