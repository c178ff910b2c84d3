#include "server/admission/nonces.hpp"

#include <algorithm>

namespace cycloid::server {

NonceStore::Answer NonceStore::check(const TokenNonce& nonce, std::int64_t forget_at_unix_s,
                                     std::int64_t now_unix_s) {
  if (forget_at_unix_s <= forgotten_to_unix_s_ || expiries_.contains(nonce)) return Answer::kUsed;
  while (expiries_.size() >= nonces_max_ && !by_expiry_.empty() &&
         by_expiry_.begin()->first < now_unix_s) {
    const auto oldest = by_expiry_.begin();
    forgotten_to_unix_s_ = std::max(forgotten_to_unix_s_, oldest->first);
    expiries_.erase(oldest->second);
    by_expiry_.erase(oldest);
  }
  return expiries_.size() < nonces_max_ ? Answer::kFresh : Answer::kFull;
}

NonceStore::Answer NonceStore::use(const TokenNonce& nonce, std::int64_t forget_at_unix_s,
                                   std::int64_t now_unix_s) {
  const Answer answer = check(nonce, forget_at_unix_s, now_unix_s);
  if (answer != Answer::kFresh) return answer;
  expiries_.emplace(nonce, forget_at_unix_s);
  by_expiry_.emplace(forget_at_unix_s, nonce);
  return answer;
}

void NonceStore::give_back(const TokenNonce& nonce) {
  const auto found = expiries_.find(nonce);
  if (found == expiries_.end()) return;
  by_expiry_.erase({found->second, nonce});
  expiries_.erase(found);
}

}  // namespace cycloid::server
