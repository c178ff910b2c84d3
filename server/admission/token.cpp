#include "server/admission/token.hpp"

#include <sodium.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "protocol/little_endian.hpp"
#include "protocol/utf8.hpp"

namespace cycloid::server {
namespace {

constexpr std::uint8_t kTokenFormat = 1;
/// Signed with the token, never sent: a signature that the same key made for something else is none
/// for a token.
constexpr std::string_view kSignedFor = "cycloid admission token";
/// Signature, key, format, role, seat, two times, nonce, two sizes; a room has one byte at least.
constexpr std::size_t kFixedBytes = kSignatureBytes + 8 + 1 + 1 + 4 + 8 + 8 + 16 + 1 + 1;
constexpr std::size_t kTokenBytesMin = kFixedBytes + 1;
static_assert(kFixedBytes + protocol::kRoomNameBytesMax + kIdentityBytesMax <=
              protocol::kTokenBytesMax);

std::vector<std::byte> signed_bytes(std::span<const std::byte> body) {
  const auto purpose = std::as_bytes(std::span(kSignedFor));
  std::vector<std::byte> bytes(purpose.size() + body.size());
  const auto rest = std::copy(purpose.begin(), purpose.end(), bytes.begin());
  std::copy(body.begin(), body.end(), rest);
  return bytes;
}

void append_text(const std::string& text, std::vector<std::byte>& into) {
  protocol::append_little(static_cast<std::uint8_t>(text.size()), into);
  const auto bytes = std::as_bytes(std::span(text));
  into.insert(into.end(), bytes.begin(), bytes.end());
}

std::string take_text(protocol::LittleReader& from) {
  const auto bytes = from.take_bytes(from.take<std::uint8_t>());
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TokenFault invalid(std::string reason) {
  return {protocol::Refusal::kTokenInvalid, std::move(reason)};
}

std::string out_of_size(std::size_t bytes) {
  return "a token of " + std::to_string(bytes) + " bytes, of " + std::to_string(kTokenBytesMin) +
         " to " + std::to_string(protocol::kTokenBytesMax);
}

/// Behind signature and key id. @pre the size is in bounds
std::variant<AdmissionToken, TokenFault> read_fields(protocol::LittleReader from) {
  const auto format = from.take<std::uint8_t>();
  if (format != kTokenFormat) {
    return invalid("token format " + std::to_string(format) + ", here " +
                   std::to_string(kTokenFormat));
  }
  AdmissionToken token;
  token.role = static_cast<Role>(from.take<std::uint8_t>());
  token.seat = static_cast<std::int32_t>(from.take<std::uint32_t>());
  token.not_before_unix_s = static_cast<std::int64_t>(from.take<std::uint64_t>());
  token.expires_unix_s = static_cast<std::int64_t>(from.take<std::uint64_t>());
  const auto nonce = from.take_bytes(token.nonce.size());
  std::copy(nonce.begin(), nonce.end(), token.nonce.begin());
  token.room = take_text(from);
  token.identity = take_text(from);
  if (from.failed || !from.bytes.empty()) return invalid("the token's fields do not fill it");
  if (const std::string mistake = mistake_of(token); !mistake.empty()) return invalid(mistake);
  return token;
}

}  // namespace

std::string mistake_of(const AdmissionToken& token) {
  const auto out_of = [](const char* field, auto value, const std::string& bounds) {
    return std::string("the token's ") + field + " is " + std::to_string(value) + ", " + bounds;
  };
  if (token.room.empty() || token.room.size() > protocol::kRoomNameBytesMax)
    return out_of("room size", token.room.size(), "of 1 to 64 bytes");
  if (token.identity.size() > kIdentityBytesMax)
    return out_of("identity size", token.identity.size(), "of at most 64 bytes");
  if (!protocol::is_utf8(token.room)) return "the token's room is not UTF-8";
  if (!protocol::is_utf8(token.identity)) return "the token's identity is not UTF-8";
  if (token.role < Role::kPlayer || token.role > Role::kAdmin)
    return out_of("role", static_cast<int>(token.role), "of 1 to 3");
  if (token.seat < protocol::kAnySeat || token.seat > 255)
    return out_of("seat", token.seat, "of 0 to 255, or -1");
  if (token.role == Role::kSpectator && token.seat != protocol::kAnySeat)
    return out_of("seat", token.seat, "but a spectator has none");
  if (token.not_before_unix_s < 0)
    return out_of("not-before time", token.not_before_unix_s, "not less than 0");
  if (token.expires_unix_s <= token.not_before_unix_s)
    return out_of("expiry", token.expires_unix_s,
                  "not after " + std::to_string(token.not_before_unix_s));
  const std::int64_t lifetime_s = token.expires_unix_s - token.not_before_unix_s;
  if (lifetime_s > kTokenLifetimeMax_s)
    return out_of("lifetime", lifetime_s,
                  "of at most " + std::to_string(kTokenLifetimeMax_s) + " s");
  return "";
}

std::vector<std::byte> sign_token(const AdmissionToken& token, const SigningKey& key) {
  std::vector<std::byte> body;
  protocol::append_little(key.public_key().id(), body);
  protocol::append_little(kTokenFormat, body);
  protocol::append_little(static_cast<std::uint8_t>(token.role), body);
  protocol::append_little(static_cast<std::uint32_t>(token.seat), body);
  protocol::append_little(static_cast<std::uint64_t>(token.not_before_unix_s), body);
  protocol::append_little(static_cast<std::uint64_t>(token.expires_unix_s), body);
  body.insert(body.end(), token.nonce.begin(), token.nonce.end());
  append_text(token.room, body);
  append_text(token.identity, body);
  return sign_token_bytes(body, key);
}

std::vector<std::byte> sign_token_bytes(std::span<const std::byte> bytes, const SigningKey& key) {
  const Signature signature = key.sign(signed_bytes(bytes));
  std::vector<std::byte> token(signature.size() + bytes.size());
  const auto rest = std::copy(signature.begin(), signature.end(), token.begin());
  std::copy(bytes.begin(), bytes.end(), rest);
  return token;
}

std::string token_text(std::span<const std::byte> token) {
  ready_sodium();
  constexpr int kVariant = sodium_base64_VARIANT_URLSAFE_NO_PADDING;
  std::string text(sodium_base64_encoded_len(token.size(), kVariant), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(token.data()),
                    token.size(), kVariant);
  text.pop_back();
  return text;
}

std::optional<std::vector<std::byte>> parse_token_text(std::string_view text) {
  ready_sodium();
  std::vector<std::byte> token(protocol::kTokenBytesMax);
  std::size_t bytes = 0;
  const char* end = nullptr;
  const int failed = sodium_base642bin(reinterpret_cast<unsigned char*>(token.data()), token.size(),
                                       text.data(), text.size(), nullptr, &bytes, &end,
                                       sodium_base64_VARIANT_URLSAFE_NO_PADDING);
  if (failed != 0 || end != text.data() + text.size() || bytes == 0) return {};
  token.resize(bytes);
  return token;
}

std::variant<UnverifiedToken, TokenFault> read_unverified(std::span<const std::byte> bytes) {
  if (bytes.size() < kTokenBytesMin || bytes.size() > protocol::kTokenBytesMax)
    return invalid(out_of_size(bytes.size()));
  protocol::LittleReader from{bytes.subspan(kSignatureBytes)};
  UnverifiedToken unverified;
  unverified.key_id = from.take<std::uint64_t>();
  auto fields = read_fields(from);
  if (const auto* fault = std::get_if<TokenFault>(&fields)) return *fault;
  unverified.token = std::get<AdmissionToken>(std::move(fields));
  return unverified;
}

std::variant<AdmissionToken, TokenFault> TokenVerifier::verify(std::span<const std::byte> bytes,
                                                               std::int64_t now_unix_s) const {
  if (bytes.empty()) return invalid("no token, and this server asks for one");
  if (bytes.size() < kTokenBytesMin || bytes.size() > protocol::kTokenBytesMax)
    return invalid(out_of_size(bytes.size()));
  Signature signature{};
  std::copy_n(bytes.begin(), signature.size(), signature.begin());
  const auto body = bytes.subspan(kSignatureBytes);
  const auto key_id = solver::load_little<std::uint64_t>(body.data());
  const auto key = std::find_if(keys_.begin(), keys_.end(),
                                [&](const PublicKey& each) { return each.id() == key_id; });
  if (key == keys_.end()) return invalid("the token names a key that is not known here");
  if (!key->verifies(signed_bytes(body), signature))
    return invalid("the token's signature is not of its bytes");
  protocol::LittleReader from{body};
  (void)from.take<std::uint64_t>();
  auto fields = read_fields(from);
  const auto* token = std::get_if<AdmissionToken>(&fields);
  if (token == nullptr) return fields;
  const std::string here = ", the clock here says " + std::to_string(now_unix_s);
  // Of a token that is valid so far no field is below 0, so that neither difference overflows.
  if (now_unix_s - leeway_s_ > token->expires_unix_s) {
    return TokenFault{protocol::Refusal::kTokenExpired,
                      "the token expired at " + std::to_string(token->expires_unix_s) + here};
  }
  if (now_unix_s < token->not_before_unix_s - leeway_s_) {
    return TokenFault{protocol::Refusal::kTokenExpired,
                      "the token is good from " + std::to_string(token->not_before_unix_s) + here};
  }
  return fields;
}

}  // namespace cycloid::server
