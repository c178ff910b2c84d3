#include <gtest/gtest.h>
#include <unistd.h>

#include <asio.hpp>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <span>
#include <stop_token>
#include <thread>

#include "client/join.hpp"
#include "client/replica/replica.hpp"
#include "protocol/codec.hpp"
#include "protocol/log_format.hpp"
#include "tests/client/authority.hpp"
#include "tests/client/served.hpp"

namespace cycloid::client {
namespace {

JoinOptions visit(std::uint16_t port, protocol::Mode mode) {
  JoinOptions options;
  options.port = port;
  options.scene = Authority::scene();
  options.mode = mode;
  const auto deadline = std::chrono::steady_clock::now() + kDeadline;
  options.should_stop = [deadline] { return std::chrono::steady_clock::now() > deadline; };
  return options;
}

/// Steps the scene that the log carries by its frames; the digest of the last tick.
std::uint64_t replayed_digest(const std::string& file, std::uint64_t ticks) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(stream)),
                         std::istreambuf_iterator<char>());
  const protocol::Log log =
      protocol::read_log(std::as_bytes(std::span<const char>(text.data(), text.size())));
  EXPECT_EQ(log.state, protocol::LogState::kComplete) << log.reason;
  EXPECT_EQ(log.ticks.size(), ticks);
  const scenes::Loaded loaded = scenes::from_binary(log.header.scene);
  scenes::Simulation simulation = std::move(scenes::Simulation::create(*loaded.scene).value());
  std::vector<scenes::SeatInput> inputs;
  for (const protocol::LogTick& tick : log.ticks) {
    inputs.clear();
    for (const protocol::SeatFrame& seat : tick.frame.seats) inputs.push_back(seat.input);
    EXPECT_TRUE(simulation.step(inputs).ok());
    EXPECT_EQ(simulation.digest(), tick.digest) << "at tick " << tick.frame.tick;
  }
  return simulation.digest();
}

static std::string log_of_this_process(const std::string& name) {
  const std::string file = name + "-" + std::to_string(getpid()) + ".cylog";
  return (std::filesystem::temp_directory_path() / file).string();
}

TEST(Loopback, TwoReplicasASnapshotClientAndTheReplayEndWithTheServersDigest) {
  const std::string log = log_of_this_process("loopback");
  server::ServeOptions serving;
  serving.scene = Authority::scene();
  serving.ticks = 100;
  serving.log = log;
  serving.limits.digest_ticks = 10;
  Served served(std::move(serving));
  const std::uint16_t port = served.port();
  std::vector<std::future<JoinReport>> clients;
  for (const auto mode :
       {protocol::Mode::kLockstep, protocol::Mode::kLockstep, protocol::Mode::kSnapshot}) {
    JoinOptions options = visit(port, mode);
    if (mode == protocol::Mode::kSnapshot) options.seat_wish = protocol::kSpectator;
    clients.push_back(std::async(std::launch::async, [options] { return join(options); }));
  }
  const server::ServeReport report = served.report();
  EXPECT_EQ(report.end, server::End::kTicks) << report.reason;
  EXPECT_EQ(report.ticks, 100u);
  EXPECT_EQ(report.desyncs, 0u);
  for (auto& client : clients) {
    const JoinReport mine = client.get();
    EXPECT_EQ(mine.end, End::kBye) << mine.reason;
    EXPECT_EQ(mine.progress.last_tick, 100u);
    EXPECT_EQ(mine.final_digest, report.final_digest);
    EXPECT_EQ(mine.progress.mismatches, 0u);
    EXPECT_GT(mine.bytes_in, 0u);
  }
  EXPECT_EQ(replayed_digest(log, 100), report.final_digest);
  std::filesystem::remove(log);
}

// Both sides choose from step to step how many of their threads take it (scenes::ThreadChoice); who
// replays has one.
TEST(Loopback, WhoTakesAnyNumberOfThreadsStaysTheSame) {
  const std::string log = log_of_this_process("threads");
  server::ServeOptions serving;
  serving.scene = *scenes::find("room-200").scene;
  serving.ticks = 60;
  serving.workers = 3;
  serving.log = log;
  serving.limits.digest_ticks = 1;
  Served served(std::move(serving));
  const std::uint16_t port = served.port();
  std::vector<std::future<JoinReport>> clients;
  for (const int workers : {1, 2}) {
    JoinOptions options = visit(port, protocol::Mode::kLockstep);
    options.scene = *scenes::find("room-200").scene;
    options.workers = workers;
    clients.push_back(std::async(std::launch::async, [options] { return join(options); }));
  }
  const server::ServeReport report = served.report();
  EXPECT_EQ(report.end, server::End::kTicks) << report.reason;
  for (auto& client : clients) {
    const JoinReport mine = client.get();
    EXPECT_EQ(mine.end, End::kBye) << mine.reason;
    EXPECT_EQ(mine.progress.mismatches, 0u);
    EXPECT_EQ(mine.final_digest, report.final_digest);
  }
  EXPECT_EQ(replayed_digest(log, 60), report.final_digest);
  std::filesystem::remove(log);
}

