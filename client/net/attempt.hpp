#pragma once

#include <asio.hpp>
#include <chrono>
#include <memory>
#include <string>

#include "client/net/connection.hpp"
#include "client/visit.hpp"

namespace cycloid::client {

/// One connection of a visit, from its beginning to its end: the follower says what, the connection
/// carries it.
class Visit::Attempt {
 public:
  /// @param holds_state  The simulation is what the connection before has left, not a new one.
  /// @param wait  Before it connects.
  Attempt(const JoinOptions& options, scenes::Simulation simulation, bool holds_state,
          std::chrono::milliseconds wait);

  void poll(std::chrono::milliseconds wait);
  void stop() { leave(End::kStopped, "told to stop"); }
  /// Nothing is on its way any more.
  bool over() const { return io_.stopped(); }
  End end() const { return end_; }
  const std::string& reason() const { return reason_; }
  Follower& follower() { return *follower_; }
  const Follower& follower() const { return *follower_; }
  const Connection& connection() const { return connection_; }
  /// The first tick of the whole visit, from which `ticks` counts.
  void count_from(std::uint64_t tick) { first_tick_ = tick; }

 private:
  Connection::Handlers handlers();
  void greet();
  void receive(const protocol::ServerMessage& message);
  void react();
  bool advance();
  void on_poll();
  void flush();
  void leave(End end, const std::string& reason);

  const JoinOptions& options_;
  std::unique_ptr<Follower> follower_;
  asio::io_context io_{1};
  asio::steady_timer timer_;
  Connection connection_;
  Outbox outbox_;
  End end_ = End::kDisconnected;
  std::string reason_;
  std::optional<std::uint64_t> first_tick_;
  std::chrono::steady_clock::time_point opened_;
  std::chrono::steady_clock::time_point pinged_;
  std::chrono::steady_clock::time_point frame_at_;  ///< When the last frame came.
  std::uint64_t frame_tick_ = 0;
  std::uint64_t advanced_ = 0;  ///< Ticks predicted by the clock since then.
  bool heard_ = false;          ///< Messages since `react`.
  bool open_ = false;
  bool left_ = false;
};

}  // namespace cycloid::client
