#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/admission/random.hpp"

namespace cycloid::server {

inline constexpr std::size_t kSigningKeyBytes = 32;
inline constexpr std::size_t kSignatureBytes = 64;

using Signature = std::array<std::byte, kSignatureBytes>;

/// The half of an Ed25519 key pair that a server holds: it verifies, and cannot sign.
struct PublicKey {
  std::array<std::byte, kSigningKeyBytes> bytes{};

  /// Begins a token, so that a server with several keys finds the right one: 64 bits of the key's
  /// BLAKE2b, so nobody has to give out numbers.
  std::uint64_t id() const;
  /// "ed25519-public:" and 64 hexadecimal digits, as in a key file and in a configuration.
  std::string text() const;
  /// What `text` made, with white space around it; nothing where it is anything else.
  static std::optional<PublicKey> parse(std::string_view text);
  /// Whether the signature is of these bytes by this key.
  bool verifies(std::span<const std::byte> bytes_signed, const Signature& signature) const;

  friend bool operator==(const PublicKey&, const PublicKey&) = default;
};

/// The issuer's half. Its memory is wiped when it goes.
class SigningKey {
 public:
  static SigningKey generate(const RandomSource& random);
  /// What `text` made, with white space around it; nothing where it is anything else.
  static std::optional<SigningKey> parse(std::string_view text);
  SigningKey(const SigningKey&) = default;
  SigningKey& operator=(const SigningKey&) = default;
  ~SigningKey();

  PublicKey public_key() const;
  Signature sign(std::span<const std::byte> bytes) const;
  /// "ed25519-secret:" and 64 hexadecimal digits. Whoever reads it can admit anybody.
  std::string text() const;

 private:
  using Seed = std::array<std::byte, kSigningKeyBytes>;
  explicit SigningKey(const Seed& seed) : seed_(seed) {}

  Seed seed_;
};

}  // namespace cycloid::server
