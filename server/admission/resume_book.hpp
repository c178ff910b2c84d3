#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "protocol/messages.hpp"
#include "server/admission/random.hpp"

namespace cycloid::server {

using ResumeToken = std::array<std::byte, protocol::kResumeBytes>;

/// Which secret brings back which seat of one room. A token is chance and is kept only as its hash,
/// so a dump of the process gives none away. Each is good once: the next takes its place. Only
/// until the holder has shown that it has the next one is the used one still good, because the
/// Welcome that carried the next may have been lost with its connection.
class ResumeBook {
 public:
  struct Resumed {
    std::int32_t seat = 0;
    ResumeToken next{};  ///< What brings the seat back the next time.
  };

  /// @param room  Goes into the hash: a token of another room is unknown here.
  ResumeBook(std::string room, RandomSource random);

  /// A token for a new holder of the seat, for its Welcome. What was given out for the seat before
  /// is dead. Does not expire until `let_expire` is called.
  ResumeToken issue(std::int32_t seat);
  /// The holder's connection is gone: the seat's tokens are good up to this time, and no longer.
  void let_expire(std::int32_t seat, std::int64_t at_ns);
  /// The seat of the token and the token to use next; neither expires now. Nothing where it is
  /// unknown, used or expired, and nothing has changed then. Compares with all seats, in a time
  /// that tells nothing of any.
  std::optional<Resumed> redeem(std::span<const std::byte> token, std::int64_t now_ns);
  /// The holder has the next token, as anything shows that it said behind its Welcome: the one that
  /// it used is dead.
  void confirm(std::int32_t seat);
  /// The seat was left, or its holder sent away: no token brings it back.
  void forget(std::int32_t seat) { entries_.erase(seat); }
  std::size_t size() const { return entries_.size(); }

 private:
  using Hash = std::array<std::byte, 32>;
  struct Entry {
    Hash next{};               ///< Of the newest token.
    std::optional<Hash> used;  ///< Of the one before, until `confirm`.
    std::optional<std::int64_t> expires_ns;
  };
  Hash hash_of(std::span<const std::byte> token) const;

  std::string room_;
  RandomSource random_;
  std::map<std::int32_t, Entry> entries_;
};

}  // namespace cycloid::server
