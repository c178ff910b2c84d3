#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "protocol/codec.hpp"
#include "server/room/admission.hpp"

namespace cycloid::server {

/// Names a newcomer at the gate; never given out twice.
using NewcomerId = std::uint64_t;

/// What the gate says of a newcomer.
struct Verdict {
  enum class Kind : std::uint8_t { kWait, kAdmit, kRefuse };
  Kind kind = Kind::kWait;
  Admission admission;        ///< Where it admits.
  protocol::Bytes rest;       ///< And what came behind the hello.
  protocol::Refused refused;  ///< Where it refuses.
};

struct GateLimits {
  std::size_t pending_max = 12000;  ///< Newcomers at a time.
  std::int64_t deadline_ns = 5'000'000'000;
};

/// Decides on connections before any room hears of them. Sans I/O; on the accept strand.
///
/// This one frames and decodes the hello and holds the bounds of what has not said one: a deadline
/// that no byte moves, the size of a hello, and how many may wait.
class HelloGate {
 public:
  explicit HelloGate(GateLimits limits) : limits_(limits) {}

  /// A connection from an address. A verdict of kRefuse: it is not known here.
  Verdict arrive(NewcomerId id, const std::string& address, std::int64_t now_ns);
  /// What it has said. After any verdict but kWait it is no longer known here.
  Verdict hear(NewcomerId id, std::span<const std::byte> bytes);
  /// It has hung up.
  void leave(NewcomerId id) { newcomers_.erase(id); }
  /// Those whose deadline has passed: no longer known here.
  std::vector<std::pair<NewcomerId, protocol::Refused>> overdue(std::int64_t now_ns);

  /// From now on; who waits keeps the deadline that it has.
  void set_limits(GateLimits limits) { limits_ = limits; }
  std::size_t pending() const { return newcomers_.size(); }

 private:
  struct Newcomer {
    std::string address;
    std::int64_t deadline_ns = 0;
    protocol::Framer framer{protocol::kHelloBytesMax};
  };

  GateLimits limits_;
  std::map<NewcomerId, Newcomer> newcomers_;
};

}  // namespace cycloid::server
