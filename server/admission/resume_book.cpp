#include "server/admission/resume_book.hpp"

#include <sodium.h>

#include <utility>
#include <vector>

namespace cycloid::server {

ResumeBook::ResumeBook(std::string room, RandomSource random)
    : room_(std::move(room)), random_(std::move(random)) {
  ready_sodium();
}

ResumeBook::Hash ResumeBook::hash_of(std::span<const std::byte> token) const {
  // The token first: its size is fixed, so token and room cannot run into each other.
  std::vector<std::byte> bytes(token.begin(), token.end());
  const auto room = std::as_bytes(std::span(room_));
  bytes.insert(bytes.end(), room.begin(), room.end());
  Hash hash{};
  crypto_generichash(reinterpret_cast<unsigned char*>(hash.data()), hash.size(),
                     reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), nullptr,
                     0);
  sodium_memzero(bytes.data(), bytes.size());
  return hash;
}

ResumeToken ResumeBook::issue(std::int32_t seat) {
  ResumeToken token{};
  random_(token);
  entries_[seat] = Entry{hash_of(token), {}, {}};
  return token;
}

void ResumeBook::let_expire(std::int32_t seat, std::int64_t at_ns) {
  const auto entry = entries_.find(seat);
  if (entry != entries_.end()) entry->second.expires_ns = at_ns;
}

void ResumeBook::confirm(std::int32_t seat) {
  const auto entry = entries_.find(seat);
  if (entry != entries_.end()) entry->second.used.reset();
}

std::optional<ResumeBook::Resumed> ResumeBook::redeem(std::span<const std::byte> token,
                                                      std::int64_t now_ns) {
  if (token.size() != protocol::kResumeBytes) return {};
  const Hash hash = hash_of(token);
  const auto same = [&](const Hash& ours) {
    return sodium_memcmp(ours.data(), hash.data(), hash.size()) == 0;
  };
  std::optional<std::int32_t> seat;
  for (const auto& [each, entry] : entries_) {
    const bool is_next = same(entry.next);
    const bool is_used = entry.used && same(*entry.used);
    const bool lives = !entry.expires_ns || now_ns <= *entry.expires_ns;
    if ((is_next || is_used) && lives) seat = each;
  }
  if (!seat) return {};
  const ResumeToken next = issue(*seat);
  entries_[*seat].used = hash;
  return Resumed{*seat, next};
}

}  // namespace cycloid::server
