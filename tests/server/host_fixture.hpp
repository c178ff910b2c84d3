#pragma once

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <sys/socket.h>

#include <asio.hpp>
#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <thread>

#include "server/host/host.hpp"
#include "tests/server/log_disks.hpp"
#include "tests/server/room_fixture.hpp"

namespace cycloid::server {

/// Every wait of these tests; far more than any of them needs.
inline constexpr auto kHostPatience = std::chrono::seconds(20);

/// Waits until it is so, or patience ends.
inline bool eventually(const std::function<bool()>& so) {
  const auto deadline = std::chrono::steady_clock::now() + kHostPatience;
  while (!so()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

/// A client that blocks, but never for ever.
class HostPeer {
 public:
  explicit HostPeer(std::uint16_t port) {
    socket_.connect({asio::ip::address_v4::loopback(), port});
    const timeval patience{std::chrono::seconds(kHostPatience).count(), 0};
    (void)::setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &patience,
                       sizeof patience);
  }

  void send(const protocol::ClientMessage& message) {
    asio::error_code ignored;  // Whoever was sent away cannot be heard.
    asio::write(socket_, asio::buffer(protocol::encode(message)), ignored);
  }
  void greet(const std::string& room, std::int32_t seat = protocol::kAnySeat) {
    protocol::Hello hello;
    hello.scene_digest = scenes::scene_digest(two_seat_scene());
    hello.seat_wish = seat;
    hello.room = room;
    send(hello);
  }
  void hang_up() { socket_.close(); }

  /// The next message of a type, or nothing at the end of the connection.
  template <class Message>
  std::optional<Message> wait_for() {
    for (;;) {
      while (const auto payload = framer_.next()) {
        const auto decoded = protocol::decode_server(*payload);
        if (!decoded.message) return {};
        if (const auto* it = std::get_if<Message>(&*decoded.message)) return *it;
      }
      std::array<std::byte, 4096> bytes;
      const ssize_t count = ::recv(socket_.native_handle(), bytes.data(), bytes.size(), 0);
      if (count <= 0) return {};
      (void)framer_.feed(std::span<const std::byte>(bytes).first(static_cast<std::size_t>(count)));
    }
  }

 private:
  asio::io_context io_{1};
  asio::ip::tcp::socket socket_{io_};
  protocol::Framer framer_{protocol::kServerMessageBytesMax};
};

/// A disk whose syncs do not return while it hangs.
class HangingDisk final : public ScriptedDisk {
 public:
  explicit HangingDisk(const std::atomic<bool>& hangs) {
    on_sync = [&hangs](int) {
      while (hangs) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return 0;
    };
  }
};

/// What a host has logged.
class HostLines {
 public:
  std::shared_ptr<spdlog::logger> logger() {
    return std::make_shared<spdlog::logger>(
        "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(stream_, true));
  }
  /// After the host has gone.
  std::string text() const { return stream_.str(); }

 private:
  std::ostringstream stream_;
};

inline RoomSettings two_seat_settings() {
  RoomSettings settings;
  settings.scene = two_seat_scene();
  settings.scene_name = settings.scene.name;
  return settings;
}

inline HostOptions quiet_host(HostLines& lines) {
  HostOptions options;
  options.catch_signals = false;
  options.threads = 2;
  options.logger = lines.logger();
  options.templates["duel"] = {two_seat_settings(), true};
  options.templates["hall"] = {two_seat_settings(), false};
  return options;
}

/// The same with a room "arena" that waits for its log's disk in every tick, which may hang.
/// @param log  A path that nothing is at.
inline HostOptions waiting_host(HostLines& lines, const std::string& log,
                                const std::atomic<bool>& hangs) {
  HostOptions options = quiet_host(lines);
  options.disk = std::make_shared<HangingDisk>(hangs);
  options.rooms.push_back({"arena", two_seat_settings()});
  options.rooms[0].settings.log = log;
  options.rooms[0].settings.log_sync = LogSync::kEveryTick;
  return options;
}

/// A host that runs beside the test, and stops with it.
class RunningHost {
 public:
  explicit RunningHost(HostOptions options) : host_(std::move(options)) {
    report_ = std::async(std::launch::async, [this] { return host_.run(stop_.get_token()); });
  }
  ~RunningHost() { stop_.request_stop(); }

  Host& host() { return host_; }
  std::uint16_t port() const { return host_.port(); }
  void stop() { stop_.request_stop(); }
  HostReport report() {
    if (report_.wait_for(kHostPatience) != std::future_status::ready) std::abort();
    return report_.get();
  }
  ActResult make(const std::string& name, const std::string& of_template) {
    std::promise<ActResult> done;
    host_.make_room(name, of_template, [&](ActResult result) { done.set_value(result); });
    return done.get_future().get();
  }
  ActResult act(const std::string& name, LifeAct act, std::chrono::milliseconds deadline = {}) {
    const auto room = host_.find(name);
    if (room == nullptr) return {404, "no room"};
    std::promise<ActResult> done;
    room->act(act, "by the test", deadline, [&](ActResult result) { done.set_value(result); });
    return done.get_future().get();
  }

 private:
  Host host_;
  std::stop_source stop_;
  std::future<HostReport> report_;
};

/// Ends the host. @returns all that it has said.
inline std::string last_words(std::optional<RunningHost>& server, const HostLines& lines) {
  server->stop();
  (void)server->report();
  server.reset();
  return lines.text();
}

}  // namespace cycloid::server
