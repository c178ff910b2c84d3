#include "cli/sim/issuer.hpp"

#include <span>

namespace cycloid::sim {
namespace {

constexpr std::int64_t kEpochUnix_s = 1'700'000'000;
constexpr std::int64_t kLifetime_s = 60;

}  // namespace

std::int64_t unix_s_of(std::int64_t now_ns) {
  return kEpochUnix_s + now_ns / 1'000'000'000;
}

Issuer::Issuer(Random random)
    : random_(random), key_(server::SigningKey::generate([this](std::span<std::byte> into) {
        random_.fill(into);
      })) {}

server::AdmissionToken Issuer::token(const std::string& room, std::int64_t now_ns) {
  server::AdmissionToken token;
  token.room = room;
  token.not_before_unix_s = unix_s_of(now_ns);
  token.expires_unix_s = token.not_before_unix_s + kLifetime_s;
  random_.fill(token.nonce);
  return token;
}

}  // namespace cycloid::sim
