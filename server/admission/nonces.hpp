#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "server/admission/token.hpp"

namespace cycloid::server {

/// Which tokens were used: each nonce is kept for as long as its token could be shown again.
///
/// Bounded. Only what has expired is forgotten, and only to make room; a store full of live nonces
/// takes no more. A token that could be among the forgotten ones, because the clock was set back
/// since, counts as used.
class NonceStore {
 public:
  enum class Answer : std::uint8_t { kFresh, kUsed, kFull };

  explicit NonceStore(std::size_t nonces_max) : nonces_max_(nonces_max) {}

  /// What `use` would say; remembers nothing. Forgets what has expired if it needs the room.
  Answer check(const TokenNonce& nonce, std::int64_t forget_at_unix_s, std::int64_t now_unix_s);
  /// kFresh: it is used from now on until `forget_at_unix_s` has passed. Else nothing changes.
  Answer use(const TokenNonce& nonce, std::int64_t forget_at_unix_s, std::int64_t now_unix_s);
  /// It is fresh again, because its token has let nobody in. One that is not used stays so.
  void give_back(const TokenNonce& nonce);
  std::size_t size() const { return expiries_.size(); }

 private:
  std::size_t nonces_max_;
  std::map<TokenNonce, std::int64_t> expiries_;
  std::set<std::pair<std::int64_t, TokenNonce>> by_expiry_;
  std::int64_t forgotten_to_unix_s_ = -1;  ///< The latest expiry among those forgotten.
};

}  // namespace cycloid::server
