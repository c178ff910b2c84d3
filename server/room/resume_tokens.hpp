#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "protocol/messages.hpp"

namespace cycloid::server {

using ResumeSecret = std::array<std::byte, protocol::kResumeBytes>;

/// Which secret brings back which seat. A secret is good once: the next takes its place. Only until
/// the holder has shown that it has the next one does the one before still do, because the message
/// that carried the next may have been lost with its connection.
class ResumeTokens {
 public:
  explicit ResumeTokens(std::size_t seats) : seats_(seats) {}

  /// A new holder: what was given out for the seat before means nothing now.
  void give(std::size_t seat, const ResumeSecret& secret) { seats_[seat] = {secret, {}}; }
  /// The holder has come back.
  void rotate(std::size_t seat, const ResumeSecret& secret, std::span<const std::byte> used);
  /// The holder has the newest one.
  void confirm(std::size_t seat) { seats_[seat].before.reset(); }
  void forget(std::size_t seat) { seats_[seat] = {}; }

  /// The seat that the secret is of. Takes the same time whichever bytes differ.
  std::optional<std::size_t> find(std::span<const std::byte> secret) const;

 private:
  struct Secrets {
    std::optional<ResumeSecret> now;
    std::optional<ResumeSecret> before;
  };
  std::vector<Secrets> seats_;
};

}  // namespace cycloid::server
