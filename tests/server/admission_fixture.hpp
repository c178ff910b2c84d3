#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/codec.hpp"
#include "server/admission/gate.hpp"
#include "server/admission/token.hpp"

namespace cycloid::server {

/// Chance that is the same in every run.
inline RandomSource seeded_random(std::uint64_t seed) {
  auto random = std::make_shared<std::mt19937_64>(seed);
  return [random](std::span<std::byte> bytes) {
    for (std::byte& each : bytes) each = static_cast<std::byte>((*random)());
  };
}

/// The issuer of these tests.
inline const SigningKey& issuer_key() {
  static const SigningKey kKey = SigningKey::generate(seeded_random(1));
  return kKey;
}

inline constexpr std::int64_t kNowUnix_s = 1'800'000'000;

/// A good token for room "arena", of a nonce made from `number`.
inline AdmissionToken arena_token(std::uint64_t number = 1) {
  AdmissionToken token;
  token.room = "arena";
  token.identity = "ada";
  token.not_before_unix_s = kNowUnix_s - 10;
  token.expires_unix_s = kNowUnix_s + 60;
  seeded_random(number)(token.nonce);
  return token;
}

inline protocol::Hello hello_with(std::vector<std::byte> token) {
  protocol::Hello hello;
  hello.name = "ada";
  hello.token = std::move(token);
  return hello;
}

inline protocol::Hello hello_with(const AdmissionToken& token) {
  return hello_with(sign_token(token, issuer_key()));
}

inline protocol::Bytes bytes_of(const protocol::Hello& hello) {
  return protocol::encode(protocol::ClientMessage(hello));
}

/// A gate before one room "arena", which counts how often anybody asked for a room.
struct GateFixture {
  explicit GateFixture(GateOptions options = required())
      : gate(std::move(options), [this](const std::string& name, const Admission&) {
          ++asked;
          if (name == "arena" || name.empty()) return verdict;
          return RoomVerdict{RoomFound::kNoSuchRoom, ""};
        }) {}

  static GateOptions required() {
    GateOptions options;
    options.tokens = TokenPolicy::kRequired;
    options.keys = {issuer_key().public_key()};
    return options;
  }

  GateId begin(const PeerAddress& address = PeerAddress::v4({192, 0, 2, 7})) {
    const auto begun = gate.begin(address, now.now_ns);
    EXPECT_TRUE(std::holds_alternative<GateId>(begun));
    return std::holds_alternative<GateId>(begun) ? std::get<GateId>(begun) : 0;
  }
  /// One connection from its first byte to the gate's answer.
  GateResult say(const protocol::Hello& hello) {
    const GateId id = begin();
    GateResult result = gate.feed(id, bytes_of(hello), now);
    gate.end(id);
    return result;
  }

  GateTime now{0, kNowUnix_s};
  RoomVerdict verdict;
  int asked = 0;
  Gate gate;
};

inline protocol::Refused refused_of(const protocol::Bytes& message) {
  const auto payload = std::span(message).subspan(protocol::Framer::kPrefixBytes);
  const auto decoded = protocol::decode_server(payload);
  if (!decoded.message) return {};
  const auto* refused = std::get_if<protocol::Refused>(&*decoded.message);
  return refused == nullptr ? protocol::Refused{} : *refused;
}

/// That it was refused so, and that the message for the peer says the same.
inline void expect_refused(const GateResult& result, protocol::Refusal code,
                           const std::string& reason) {
  const auto* refused = std::get_if<GateRefused>(&result);
  ASSERT_NE(refused, nullptr) << "not refused; expected: " << reason;
  EXPECT_EQ(refused->code, code) << refused->reason;
  EXPECT_EQ(refused->reason, reason);
  EXPECT_EQ(refused_of(refused->message).code, code);
  EXPECT_EQ(refused_of(refused->message).reason, reason);
}

}  // namespace cycloid::server
