#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/sim/random.hpp"
#include "server/admission/token.hpp"

namespace cycloid::sim {

/// The clock that tokens are dated by, from the clock of a run.
std::int64_t unix_s_of(std::int64_t now_ns);

/// The matchmaker of a run: signs tokens with a key of the seed, and never the same nonce twice.
class Issuer {
 public:
  explicit Issuer(Random random);

  server::PublicKey public_key() const { return key_.public_key(); }
  /// For the room, any seat, from now on for a minute, which no hello is on its way for.
  server::AdmissionToken token(const std::string& room, std::int64_t now_ns);
  std::vector<std::byte> sign(const server::AdmissionToken& token) const {
    return server::sign_token(token, key_);
  }

 private:
  Random random_;
  server::SigningKey key_;
};

}  // namespace cycloid::sim
