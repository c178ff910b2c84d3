#include "server/host/host.hpp"

#include <gtest/gtest.h>
#include <malloc.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>

#include "server/host/process_time.hpp"
#include "tests/server/host_fixture.hpp"

namespace cycloid::server {
namespace {

using namespace std::chrono_literals;

std::size_t open_descriptors() {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    count += entry.path().empty() ? 0 : 1;
  }
  return count;
}

/// Where a log of a test goes; nothing is there yet.
std::string fresh_log(const std::string& word) {
  std::string path =
      testing::TempDir() + "cycloid-" + word + "-" + std::to_string(::getpid()) + ".log";
  std::filesystem::remove(path);
  return path;
}

std::size_t resident_bytes() {
  std::ifstream stream("/proc/self/statm");
  std::size_t pages = 0;
  stream >> pages >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

TEST(Host, ThreeRoomsOnTwoThreadsKeepTheirClientsApart) {
  HostLines lines;
  HostOptions options = quiet_host(lines);
  for (const char* name : {"red", "green", "blue"}) {
    options.rooms.push_back({name, two_seat_settings()});
  }
  RunningHost server(std::move(options));
  std::vector<std::unique_ptr<HostPeer>> peers;
  for (const char* name : {"red", "green", "blue"}) {
    for (int seat = 0; seat < 2; ++seat) {
      peers.push_back(std::make_unique<HostPeer>(server.port()));
      peers.back()->greet(name, seat);
      const auto welcome = peers.back()->wait_for<protocol::Welcome>();
      ASSERT_TRUE(welcome) << name;
      EXPECT_EQ(welcome->seat, seat);  // Of its own room: every seat is free once in each.
    }
  }
  for (const auto& peer : peers) {
    std::uint64_t last = 0;
    for (int i = 0; i < 20; ++i) {
      const auto frame = peer->wait_for<protocol::InputFrame>();
      ASSERT_TRUE(frame);
      ASSERT_TRUE(last == 0 || frame->tick == last + 1);
      last = frame->tick;
    }
  }
  HostPeer stranger(server.port());
  stranger.greet("violet");
  const auto refused = stranger.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, protocol::Refusal::kNoSuchRoom);
  HostPeer nameless(server.port());
  nameless.greet("");
  const auto which = nameless.wait_for<protocol::Refused>();
  ASSERT_TRUE(which);
  EXPECT_EQ(which->code, protocol::Refusal::kNoSuchRoom);
  EXPECT_NE(which->reason.find("3"), std::string::npos) << which->reason;
  server.stop();
  peers.clear();
  const HostReport report = server.report();
  EXPECT_EQ(report.rooms.size(), 3u);
  EXPECT_TRUE(report.good);
  for (const auto& [name, room] : report.rooms) EXPECT_EQ(room.clients, 2u) << name;
}

TEST(Host, TheFirstJoinMakesARoomThatEndsWhenItIsEmpty) {
  HostLines lines;
  HostOptions options = quiet_host(lines);
  options.templates["duel"].settings.empty_ttl = 1s;
  RunningHost server(std::move(options));
  {
    // Both come while the room is being made: one room, two seats.
    HostPeer first(server.port());
    HostPeer second(server.port());
    first.greet("duel:7");
    second.greet("duel:7");
    ASSERT_TRUE(first.wait_for<protocol::Welcome>());
    ASSERT_TRUE(second.wait_for<protocol::Welcome>());
    EXPECT_EQ(server.host().rooms().size(), 1u);
    HostPeer other(server.port());
    other.greet("hall:1");  // Not to be made by a join.
    const auto refused = other.wait_for<protocol::Refused>();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->code, protocol::Refusal::kNoSuchRoom);
  }
  EXPECT_TRUE(eventually([&] { return server.host().rooms().empty(); }));
  HostPeer again(server.port());
  again.greet("duel:7");
  const auto welcome = again.wait_for<protocol::Welcome>();
  ASSERT_TRUE(welcome);
  EXPECT_LT(welcome->tick, 60u);  // Another match.
}

