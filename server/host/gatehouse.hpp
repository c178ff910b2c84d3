#pragma once

#include <array>
#include <asio.hpp>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>

#include "server/host/gate.hpp"
#include "server/net/session.hpp"
#include "server/net/socket_options.hpp"
#include "server/operation/meters.hpp"

namespace cycloid::server {

struct GatehouseOptions {
  GateLimits gate;
  SocketOptions sockets;
  std::size_t connections_max = 12000;  ///< Of the process, those in rooms too.
  /// Whom the gate has admitted; may answer with `turn_away`.
  std::function<void(Entrant)> on_admitted;
};

/// Moves bytes between newcomers and the gate. All of it on the accept strand.
///
/// A newcomer that is silent costs, in user space, its socket, one wait for it, and an entry here
/// and at the gate: below 1.5 KiB. There is no coroutine and no buffer of its own: bytes are read
/// into one array that all share, when they are there.
class Gatehouse {
 public:
  using Strand = asio::strand<asio::io_context::executor_type>;

  /// @param meters  Shared, because connections that outlive the gatehouse are counted in it.
  Gatehouse(Strand strand, std::shared_ptr<HostMeters> meters, GatehouseOptions options);

  void receive(asio::ip::tcp::socket socket);
  /// One word, then the connection is closed as soon as the peer has had time to read it.
  void turn_away(asio::ip::tcp::socket socket, const protocol::Refused& refused);
  /// The same at once, for want of a descriptor.
  void turn_away_now(asio::ip::tcp::socket& socket, const protocol::Refused& refused);
  /// From now on newcomers are told this, or again let in.
  void set_closed(std::optional<protocol::Refused> refused) { closed_ = std::move(refused); }
  void set_limits(const GateLimits& limits, std::size_t connections_max);
  /// Lets go of all.
  void close();

 private:
  struct Caller {
    explicit Caller(asio::ip::tcp::socket taken) : socket(std::move(taken)) {}
    asio::ip::tcp::socket socket;
    std::shared_ptr<void> count;
    std::int64_t until_ns = 0;  ///< Of one that leaves.
  };
  using CallerPtr = std::shared_ptr<Caller>;

  void wait(NewcomerId id, const CallerPtr& caller);
  void on_readable(NewcomerId id, const CallerPtr& caller);
  void obey(NewcomerId id, const CallerPtr& caller, Verdict verdict);
  void see_off(const CallerPtr& caller, const protocol::Refused& refused);
  void wait_for_end(NewcomerId id, const CallerPtr& caller);
  void sweep();
  void count_pending();

  Strand strand_;
  std::shared_ptr<HostMeters> meters_;
  GatehouseOptions options_;
  HelloGate gate_;
  std::optional<protocol::Refused> closed_;
  std::map<NewcomerId, CallerPtr> waiting_;
  std::map<NewcomerId, CallerPtr> leaving_;
  NewcomerId last_id_ = 0;
  asio::steady_timer sweep_timer_;
  bool sweeping_ = false;
  bool shut_ = false;
  std::array<std::byte, 4096> scratch_;
};

}  // namespace cycloid::server
