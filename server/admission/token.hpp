#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/messages.hpp"
#include "server/admission/keys.hpp"
#include "server/room/admission.hpp"

namespace cycloid::server {

inline constexpr std::size_t kIdentityBytesMax = 64;
/// A used token is remembered until it expires, so none may live for long.
inline constexpr std::int64_t kTokenLifetimeMax_s = 86400;

using TokenNonce = std::array<std::byte, 16>;

/// What an issuer, such as a matchmaker, vouches for: this bearer may enter this room once.
struct AdmissionToken {
  std::string room;                        ///< 1 to 64 bytes of UTF-8.
  std::int32_t seat = protocol::kAnySeat;  ///< kAnySeat: the bearer may choose, or is given one.
  Role role = Role::kPlayer;
  std::string identity;                ///< Who it is, for logs and the room; at most 64 bytes.
  std::int64_t not_before_unix_s = 0;  ///< Good from here on,
  std::int64_t expires_unix_s = 0;     ///< and no longer than to the end of this second.
  TokenNonce nonce{};                  ///< Chance; tells tokens apart that say the same.
  friend bool operator==(const AdmissionToken&, const AdmissionToken&) = default;
};

/// Which field is out of bounds, and by what; "" where none is.
std::string mistake_of(const AdmissionToken& token);

/// The bytes that a client says in its hello, at most protocol::kTokenBytesMax: signature (64),
/// id of the key (8), then the fields. The signature covers all behind it.
/// @pre mistake_of(token) is ""
std::vector<std::byte> sign_token(const AdmissionToken& token, const SigningKey& key);

/// A signature for a token in front of these bytes, whatever they are: how tests get behind it.
std::vector<std::byte> sign_token_bytes(std::span<const std::byte> bytes, const SigningKey& key);

/// base64url without padding, for command lines and JSON; and back, nothing where it is none.
std::string token_text(std::span<const std::byte> token);
std::optional<std::vector<std::byte>> parse_token_text(std::string_view text);

struct TokenFault {
  protocol::Refusal code = protocol::Refusal::kTokenInvalid;
  std::string reason;  ///< What was expected and what came; nothing of a key or a signature.
};

/// The id of the key that the token names, and its fields, whoever may have made them. For showing;
/// nothing that it returns may be trusted.
struct UnverifiedToken {
  std::uint64_t key_id = 0;
  AdmissionToken token;
};
std::variant<UnverifiedToken, TokenFault> read_unverified(std::span<const std::byte> bytes);

/// Verifies before it reads: of an unsigned token only its size and the id of its key are looked
/// at.
class TokenVerifier {
 public:
  /// @param leeway_s  By how much the issuer's clock and ours may differ.
  explicit TokenVerifier(std::vector<PublicKey> keys, std::int64_t leeway_s = 30)
      : keys_(std::move(keys)), leeway_s_(leeway_s) {}

  /// To rotate: add the new key, let the issuer change over, drop the old one.
  void set_keys(std::vector<PublicKey> keys) { keys_ = std::move(keys); }
  bool has_keys() const { return !keys_.empty(); }
  std::int64_t leeway_s() const { return leeway_s_; }

  /// The token, if one of the keys has signed it and it is in its time. Scope and nonce are left to
  /// the caller. kTokenInvalid or kTokenExpired else.
  std::variant<AdmissionToken, TokenFault> verify(std::span<const std::byte> bytes,
                                                  std::int64_t now_unix_s) const;

 private:
  std::vector<PublicKey> keys_;
  std::int64_t leeway_s_;
};

}  // namespace cycloid::server
