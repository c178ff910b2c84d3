#include "server/admission/keys.hpp"

#include <sodium.h>

#include "solver/bytes.hpp"

namespace cycloid::server {
namespace {

using KeyBytes = std::array<std::byte, kSigningKeyBytes>;

constexpr std::string_view kPublicPrefix = "ed25519-public:";
constexpr std::string_view kSecretPrefix = "ed25519-secret:";

static_assert(kSignatureBytes == crypto_sign_BYTES);
static_assert(kSigningKeyBytes == crypto_sign_SEEDBYTES);
static_assert(kSigningKeyBytes == crypto_sign_PUBLICKEYBYTES);

const unsigned char* raw(const std::byte* bytes) {
  return reinterpret_cast<const unsigned char*>(bytes);
}

unsigned char* raw(std::byte* bytes) {
  return reinterpret_cast<unsigned char*>(bytes);
}

// Hexadecimal by libsodium, whose time does not depend on the digits.

std::string to_text(std::string_view prefix, const KeyBytes& bytes) {
  std::string hex(2 * bytes.size() + 1, '\0');
  sodium_bin2hex(hex.data(), hex.size(), raw(bytes.data()), bytes.size());
  hex.pop_back();
  std::string text = std::string(prefix) + hex;
  sodium_memzero(hex.data(), hex.size());
  return text;
}

std::optional<KeyBytes> from_text(std::string_view prefix, std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  text = text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
  if (!text.starts_with(prefix)) return {};
  text.remove_prefix(prefix.size());
  KeyBytes bytes{};
  if (text.size() != 2 * bytes.size()) return {};
  std::size_t taken = 0;
  const char* end = nullptr;
  const int failed = sodium_hex2bin(raw(bytes.data()), bytes.size(), text.data(), text.size(),
                                    nullptr, &taken, &end);
  if (failed != 0 || taken != bytes.size() || end != text.data() + text.size()) return {};
  return bytes;
}

/// A pair made from its seed, wiped when it goes.
struct KeyPair {
  explicit KeyPair(const KeyBytes& seed) {
    ready_sodium();
    crypto_sign_seed_keypair(raw(public_bytes.data()), secret.data(), raw(seed.data()));
  }
  KeyPair(const KeyPair&) = delete;
  KeyPair& operator=(const KeyPair&) = delete;
  ~KeyPair() { sodium_memzero(secret.data(), secret.size()); }

  KeyBytes public_bytes{};
  std::array<unsigned char, crypto_sign_SECRETKEYBYTES> secret{};
};

}  // namespace

std::uint64_t PublicKey::id() const {
  ready_sodium();
  std::array<std::byte, crypto_generichash_BYTES> hash{};
  crypto_generichash(raw(hash.data()), hash.size(), raw(bytes.data()), bytes.size(), nullptr, 0);
  return solver::load_little<std::uint64_t>(hash.data());
}

std::string PublicKey::text() const {
  return to_text(kPublicPrefix, bytes);
}

std::optional<PublicKey> PublicKey::parse(std::string_view text) {
  const auto bytes = from_text(kPublicPrefix, text);
  if (!bytes) return {};
  return PublicKey{*bytes};
}

bool PublicKey::verifies(std::span<const std::byte> bytes_signed,
                         const Signature& signature) const {
  ready_sodium();
  return crypto_sign_verify_detached(raw(signature.data()), raw(bytes_signed.data()),
                                     bytes_signed.size(), raw(bytes.data())) == 0;
}

SigningKey SigningKey::generate(const RandomSource& random) {
  SigningKey key{Seed{}};
  random(key.seed_);
  return key;
}

std::optional<SigningKey> SigningKey::parse(std::string_view text) {
  auto seed = from_text(kSecretPrefix, text);
  if (!seed) return {};
  SigningKey key(*seed);
  sodium_memzero(seed->data(), seed->size());
  return key;
}

SigningKey::~SigningKey() {
  sodium_memzero(seed_.data(), seed_.size());
}

PublicKey SigningKey::public_key() const {
  return PublicKey{KeyPair(seed_).public_bytes};
}

Signature SigningKey::sign(std::span<const std::byte> bytes) const {
  const KeyPair pair(seed_);
  Signature signature{};
  crypto_sign_detached(raw(signature.data()), nullptr, raw(bytes.data()), bytes.size(),
                       pair.secret.data());
  return signature;
}

std::string SigningKey::text() const {
  return to_text(kSecretPrefix, seed_);
}

}  // namespace cycloid::server
