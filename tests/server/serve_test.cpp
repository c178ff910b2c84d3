#include "server/serve.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <asio.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <optional>
#include <thread>

#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using asio::ip::tcp;
using namespace std::chrono_literals;

/// Every wait of these tests; far more than any of them needs.
constexpr auto kPatience = 20s;

/// A server in a thread of its own, on a port of its own.
class Served {
 public:
  explicit Served(ServeOptions options) : options_(std::move(options)) {
    options_.scene = two_seat_scene();
    std::promise<std::uint16_t> port;
    auto listening = port.get_future();
    report_ = std::async(std::launch::async, [this, port = std::move(port)]() mutable {
      return serve(
          options_, [&](std::uint16_t at) { port.set_value(at); }, stop_.get_token());
    });
    if (listening.wait_for(kPatience) != std::future_status::ready) std::abort();
    port_ = listening.get();
  }
  ~Served() { stop_.request_stop(); }

  std::uint16_t port() const { return port_; }
  void stop() { stop_.request_stop(); }
  ServeReport report() {
    if (report_.wait_for(kPatience) != std::future_status::ready) std::abort();
    return report_.get();
  }

 private:
  ServeOptions options_;
  std::stop_source stop_;
  std::future<ServeReport> report_;
  std::uint16_t port_ = 0;
};

ServeOptions quiet_options() {
  ServeOptions options;
  options.catch_signals = false;
  options.limits.resume = 0ns;  // A seat that is lost is free at once.
  return options;
}

/// A client that blocks, but never for ever.
class Peer {
 public:
  explicit Peer(std::uint16_t port) { connect(port); }
  Peer() { socket_.open(tcp::v4()); }

  void connect(std::uint16_t port) {
    socket_.connect(tcp::endpoint(asio::ip::address_v4::loopback(), port));
    const timeval patience{std::chrono::seconds(kPatience).count(), 0};
    (void)::setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &patience,
                       sizeof patience);
  }

  void send(const protocol::ClientMessage& message) { send_bytes(protocol::encode(message)); }
  void send_bytes(const protocol::Bytes& bytes) {
    asio::error_code ignored;  // Whoever was sent away cannot be heard.
    asio::write(socket_, asio::buffer(bytes), ignored);
  }
  void hold_little() { socket_.set_option(asio::socket_base::receive_buffer_size(4096)); }
  void hang_up() { socket_.close(); }
  void half_close() { socket_.shutdown(tcp::socket::shutdown_send); }

  /// The next message; nothing at the end of the connection, or of our patience.
  std::optional<protocol::ServerMessage> hear() {
    for (;;) {
      if (const auto payload = framer_.next()) return protocol::decode_server(*payload).message;
      std::array<std::byte, 4096> bytes;
      const ssize_t count = ::recv(socket_.native_handle(), bytes.data(), bytes.size(), 0);
      if (count <= 0) return {};
      (void)framer_.feed(std::span<const std::byte>(bytes).first(static_cast<std::size_t>(count)));
    }
  }

  /// The next message of a type; the others are passed over.
  template <class Message>
  std::optional<Message> wait_for() {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < deadline) {
      const auto message = hear();
      if (!message) return {};
      if (const auto* it = std::get_if<Message>(&*message)) return *it;
    }
    return {};
  }

  bool at_end() { return !hear().has_value(); }

 private:
  asio::io_context io_{1};
  tcp::socket socket_{io_};
  protocol::Framer framer_{protocol::kServerMessageBytesMax};
};

protocol::Hello greeting(std::int32_t seat = protocol::kAnySeat) {
  protocol::Hello hello;
  hello.scene_digest = scenes::scene_digest(two_seat_scene());
  hello.seat_wish = seat;
  return hello;
}

TEST(Serve, AClientIsWelcomedAndHearsTheMatch) {
  Served server(quiet_options());
  Peer peer(server.port());
  peer.send(greeting(1));
  const auto welcome = peer.wait_for<protocol::Welcome>();
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->seat, 1);
  const auto snapshot = peer.wait_for<protocol::SnapshotPart>();
  ASSERT_TRUE(snapshot);
  EXPECT_EQ(snapshot->tick, welcome->tick);
  for (std::uint64_t tick = welcome->tick + 1; tick <= welcome->tick + 10; ++tick) {
    const auto frame = peer.wait_for<protocol::InputFrame>();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->tick, tick);
  }
  server.stop();
  const auto bye = peer.wait_for<protocol::Bye>();
  ASSERT_TRUE(bye);
  EXPECT_EQ(bye->reason, "told to stop");
  peer.hang_up();
  const ServeReport report = server.report();
  EXPECT_EQ(report.end, End::kDrained);
  EXPECT_TRUE(report.good());
  EXPECT_EQ(report.clients, 1u);
  EXPECT_GT(report.bytes_out, 0u);
  EXPECT_GT(report.bytes_in, 0u);
}

