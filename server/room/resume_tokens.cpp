#include "server/room/resume_tokens.hpp"

#include <algorithm>

#include "server/admission/constant_time.hpp"

namespace cycloid::server {

void ResumeTokens::rotate(std::size_t seat, const ResumeSecret& secret,
                          std::span<const std::byte> used) {
  ResumeSecret before{};
  std::ranges::copy(used.first(before.size()), before.begin());
  seats_[seat] = {secret, before};
}

std::optional<std::size_t> ResumeTokens::find(std::span<const std::byte> secret) const {
  if (secret.size() != protocol::kResumeBytes) return std::nullopt;
  std::optional<std::size_t> found;
  for (std::size_t seat = 0; seat < seats_.size(); ++seat) {
    for (const auto& ours : {seats_[seat].now, seats_[seat].before}) {
      if (ours && equal_in_constant_time(*ours, secret)) found = seat;
    }
  }
  return found;
}

}  // namespace cycloid::server
