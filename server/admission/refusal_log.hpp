#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "protocol/messages.hpp"
#include "server/admission/peer_address.hpp"
#include "server/admission/refill_bucket.hpp"

namespace cycloid::server {

struct RefusalLogOptions {
  std::int64_t repeat_ns = 60'000'000'000;  ///< One cause is written once in this time.
  Rate lines{5, 20};                        ///< Of all causes together.
  std::size_t causes_max = 1024;            ///< Remembered; beyond, only `lines` limits.
};

/// Says whether a refusal is worth a line of the log, so that nobody can fill a disk by being
/// refused. A cause is a code and a host.
class RefusalLog {
 public:
  struct Line {
    bool write = false;
    std::uint64_t suppressed = 0;  ///< Refusals of this cause, or of forgotten ones, not written.
  };

  explicit RefusalLog(const RefusalLogOptions& options = {}, std::int64_t now_ns = 0)
      : options_(options), lines_(options.lines, now_ns) {}

  Line note(protocol::Refusal code, const PeerAddress& address, std::int64_t now_ns);
  std::uint64_t suppressed_total() const { return suppressed_total_; }

 private:
  struct Cause {
    std::int64_t quiet_until_ns = 0;
    std::uint64_t suppressed = 0;
  };
  Cause* cause_of(protocol::Refusal code, const PeerAddress& address, std::int64_t now_ns);

  RefusalLogOptions options_;
  RefillBucket lines_;
  std::map<std::pair<protocol::Refusal, PeerAddress>, Cause> causes_;
  std::int64_t next_sweep_ns_ = 0;
  std::uint64_t suppressed_elsewhere_ = 0;  ///< Of causes that are not remembered.
  std::uint64_t suppressed_total_ = 0;
};

/// "refused 192.0.2.7: kTokenExpired (13): the token expired at ...", and what was left out since.
/// The reason is cut to 256 bytes, and control characters in it are replaced.
std::string refusal_line(protocol::Refusal code, const std::string& reason,
                         const PeerAddress& address, std::uint64_t suppressed);

}  // namespace cycloid::server