TEST(Host, LockPauseResumeAndEndDoWhatTheySay) {
  HostLines lines;
  RunningHost server(quiet_host(lines));
  ASSERT_TRUE(server.make("arena", "hall").ok());
  EXPECT_EQ(server.make("arena", "hall").status, 409);
  EXPECT_EQ(server.make("other", "nothing").status, 404);
  EXPECT_EQ(server.make("a room", "hall").status, 400);
  HostPeer peer(server.port());
  peer.greet("arena");
  ASSERT_TRUE(peer.wait_for<protocol::Welcome>());

  ASSERT_TRUE(server.act("arena", LifeAct::kLock).ok());
  HostPeer late(server.port());
  late.greet("arena");
  const auto refused = late.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, protocol::Refusal::kRoomLocked);
  ASSERT_TRUE(server.act("arena", LifeAct::kUnlock).ok());

  ASSERT_TRUE(server.act("arena", LifeAct::kPause).ok());
  const auto room = server.host().find("arena");
  const std::uint64_t stood = room->meters().tick.get();
  std::this_thread::sleep_for(150ms);
  EXPECT_LE(room->meters().tick.get(), stood + 1);
  EXPECT_EQ(server.host().stuck(1), "");  // Paused is not stuck.
  EXPECT_EQ(server.act("arena", LifeAct::kPause).status, 409);
  ASSERT_TRUE(server.act("arena", LifeAct::kResume).ok());
  EXPECT_TRUE(eventually([&] { return room->meters().tick.get() > stood + 5; }));
  // It goes on where it stood: what was missed is told, and not made up for.
  EXPECT_GE(room->meters().slowed_ns.get(), 130'000'000u);  // In whole ticks.

  ASSERT_TRUE(server.act("arena", LifeAct::kEnd).ok());
  const auto bye = peer.wait_for<protocol::Bye>();
  ASSERT_TRUE(bye);
  EXPECT_EQ(bye->reason, "by the test");
  peer.hang_up();
  EXPECT_TRUE(eventually([&] { return server.host().find("arena") == nullptr; }));
}

TEST(Host, ADrainTellsClientsAndEndsRoomsAtItsDeadline) {
  HostLines lines;
  HostOptions options = quiet_host(lines);
  options.rooms.push_back({"arena", two_seat_settings()});
  options.rooms.push_back({"empty", two_seat_settings()});
  const std::string log = fresh_log("drain");
  options.rooms[0].settings.log = log;
  RunningHost server(std::move(options));
  HostPeer peer(server.port());
  peer.greet("arena");
  ASSERT_TRUE(peer.wait_for<protocol::Welcome>());
  const auto begin = std::chrono::steady_clock::now();
  server.host().drain("maintenance", 400ms);
  const auto notice = peer.wait_for<protocol::RoomNotice>();
  ASSERT_TRUE(notice);
  EXPECT_EQ(notice->kind, protocol::NoticeKind::kDraining);
  EXPECT_LE(notice->value, 400u);
  EXPECT_GT(notice->value, 0u);
  EXPECT_TRUE(server.host().draining());
  HostPeer late(server.port());
  late.greet("arena");
  const auto refused = late.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, protocol::Refusal::kDraining);
  EXPECT_EQ(server.make("new", "hall").status, 503);
  ASSERT_TRUE(peer.wait_for<protocol::InputFrame>());  // The match goes on.
  const auto bye = peer.wait_for<protocol::Bye>();
  ASSERT_TRUE(bye);
  EXPECT_EQ(bye->reason, "maintenance");
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 390ms);
  peer.hang_up();
  const HostReport report = server.report();
  EXPECT_TRUE(report.good);
  EXPECT_LT(report.rooms.at("empty").ticks, report.rooms.at("arena").ticks);
  std::ifstream stream(log, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
  const protocol::Log read = protocol::read_log(std::as_bytes(std::span(text)));
  std::filesystem::remove(log);
  EXPECT_EQ(read.state, protocol::LogState::kComplete) << read.reason;
}

TEST(Host, ASecondSignalEndsADrainAtOnce) {
  HostLines lines;
  HostOptions options = quiet_host(lines);
  options.catch_signals = true;
  options.drain = 1h;
  options.rooms.push_back({"arena", two_seat_settings()});
  RunningHost server(std::move(options));
  HostPeer peer(server.port());
  peer.greet("arena");
  ASSERT_TRUE(peer.wait_for<protocol::Welcome>());
  ASSERT_EQ(::kill(::getpid(), SIGTERM), 0);
  const auto notice = peer.wait_for<protocol::RoomNotice>();
  ASSERT_TRUE(notice);
  EXPECT_GT(notice->value, 3'500'000u);
  ASSERT_EQ(::kill(::getpid(), SIGTERM), 0);
  EXPECT_TRUE(server.report().good);  // Though the peer has not hung up.
}

/// Makes and ends rooms over and over; nothing may be left of them.
void cycle_rooms(RunningHost& server, int cycles) {
  for (int i = 0; i < cycles; ++i) {
    const std::string name = "hall-" + std::to_string(i);
    ASSERT_TRUE(server.make(name, "hall").ok());
    ASSERT_TRUE(server.act(name, LifeAct::kEnd).ok());
  }
  ASSERT_TRUE(eventually([&] { return server.host().rooms().empty(); }));
}

TEST(Host, TenThousandRoomsLeaveNothingBehind) {
  constexpr int kCycles = 10000;
  HostLines lines;
  HostOptions options = quiet_host(lines);
  options.logger->set_level(spdlog::level::off);
  options.limits.rooms_max = 100;
  RunningHost server(std::move(options));
  cycle_rooms(server, 200);  // So that pools and arenas have their size.
  const std::size_t descriptors = open_descriptors();
  const std::size_t resident = resident_bytes();
  cycle_rooms(server, kCycles);
  EXPECT_EQ(open_descriptors(), descriptors);
  EXPECT_LE(static_cast<double>(resident_bytes()), 1.05 * static_cast<double>(resident) + 1e6);
  EXPECT_EQ(server.host().meters().rooms_ended.get(), kCycles + 200u);
}