TEST(Loopback, DisturbedReplicaIsFoundOutAndGoesOnFromASnapshot) {
  server::ServeOptions serving;
  serving.scene = Authority::scene();
  serving.ticks = 120;
  serving.limits.digest_ticks = 5;
  Served served(std::move(serving));
  JoinOptions options = visit(served.port(), protocol::Mode::kLockstep);
  bool disturbed = false;
  options.on_progress = [&](Follower& follower) {
    if (disturbed || follower.progress().frames < 20) return;
    disturbed = true;
    disturb(follower.simulation());
  };
  const JoinReport mine = join(options);
  const server::ServeReport report = served.report();
  EXPECT_EQ(mine.end, End::kBye) << mine.reason;
  EXPECT_GE(mine.progress.mismatches, 1u);
  EXPECT_GE(mine.progress.resyncs, 1u);
  EXPECT_GE(report.desyncs, 1u);
  EXPECT_EQ(mine.progress.last_tick, 120u);
  EXPECT_EQ(mine.final_digest, report.final_digest);
}

/// A tick lasts 1000 s, and the state travels in more parts than one tick has.
TEST(Loopback, ALargeStateComesWholeWhereTicksAreRare) {
  server::ServeOptions serving;
  serving.scene = std::move(*scenes::find("cubes-901").scene);
  serving.tick_rate_millihertz = 1;
  JoinOptions options = visit(0, protocol::Mode::kLockstep);
  options.scene = serving.scene;
  Served served(std::move(serving));
  options.port = served.port();
  std::atomic<bool> begun = false;
  options.on_progress = [&begun](Follower& follower) { begun = follower.progress().begun(); };
  options.should_stop = [&begun] { return begun.load(); };
  const JoinReport report = join(options);
  EXPECT_EQ(report.end, End::kStopped) << report.reason;
  EXPECT_GT(report.bytes_in,
            server::Limits().state_parts_per_tick_max * protocol::kSnapshotPartBytesMax)
      << "or it proves nothing";
  EXPECT_EQ(report.progress.last_tick, 0u);
}

TEST(Loopback, TakenSeatAndAnotherSceneAreRefusedWithTheirCodes) {
  server::ServeOptions serving;
  serving.scene = Authority::scene();
  Served served(std::move(serving));
  const std::uint16_t port = served.port();
  JoinOptions wrong = visit(port, protocol::Mode::kLockstep);
  wrong.scene = std::move(*scenes::find("stack-10").scene);
  const JoinReport scene = join(wrong);
  ASSERT_EQ(scene.end, End::kRefused) << scene.reason;
  EXPECT_EQ(scene.refused()->code, protocol::Refusal::kSceneDigest);

  std::promise<void> seated;
  std::atomic<bool> leave = false;
  JoinOptions first = visit(port, protocol::Mode::kLockstep);
  first.seat_wish = 0;
  first.should_stop = [&leave] { return leave.load(); };
  first.on_progress = [&, told = false](Follower& follower) mutable {
    if (!told && follower.progress().phase == Phase::kRunning) seated.set_value();
    told = told || follower.progress().phase == Phase::kRunning;
  };
  auto sitting = std::async(std::launch::async, [&first] { return join(first); });
  EXPECT_EQ(seated.get_future().wait_for(kDeadline), std::future_status::ready);
  JoinOptions second = visit(port, protocol::Mode::kLockstep);
  second.seat_wish = 0;
  const JoinReport taken = join(second);
  leave = true;
  EXPECT_EQ(sitting.get().end, End::kStopped);
  ASSERT_EQ(taken.end, End::kRefused) << taken.reason;
  EXPECT_EQ(taken.refused()->code, protocol::Refusal::kSeatTaken);
}

/// A port that takes connections and never says a word.
TEST(Deadlines, SilentServerIsLeftInTime) {
  asio::io_context io;
  asio::ip::tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
  JoinOptions options = visit(acceptor.local_endpoint().port(), protocol::Mode::kLockstep);
  options.handshake = std::chrono::milliseconds(300);
  const auto begin = std::chrono::steady_clock::now();
  const JoinReport report = join(options);
  EXPECT_EQ(report.end, End::kDisconnected);
  EXPECT_EQ(report.reason, "no welcome in time");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST(Deadlines, AStateThatStaysAwayBehindItsWelcomeIsCalledThat) {
  asio::io_context io;
  asio::ip::tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
  JoinOptions options = visit(acceptor.local_endpoint().port(), protocol::Mode::kLockstep);
  options.handshake = std::chrono::milliseconds(1000);
  const Authority authority(options.scene);
  const protocol::Bytes welcome = protocol::encode(authority.welcome(0));
  auto client = std::async(std::launch::async, [&options] { return join(options); });
  asio::ip::tcp::socket socket = acceptor.accept();
  asio::error_code error;
  asio::write(socket, asio::buffer(welcome), error);
  const JoinReport report = client.get();
  EXPECT_EQ(report.end, End::kDisconnected);
  EXPECT_EQ(report.reason, "no state in time");
}

TEST(Deadlines, NobodyThereIsADisconnect) {
  const JoinReport report = join(visit(1, protocol::Mode::kLockstep));
  EXPECT_EQ(report.end, End::kDisconnected);
  EXPECT_NE(report.reason.find("cannot connect"), std::string::npos) << report.reason;
}

TEST(Deadlines, NoiseInsteadOfMessagesIsADisconnectWithAReason) {
  asio::io_context io;
  asio::ip::tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
  JoinOptions options = visit(acceptor.local_endpoint().port(), protocol::Mode::kLockstep);
  auto client = std::async(std::launch::async, [&options] { return join(options); });
  asio::ip::tcp::socket socket = acceptor.accept();
  const std::string noise(64, '\xff');
  asio::error_code error;
  asio::write(socket, asio::buffer(noise), error);
  const JoinReport report = client.get();
  EXPECT_EQ(report.end, End::kDisconnected);
  EXPECT_NE(report.reason.find("a message of 4294967295 bytes"), std::string::npos)
      << report.reason;
}

}  // namespace
}  // namespace cycloid::client
