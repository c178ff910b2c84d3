#pragma once

#include <spdlog/logger.h>

#include <array>
#include <asio.hpp>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/admission/gate.hpp"
#include "server/admission/refusal_log.hpp"
#include "server/net/session.hpp"
#include "server/net/socket_options.hpp"
#include "server/net/tls.hpp"
#include "server/operation/meters.hpp"

namespace cycloid::server {

struct GatehouseOptions {
  GateOptions gate;
  SocketOptions sockets;
  std::shared_ptr<ServerTls> tls;  ///< None: TCP alone.
  Gate::FindRoom find_room;
  /// Whom the gate has admitted; may answer with `turn_away`.
  std::function<void(Entrant)> on_admitted;
  std::shared_ptr<spdlog::logger> logger;
};

/// Moves bytes between newcomers and the gate. All of it on the accept strand.
///
/// A newcomer over TCP that is silent costs, in user space, its socket, one wait for it, and an
/// entry here and at the gate: below 4 KiB. There is no coroutine and no buffer of its own: bytes
/// are read into one array that all share, when they are there. One through TLS costs what OpenSSL
/// takes, some 40 KiB, and a coroutine.
class Gatehouse {
 public:
  using Strand = asio::strand<asio::io_context::executor_type>;

  /// @param meters  Shared, because connections that outlive the gatehouse are counted in it.
  Gatehouse(Strand strand, std::shared_ptr<HostMeters> meters, GatehouseOptions options);

  void receive(asio::ip::tcp::socket socket);
  /// One word, then the connection is closed as soon as the peer has had time to read it. It was in
  /// no room: its token is good once more.
  void turn_away(Entrant entrant, const protocol::Refused& refused);
  /// The same at once, for want of a descriptor, of one who has come to no door.
  void turn_away_now(asio::ip::tcp::socket& socket, const protocol::Refused& refused);
  /// From now on newcomers are refused with kDraining.
  void drain(const std::string& reason) { gate_.drain(reason); }
  void set_limits(const GateOptions& limits) { gate_.set_limits(limits); }
  void set_keys(std::vector<PublicKey> keys) { gate_.set_keys(std::move(keys)); }
  /// Lets go of all.
  void close();

 private:
  struct Caller {
    std::unique_ptr<transport::Stream> stream;
    PeerAddress address;
    std::shared_ptr<void> count;
    bool can_be_told = false;   ///< Not in the middle of a handshake.
    std::int64_t until_ns = 0;  ///< Of one that leaves.
  };
  using CallerPtr = std::shared_ptr<Caller>;
  /// Connections that have closed, on whichever thread.
  struct Closed {
    std::mutex mutex;
    std::vector<GateId> ids;
  };

  void wait(GateId id, const CallerPtr& caller);
  void on_readable(GateId id, const CallerPtr& caller);
  asio::awaitable<void> receive_tls(GateId id, CallerPtr caller);
  /// False where that was the last word.
  bool hear(GateId id, const CallerPtr& caller, std::span<const std::byte> bytes);
  void lose(GateId id);
  void see_off(const CallerPtr& caller, GateRefused refused);
  void say_no_more(std::uint64_t leaver, const CallerPtr& caller);
  void wait_for_end(std::uint64_t leaver, const CallerPtr& caller);
  /// Counts it, and writes a line of the log where one is due.
  void note(const PeerAddress& address, protocol::Refusal code, const std::string& reason);
  /// What the peer is told is all that happens to it.
  void say_and_close(asio::ip::tcp::socket& socket, const protocol::Refused& refused);
  void sweep();
  void forget_closed();
  std::shared_ptr<void> counted(GateId id);

  Strand strand_;
  std::shared_ptr<HostMeters> meters_;
  GatehouseOptions options_;
  Gate gate_;
  RefusalLog refusal_log_;
  std::shared_ptr<Closed> closed_ = std::make_shared<Closed>();
  std::map<GateId, CallerPtr> waiting_;
  std::map<std::uint64_t, CallerPtr> leaving_;  ///< In the order of their refusals.
  std::uint64_t leavers_ = 0;
  asio::steady_timer sweep_timer_;
  bool sweeping_ = false;
  bool shut_ = false;
  std::array<std::byte, 4096> scratch_;
};

}  // namespace cycloid::server