TEST(Serve, TheLogIsTheMatch) {
  ServeOptions options = quiet_options();
  options.ticks = 90;
  options.tick_rate_millihertz = 1'000'000;
  options.scene_name = "two-seats";
  options.log = testing::TempDir() + "cycloid-serve-" + std::to_string(::getpid()) + ".log";
  std::filesystem::remove(options.log);
  Served server(options);
  const ServeReport report = server.report();
  EXPECT_EQ(report.end, End::kTicks);
  EXPECT_EQ(report.ticks, 90u);
  EXPECT_TRUE(report.durable);

  std::ifstream stream(options.log, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
  const protocol::Log log = protocol::read_log(std::as_bytes(std::span(text)));
  std::filesystem::remove(options.log);
  ASSERT_EQ(log.state, protocol::LogState::kComplete) << log.reason;
  EXPECT_EQ(log.footer->digest, report.final_digest);
  const scenes::Loaded scene = scenes::from_binary(log.header.scene);
  ASSERT_TRUE(scene.scene);
  scenes::Simulation replay = simulation_of(*scene.scene);
  for (const protocol::LogTick& tick : log.ticks) {
    std::vector<scenes::SeatInput> inputs;
    for (const protocol::SeatFrame& seat : tick.frame.seats) inputs.push_back(seat.input);
    ASSERT_TRUE(replay.step(inputs).ok());
    ASSERT_EQ(replay.digest(), tick.digest) << tick.frame.tick;
  }
}

TEST(Serve, GarbageIsAnsweredAndTheOthersGoOn) {
  Served server(quiet_options());
  Peer good(server.port());
  good.send(greeting(0));
  ASSERT_TRUE(good.wait_for<protocol::Welcome>());
  Peer bad(server.port());
  protocol::Bytes garbage(64, std::byte{0x41});
  garbage[0] = std::byte{60};
  garbage[1] = garbage[2] = garbage[3] = std::byte{0};
  bad.send_bytes(garbage);
  const auto refused = bad.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, protocol::Refusal::kBadMessage);
  EXPECT_TRUE(bad.at_end());
  ASSERT_TRUE(good.wait_for<protocol::InputFrame>());
  ASSERT_TRUE(good.wait_for<protocol::InputFrame>());
}

/// Much more than the server reads before it closes: the reason must come through all the same.
TEST(Serve, AnOversizedMessageIsRefusedWhileItIsStillBeingSent) {
  Served server(quiet_options());
  Peer peer(server.port());
  protocol::Bytes flood(300'000, std::byte{0x7f});
  peer.send_bytes(flood);
  const auto refused = peer.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, protocol::Refusal::kTooLarge);
}

TEST(Serve, AHelloByteByByteIsAHello) {
  Served server(quiet_options());
  Peer peer(server.port());
  for (const std::byte byte : protocol::encode(protocol::ClientMessage(greeting()))) {
    peer.send_bytes({byte});
  }
  EXPECT_TRUE(peer.wait_for<protocol::Welcome>());
}

TEST(Serve, AConnectionThatSaysNothingIsClosed) {
  ServeOptions options = quiet_options();
  options.limits.handshake = 200ms;
  Served server(options);
  Peer peer(server.port());
  const auto refused = peer.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, protocol::Refusal::kTooSlow);
  EXPECT_TRUE(peer.at_end());
}

TEST(Serve, APeerThatVanishedLosesItsSeat) {
  ServeOptions options = quiet_options();
  options.limits.idle = 300ms;
  Served server(options);
  Peer vanished(server.port());  // Half open: connected, and never heard again.
  vanished.send(greeting(0));
  ASSERT_TRUE(vanished.wait_for<protocol::Welcome>());
  ASSERT_TRUE(vanished.wait_for<protocol::Refused>());
  Peer next(server.port());
  next.send(greeting(0));
  EXPECT_TRUE(next.wait_for<protocol::Welcome>());
}

TEST(Serve, AClosedConnectionFreesItsSeat) {
  Served server(quiet_options());
  Peer first(server.port());
  first.send(greeting(0));
  ASSERT_TRUE(first.wait_for<protocol::Welcome>());
  Peer watcher(server.port());
  watcher.send(greeting(protocol::kSpectator));
  ASSERT_TRUE(watcher.wait_for<protocol::Welcome>());
  first.hang_up();
  const protocol::FrameEvent left{protocol::EventKind::kLeave, 0};
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  bool heard = false;
  while (!heard && std::chrono::steady_clock::now() < deadline) {
    const auto frame = watcher.wait_for<protocol::InputFrame>();
    ASSERT_TRUE(frame);
    heard = std::ranges::find(frame->events, left) != frame->events.end();
  }
  EXPECT_TRUE(heard);
}