TEST(Host, RoomsBeginAtDifferentPhases) {
  HostLines lines;
  HostOptions options = quiet_host(lines);
  for (int i = 0; i < 8; ++i) {
    options.rooms.push_back({"room-" + std::to_string(i), two_seat_settings()});
  }
  RunningHost server(std::move(options));
  ASSERT_TRUE(eventually([&] {
    for (const auto& room : server.host().rooms()) {
      if (room->meters().tick.get() < 2) return false;
    }
    return true;
  }));
  EXPECT_TRUE(eventually([&] {  // A room that is late is armed at once, out of its phase.
    std::set<std::int64_t> phases;
    for (const auto& room : server.host().rooms()) {
      const std::int64_t armed = room->meters().armed_ns;
      phases.insert(armed % 16'666'667 * 16 / 16'666'667);
    }
    return phases.size() >= 6u;  // Of eight, each in an eighth; a late one may share.
  }));
}

TEST(Host, IdleConnectionsCostLittleAndHarmNobody) {
  HostLines lines;
  HostOptions options = quiet_host(lines);
  options.gate.hello_deadline_ns = 60'000'000'000;
  options.rooms.push_back({"arena", two_seat_settings()});
  RunningHost server(std::move(options));
  HostPeer player(server.port());
  player.greet("arena");
  ASSERT_TRUE(player.wait_for<protocol::Welcome>());
  constexpr std::size_t kIdle = 200;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(server.port());
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const std::size_t heap = ::mallinfo2().uordblks;
  std::array<int, kIdle> idle{};
  for (int& descriptor : idle) {
    descriptor = ::socket(AF_INET, SOCK_STREAM, 0);
    ASSERT_EQ(::connect(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  ASSERT_TRUE(eventually([&] { return server.host().meters().pending.get() == kIdle; }));
  const auto grown = static_cast<double>(::mallinfo2().uordblks) - static_cast<double>(heap);
  EXPECT_LE(grown / kIdle, 4096.0);
  RecordProperty("idle_bytes", static_cast<int>(grown / kIdle));
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(player.wait_for<protocol::InputFrame>());
  for (const int descriptor : idle) (void)::close(descriptor);
  EXPECT_TRUE(eventually([&] { return server.host().meters().pending.get() == 0; }));
  EXPECT_TRUE(eventually([&] { return server.host().meters().connections.get() == 1; }));
}

TEST(Host, ADiskThatHangsIsSeenAsARoomThatIsStuck) {
  HostLines lines;
  const std::string log = fresh_log("stuck");
  std::atomic<bool> hangs{false};
  HostOptions options = waiting_host(lines, log, hangs);
  options.rooms.push_back({"other", two_seat_settings()});
  RunningHost server(std::move(options));
  const auto other = server.host().find("other");
  ASSERT_TRUE(eventually([&] { return other->meters().tick.get() > 3; }));
  EXPECT_TRUE(eventually([&] { return server.host().stuck(60).empty(); }));
  hangs = true;
  EXPECT_TRUE(
      eventually([&] { return server.host().stuck(6).find("arena") != std::string::npos; }));
  const std::uint64_t tick = other->meters().tick.get();
  EXPECT_TRUE(eventually([&] { return other->meters().tick.get() > tick + 5; }));
  hangs = false;
  EXPECT_TRUE(eventually([&] { return server.host().stuck(6).empty(); }));
  server.stop();
  EXPECT_TRUE(server.report().good);
  std::filesystem::remove(log);
}

TEST(Host, TicksThatAreCaughtUpCountAsLateToo) {
  HostLines lines;
  const std::string log = fresh_log("late");
  std::atomic<bool> hangs{false};
  HostOptions options = waiting_host(lines, log, hangs);
  options.limits.room.catch_up_ticks_max = 100'000;  // However late a busy machine lets it be.
  RunningHost server(std::move(options));
  const auto room = server.host().find("arena");
  const RoomMeters& meters = room->meters();
  ASSERT_TRUE(eventually([&] { return meters.tick.get() > 3; }));
  hangs = true;
  ASSERT_TRUE(eventually([&] { return !server.host().stuck(6).empty(); }));
  hangs = false;
  ASSERT_TRUE(eventually([&] { return meters.catch_up_ticks.get() > 3; }));
  ASSERT_TRUE(server.act("arena", LifeAct::kPause).ok());
  EXPECT_EQ(meters.lateness.count(), meters.tick.get());
  EXPECT_EQ(meters.tick_time.count(), meters.tick.get());
  server.stop();
  EXPECT_TRUE(server.report().good);
  std::filesystem::remove(log);
}

}  // namespace
}  // namespace cycloid::server
