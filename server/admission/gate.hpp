#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "protocol/codec.hpp"
#include "server/admission/address_limits.hpp"
#include "server/admission/nonces.hpp"
#include "server/admission/token.hpp"
#include "server/room/admission.hpp"

namespace cycloid::server {

/// Names a connection from `Gate::begin` to `Gate::end`; never used twice.
using GateId = std::uint64_t;

enum class TokenPolicy : std::uint8_t {
  kIgnored,   ///< Anybody may come in; a token is not looked at.
  kOptional,  ///< Anybody may come in, but who shows a token shows a good one.
  kRequired,
};

struct GateOptions {
  TokenPolicy tokens = TokenPolicy::kIgnored;
  std::vector<PublicKey> keys;
  std::int64_t leeway_s = 30;
  std::size_t nonces_max = 65536;
  std::int64_t hello_deadline_ns = 5'000'000'000;  ///< From `begin`, handshake of TLS included.
  std::size_t pending_max = 12000;                 ///< Connections whose hello is not accepted.
  std::size_t connections_max = 16384;             ///< Those and the admitted ones.
  AddressLimitOptions addresses;
};

/// What the process has to say to a room's name.
enum class RoomFound : std::uint8_t {
  kExists,
  kCreated,  ///< By this first join.
  kNoSuchRoom,
  kLocked,
  kFull,
  kDraining,
};

struct RoomVerdict {
  RoomFound found = RoomFound::kExists;
  std::string reason;  ///< For a refusal; "": the gate's own words.
};

/// The clock that deadlines and rates run on, and the one that tokens are dated by.
struct GateTime {
  std::int64_t now_ns = 0;  ///< Monotonic.
  std::int64_t unix_s = 0;
};

struct GateRefused {
  protocol::Refusal code = protocol::Refusal::kBadMessage;
  std::string reason;
  protocol::Bytes message;  ///< A Refused, encoded: the last word on the connection.
};

struct GateWaiting {};

struct GateAdmitted {
  Admission admission;          ///< Its hello names the room, even where the client's did not.
  std::vector<std::byte> rest;  ///< What came behind the hello, for the room.
};

using GateResult = std::variant<GateWaiting, GateAdmitted, GateRefused>;

struct GateOverdue {
  GateId id = 0;
  GateRefused refused;
};

struct GateCounts {
  std::uint64_t begun = 0;
  std::uint64_t admitted = 0;
  std::array<std::uint64_t, static_cast<std::size_t>(protocol::kLastRefusal) + 1> refused{};
};

/// Stands before all rooms: takes bytes of connections until each has said who it is, and touches
/// no room for one that it refuses. Sans I/O; all calls on one strand.
///
/// A connection is begun when it was accepted, fed until the answer is not GateWaiting, and ended
/// when its socket is closed, whatever came between. Up to there it counts against its address.
class Gate {
 public:
  /// Told the name and who wants in, once all else is good; may create the room. Not called for
  /// what the gate refuses by itself. What it refuses must not have changed any room.
  using FindRoom = std::function<RoomVerdict(const std::string& room, const Admission&)>;

  Gate(GateOptions options, FindRoom find_room);

  /// The connection's id; or a refusal (kRateLimited, kDraining), and then nothing is held.
  std::variant<GateId, GateRefused> begin(const PeerAddress& address, std::int64_t now_ns);
  /// Takes bytes in. Of a hello no more is held than its size says, 1 KiB at most; what lies behind
  /// it in `bytes` is handed back. After a refusal, or an admission, nothing more is taken.
  GateResult feed(GateId id, std::span<const std::byte> bytes, const GateTime& now);
  /// Those whose deadline has passed, refused with kTooSlow; each once.
  std::vector<GateOverdue> overdue(std::int64_t now_ns);
  /// When `overdue` has something to say next.
  std::optional<std::int64_t> next_deadline_ns() const;
  /// No room has taken in whom the gate admitted, and none will: the token is good once more.
  void give_back_token(const Admission& admission);
  /// The socket is closed. Unknown ids are ignored.
  void end(GateId id);

  /// From now on nobody comes in; those in the gate are refused with kDraining at their hello.
  void drain(const std::string& reason) { draining_ = reason; }
  /// Takes the bounds of connections, of those that wait, and of addresses; those who are in stay.
  void set_limits(const GateOptions& limits);
  /// Rotates the keys; tokens that were used stay used.
  void set_keys(std::vector<PublicKey> keys) { verifier_.set_keys(std::move(keys)); }

  std::size_t pending() const {
    return pending_.size() + refused_;
  }  ///< Not, or not yet, admitted.
  std::size_t connections() const { return open_.size(); }
  std::size_t held_bytes() const;  ///< Of unfinished hellos.
  const GateCounts& counts() const { return counts_; }

 private:
  enum class State : std::uint8_t { kPending, kAdmitted, kRefused };
  struct Open {
    PeerAddress address;
    State state = State::kPending;
  };
  struct Pending {
    protocol::Framer framer{protocol::kHelloBytesMax};
    std::int64_t deadline_ns = 0;
  };

  struct Fault {
    protocol::Refusal code = protocol::Refusal::kBadMessage;
    std::string reason;
  };

  std::string full(const PeerAddress& address, std::int64_t now_ns);
  std::string too_slow() const;
  std::variant<Admission, Fault> judge(const protocol::Hello& hello, const PeerAddress& address,
                                       const GateTime& now);
  std::optional<Fault> check_token(const GateTime& now, Admission& admission,
                                   std::optional<AdmissionToken>& token);
  std::optional<Fault> check_room(const Admission& admission);
  GateRefused refuse(protocol::Refusal code, const std::string& reason);
  GateRefused refuse_open(GateId id, protocol::Refusal code, const std::string& reason);

  GateOptions options_;
  FindRoom find_room_;
  TokenVerifier verifier_;
  NonceStore nonces_;
  AddressLimits addresses_;
  std::map<GateId, Open> open_;
  std::map<GateId, Pending> pending_;  ///< In order of their deadlines, because ids only grow.
  std::size_t refused_ = 0;            ///< Open ones that were refused and still read why.
  GateId next_id_ = 1;
  std::optional<std::string> draining_;
  GateCounts counts_;
};

}  // namespace cycloid::server