TEST(Serve, WhoHangsUpItsSideStillHearsTheRefusal) {
  Served server(quiet_options());
  Peer peer(server.port());
  protocol::Hello hello = greeting();
  hello.protocol_version = 99;
  peer.send(hello);
  peer.half_close();
  const auto refused = peer.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->reason,
            "protocol version 99, here " + std::to_string(protocol::kProtocolVersion));
  EXPECT_TRUE(peer.at_end());
}

/// A peer that never reads, with buffers of the network that hold little: it is closed, and the
/// other has missed nothing.
TEST(Serve, APeerThatReadsNothingIsClosed) {
  ServeOptions options = quiet_options();
  options.tick_rate_millihertz = 5'000'000;
  options.limits.queue_bytes_max = 20'000;
  Served server(options);
  Peer slow;
  slow.hold_little();
  slow.connect(server.port());
  slow.send(greeting(0));
  Peer good(server.port());
  good.send(greeting(1));
  ASSERT_TRUE(good.wait_for<protocol::SnapshotPart>());
  std::uint64_t last = 0;
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  bool left = false;
  while (!left && std::chrono::steady_clock::now() < deadline) {
    const auto frame = good.wait_for<protocol::InputFrame>();
    ASSERT_TRUE(frame);
    ASSERT_TRUE(last == 0 || frame->tick == last + 1) << frame->tick << " after " << last;
    last = frame->tick;
    if (last % 100 == 0) good.send(protocol::Ping{last});
    for (const protocol::FrameEvent& event : frame->events) {
      left = left || (event.kind == protocol::EventKind::kLeave && event.seat == 0);
    }
  }
  EXPECT_TRUE(left);
}

/// While it lives this process can open nothing more.
class NoMoreDescriptors {
 public:
  NoMoreDescriptors() {
    EXPECT_EQ(::getrlimit(RLIMIT_NOFILE, &before_), 0);
    const int next = ::dup(0);
    EXPECT_GE(next, 0);
    (void)::close(next);
    rlimit none = before_;
    none.rlim_cur = static_cast<rlim_t>(next);
    EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  }
  NoMoreDescriptors(const NoMoreDescriptors&) = delete;
  NoMoreDescriptors& operator=(const NoMoreDescriptors&) = delete;
  ~NoMoreDescriptors() { EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &before_), 0); }

 private:
  rlimit before_{};
};

TEST(Serve, WithoutDescriptorsItWaitsAndGoesOn) {
  Served server(quiet_options());
  Peer peer;  // Its descriptor is open before there are none left.
  {
    const NoMoreDescriptors none;
    peer.connect(server.port());
    peer.send(greeting());
    std::this_thread::sleep_for(250ms);
  }
  EXPECT_TRUE(peer.wait_for<protocol::Welcome>());
}

TEST(Serve, WithoutDescriptorsForASecondItTurnsAwayAndCountsThem) {
  Served server(quiet_options());
  Peer peer;
  {
    const NoMoreDescriptors none;
    peer.connect(server.port());
    const auto refused = peer.wait_for<protocol::Refused>();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->code, protocol::Refusal::kRoomFull);
  }
  server.stop();
  EXPECT_EQ(server.report().refusals, 1u);
}

TEST(Serve, SigtermDrains) {
  ServeOptions options = quiet_options();
  options.catch_signals = true;
  Served server(options);
  Peer peer(server.port());
  peer.send(greeting());
  ASSERT_TRUE(peer.wait_for<protocol::Welcome>());
  ASSERT_EQ(::kill(::getpid(), SIGTERM), 0);
  const auto bye = peer.wait_for<protocol::Bye>();
  ASSERT_TRUE(bye);
  EXPECT_EQ(bye->reason, "SIGTERM");
  peer.hang_up();
  EXPECT_TRUE(server.report().good());
}

TEST(Serve, AnAddressThatCannotBeBoundIsAnError) {
  Served server(quiet_options());
  ServeOptions options = quiet_options();
  options.scene = two_seat_scene();
  options.port = server.port();
  options.log = testing::TempDir() + "cycloid-unbound-" + std::to_string(::getpid());
  EXPECT_THROW((void)serve(options, {}), std::system_error);
  EXPECT_FALSE(std::filesystem::exists(options.log));
  options.address = "nowhere";
  EXPECT_THROW((void)serve(options, {}), std::system_error);
}

}  // namespace
}  // namespace cycloid::server
