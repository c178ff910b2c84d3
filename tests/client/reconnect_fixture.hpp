#pragma once

#include <gtest/gtest.h>

#include <asio.hpp>
#include <functional>
#include <future>
#include <optional>
#include <thread>

#include "client/join.hpp"
#include "protocol/codec.hpp"
#include "tests/client/authority.hpp"

namespace cycloid::client {

using asio::ip::tcp;
using std::chrono::milliseconds;

/// A connection as a server sees it, blocking.
class Peer {
 public:
  explicit Peer(tcp::socket socket) : socket_(std::move(socket)) {}

  void tell(const protocol::ServerMessage& message) {
    asio::error_code ignored;
    asio::write(socket_, asio::buffer(protocol::encode(message)), ignored);
  }
  protocol::Hello hear_hello() { return std::get<protocol::Hello>(hear()); }
  /// The next message; a Bye where the client has closed its side.
  protocol::ClientMessage hear() {
    for (;;) {
      if (const auto payload = framer_.next()) return *protocol::decode_client(*payload).message;
      std::array<std::byte, 4096> bytes{};
      asio::error_code error;
      const std::size_t size = socket_.read_some(asio::buffer(bytes), error);
      if (error) return protocol::Bye{"closed"};
      (void)framer_.feed(std::span<const std::byte>(bytes).first(size));
    }
  }
  /// Takes messages in until there is one of this kind, into `before` those that came first.
  template <class Message>
  std::optional<Message> hear_until(std::vector<protocol::ClientMessage>& before) {
    for (;;) {
      protocol::ClientMessage message = hear();
      if (auto* wanted = std::get_if<Message>(&message)) return *wanted;
      if (std::holds_alternative<protocol::Bye>(message)) return std::nullopt;
      before.push_back(std::move(message));
    }
  }
  /// Until the client has closed its side, so that nothing it was told is lost in a reset.
  void drain() {
    asio::error_code error;
    std::array<std::byte, 4096> bytes{};
    while (!error) (void)socket_.read_some(asio::buffer(bytes), error);
  }
  /// Nothing more will be said; what was said is heard.
  void hang_up() {
    asio::error_code ignored;
    socket_.shutdown(tcp::socket::shutdown_send, ignored);
    drain();
  }
  void reset() {
    asio::error_code ignored;
    socket_.set_option(tcp::socket::linger(true, 0), ignored);
    socket_.close(ignored);
  }

 private:
  tcp::socket socket_;
  protocol::Framer framer_{4096};
};

inline std::vector<std::byte> resume_token(int number) {
  return std::vector<std::byte>(protocol::kResumeBytes, std::byte(number));
}

/// A server that does something else with every connection, as a test says.
class Reconnect : public testing::Test {
 protected:
  using Script = std::function<void(Peer&, const protocol::Hello&)>;

  Reconnect() : scene_(Authority::scene()), authority_(scene_) {
    options_.port = acceptor_.local_endpoint().port();
    options_.scene = scene_;
    options_.room = "hall";
    options_.token = {std::byte{7}};
    options_.reconnect.on = true;
    options_.reconnect.first = milliseconds(10);
    options_.reconnect.longest = milliseconds(40);
    options_.reconnect.deadline = milliseconds(10000);
    options_.on_welcome = [this](const protocol::Welcome&) { ++welcomes_; };
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    options_.should_stop = [deadline] { return std::chrono::steady_clock::now() > deadline; };
  }

  JoinReport play(const std::vector<Script>& scripts) {
    auto server = std::async(std::launch::async, [&] {
      for (const Script& script : scripts) {
        Peer peer(acceptor_.accept());
        const protocol::Hello hello = peer.hear_hello();
        hellos_.push_back(hello);
        script(peer, hello);
      }
      acceptor_.close();
    });
    const JoinReport report = join(options_);
    server.wait();
    return report;
  }

  /// Lets the client in, and shows it some ticks.
  void welcome(Peer& peer, int token, int ticks) {
    protocol::Welcome welcome = authority_.welcome(1);
    welcome.resume = resume_token(token);
    welcome.room = "hall";
    peer.tell(welcome);
    peer.tell(authority_.snapshot());
    for (int i = 0; i < ticks; ++i) peer.tell(authority_.frame());
  }
  /// Lets the client in, and tells it its state in parts: before the last one `wait` is called,
  /// while the client loads.
  void welcome_in_parts(Peer& peer, const std::function<void()>& wait) {
    protocol::Welcome welcome = authority_.welcome(1);
    welcome.resume = resume_token(1);
    peer.tell(welcome);
    const auto parts = parts_of(authority_.snapshot());
    ASSERT_GT(parts.size(), 1u);
    for (const protocol::SnapshotPart& part : parts) {
      if (&part == &parts.back()) wait();
      peer.tell(part);
    }
  }
  /// Lets the client in, shows it some ticks, and hangs up once all was heard.
  Script hang_up_after(int ticks) {
    return [this, ticks](Peer& peer, const protocol::Hello&) {
      welcome(peer, 1, ticks);
      peer.hang_up();
    };
  }
  static Script refuse(protocol::Refusal code) {
    return [code](Peer& peer, const protocol::Hello&) {
      peer.tell(protocol::Refused{code, "no"});
      peer.drain();
    };
  }

  scenes::Scene scene_;
  Authority authority_;
  asio::io_context io_;
  tcp::acceptor acceptor_{io_, {asio::ip::address_v4::loopback(), 0}};
  JoinOptions options_;
  std::vector<protocol::Hello> hellos_;
  int welcomes_ = 0;
};

}  // namespace cycloid::client
