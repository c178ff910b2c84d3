#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "server/admission/nonces.hpp"
#include "tests/server/admission_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::Refusal;
using testing::HasSubstr;
using testing::Not;

TokenVerifier arena_verifier() {
  return TokenVerifier({issuer_key().public_key()}, 30);
}

TokenFault fault_of(const std::variant<AdmissionToken, TokenFault>& verified) {
  const auto* fault = std::get_if<TokenFault>(&verified);
  EXPECT_NE(fault, nullptr) << "it was taken";
  return fault == nullptr ? TokenFault{} : *fault;
}

TEST(AdmissionToken, ComesBackAsItWasSigned) {
  AdmissionToken token = arena_token();
  for (const Role role : {Role::kPlayer, Role::kSpectator, Role::kAdmin}) {
    token.role = role;
    token.seat = role == Role::kSpectator ? protocol::kAnySeat : 3;
    const auto bytes = sign_token(token, issuer_key());
    EXPECT_LE(bytes.size(), protocol::kTokenBytesMax);
    const auto verified = arena_verifier().verify(bytes, kNowUnix_s);
    ASSERT_TRUE(std::holds_alternative<AdmissionToken>(verified));
    EXPECT_EQ(std::get<AdmissionToken>(verified), token);
  }
}

TEST(AdmissionToken, WithAnyBitFlippedIsInvalid) {
  const auto good = sign_token(arena_token(), issuer_key());
  const TokenVerifier verifier = arena_verifier();
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto bytes = good;
    bytes[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
    EXPECT_EQ(fault_of(verifier.verify(bytes, kNowUnix_s)).code, Refusal::kTokenInvalid) << bit;
  }
}

TEST(AdmissionToken, CutOrExtendedAnywhereIsInvalid) {
  const auto good = sign_token(arena_token(), issuer_key());
  const TokenVerifier verifier = arena_verifier();
  for (std::size_t bytes = 0; bytes < 2 * protocol::kTokenBytesMax; ++bytes) {
    if (bytes == good.size()) continue;
    auto other = good;
    other.resize(bytes);
    EXPECT_EQ(fault_of(verifier.verify(other, kNowUnix_s)).code, Refusal::kTokenInvalid) << bytes;
  }
  EXPECT_EQ(fault_of(verifier.verify({}, kNowUnix_s)).reason,
            "no token, and this server asks for one");
  EXPECT_EQ(fault_of(verifier.verify(std::vector<std::byte>(513), kNowUnix_s)).reason,
            "a token of 513 bytes, of 113 to 512");
}

TEST(AdmissionToken, OfAnUnknownKeyIsInvalidUntilTheKeyIsAdded) {
  const SigningKey next = SigningKey::generate(seeded_random(2));
  const auto bytes = sign_token(arena_token(), next);
  TokenVerifier verifier = arena_verifier();
  const TokenFault fault = fault_of(verifier.verify(bytes, kNowUnix_s));
  EXPECT_EQ(fault.code, Refusal::kTokenInvalid);
  EXPECT_EQ(fault.reason, "the token names a key that is not known here");
  verifier.set_keys({issuer_key().public_key(), next.public_key()});
  EXPECT_TRUE(std::holds_alternative<AdmissionToken>(verifier.verify(bytes, kNowUnix_s)));
  const auto old = sign_token(arena_token(), issuer_key());
  EXPECT_TRUE(std::holds_alternative<AdmissionToken>(verifier.verify(old, kNowUnix_s)));
  verifier.set_keys({next.public_key()});
  EXPECT_EQ(fault_of(verifier.verify(old, kNowUnix_s)).code, Refusal::kTokenInvalid);
}

TEST(AdmissionToken, SignatureOfTheSameBytesForSomethingElseIsNone) {
  auto bytes = sign_token(arena_token(), issuer_key());
  const Signature plain = issuer_key().sign(std::span(bytes).subspan(kSignatureBytes));
  std::copy(plain.begin(), plain.end(), bytes.begin());
  EXPECT_EQ(fault_of(arena_verifier().verify(bytes, kNowUnix_s)).code, Refusal::kTokenInvalid);
}

TEST(AdmissionToken, IsGoodFromItsFirstSecondToItsLastWithTheLeeway) {
  const AdmissionToken token = arena_token();
  const auto bytes = sign_token(token, issuer_key());
  const TokenVerifier verifier = arena_verifier();
  const auto at = [&](std::int64_t unix_s) { return verifier.verify(bytes, unix_s); };
  const std::int64_t first_s = token.not_before_unix_s - 30;
  const std::int64_t last_s = token.expires_unix_s + 30;
  EXPECT_TRUE(std::holds_alternative<AdmissionToken>(at(first_s)));
  EXPECT_TRUE(std::holds_alternative<AdmissionToken>(at(last_s)));
  EXPECT_EQ(fault_of(at(last_s + 1)).code, Refusal::kTokenExpired);
  EXPECT_EQ(fault_of(at(last_s + 1)).reason,
            "the token expired at 1800000060, the clock here says 1800000091");
  EXPECT_EQ(fault_of(at(first_s - 1)).code, Refusal::kTokenExpired);
  EXPECT_EQ(fault_of(at(first_s - 1)).reason,
            "the token is good from 1799999990, the clock here says 1799999959");
}

TEST(AdmissionToken, OfTheEndOfTimeIsNotTakenForAnOldOne) {
  AdmissionToken token = arena_token();
  token.expires_unix_s = std::numeric_limits<std::int64_t>::max();
  token.not_before_unix_s = token.expires_unix_s - 60;
  const auto bytes = sign_token(token, issuer_key());
  const TokenFault fault = fault_of(arena_verifier().verify(bytes, kNowUnix_s));
  EXPECT_EQ(fault.code, Refusal::kTokenExpired);
  EXPECT_THAT(fault.reason, HasSubstr("the token is good from 9223372036854775747"));
}

TEST(AdmissionToken, WithAFieldOutOfBoundsIsInvalidAndTheFieldIsNamed) {
  struct Case {
    std::function<void(AdmissionToken&)> spoil;
    const char* reason;
  };
  const Case cases[] = {
      {[](AdmissionToken& t) { t.room.clear(); }, "room size is 0"},
      {[](AdmissionToken& t) { t.room.assign(65, 'a'); }, "room size is 65"},
      {[](AdmissionToken& t) { t.room = "\xff"; }, "room is not UTF-8"},
      {[](AdmissionToken& t) { t.identity.assign(65, 'a'); }, "identity size is 65"},
      {[](AdmissionToken& t) { t.identity = "\xc0\x80"; }, "identity is not UTF-8"},
      {[](AdmissionToken& t) { t.role = static_cast<Role>(0); }, "role is 0"},
      {[](AdmissionToken& t) { t.role = static_cast<Role>(4); }, "role is 4"},
      {[](AdmissionToken& t) { t.seat = -2; }, "seat is -2"},
      {[](AdmissionToken& t) { t.seat = 256; }, "seat is 256"},
      {[](AdmissionToken& t) { t.role = Role::kSpectator, t.seat = 0; }, "a spectator has none"},
      {[](AdmissionToken& t) { t.not_before_unix_s = -1; }, "not-before time is -1"},
      {[](AdmissionToken& t) { t.expires_unix_s = t.not_before_unix_s; }, "expiry is 1799999990"},
      {[](AdmissionToken& t) { t.expires_unix_s += 86400; }, "lifetime is 86470"},
  };
  for (const Case& bad : cases) {
    AdmissionToken token = arena_token();
    bad.spoil(token);
    EXPECT_THAT(mistake_of(token), HasSubstr(bad.reason));
    const TokenFault fault =
        fault_of(arena_verifier().verify(sign_token(token, issuer_key()), kNowUnix_s));
    EXPECT_EQ(fault.code, Refusal::kTokenInvalid) << bad.reason;
    EXPECT_EQ(fault.reason, mistake_of(token));
  }
  EXPECT_EQ(mistake_of(arena_token()), "");
}

TEST(AdmissionToken, ReasonsHoldNothingOfKeysOrSignatures) {
  auto bytes = sign_token(arena_token(), issuer_key());
  const std::string public_hex = issuer_key().public_key().text().substr(15, 16);
  for (const std::size_t at : {std::size_t{0}, kSignatureBytes, bytes.size() - 1}) {
    auto bad = bytes;
    bad[at] ^= std::byte{1};
    const std::string reason = fault_of(arena_verifier().verify(bad, kNowUnix_s)).reason;
    EXPECT_THAT(reason, Not(HasSubstr(public_hex)));
    EXPECT_THAT(reason, Not(HasSubstr("arena")));
  }
}

TEST(AdmissionToken, TextComesBackAndOtherTextIsNone) {
  const auto bytes = sign_token(arena_token(), issuer_key());
  const std::string text = token_text(bytes);
  EXPECT_EQ(parse_token_text(text), bytes);
  EXPECT_EQ(text.find_first_of("+/= \n"), std::string::npos);
  const std::vector<std::string> others = {"",    text + "=", text + "\n",
                                           "a b", "!",        std::string(1000, 'A')};
  for (const std::string& bad : others) EXPECT_FALSE(parse_token_text(bad).has_value()) << bad;
}

TEST(SigningKeys, ComeBackFromTheirTextAndOtherTextIsNone) {
  const SigningKey& key = issuer_key();
  const auto again = SigningKey::parse("  " + key.text() + "\n");
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->public_key(), key.public_key());
  const PublicKey half = key.public_key();
  EXPECT_EQ(PublicKey::parse(half.text() + "\r\n"), half);
  EXPECT_FALSE(PublicKey::parse(key.text()).has_value());
  EXPECT_FALSE(SigningKey::parse(half.text()).has_value());
  for (const std::string& bad :
       {std::string(), std::string("ed25519-public:"), half.text() + "0",
        half.text().substr(0, half.text().size() - 1) + "g", half.text() + " " + half.text()})
    EXPECT_FALSE(PublicKey::parse(bad).has_value()) << bad;
}

TEST(SigningKeys, SignAsRfc8032Says) {
  // Test 2 of section 7.1.
  const auto key = SigningKey::parse(
      "ed25519-secret:4ccd089b28ff96da9db6c346ec114e0f5b8a319f35aba624da8cf6ed4fb8a6fb");
  ASSERT_TRUE(key.has_value());
  EXPECT_EQ(key->public_key().text(),
            "ed25519-public:3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c");
  const std::byte message[] = {std::byte{0x72}};
  const Signature signature = key->sign(message);
  EXPECT_EQ(signature[0], std::byte{0x92});
  EXPECT_EQ(signature[1], std::byte{0xa0});
  EXPECT_EQ(signature[63], std::byte{0x00});
  EXPECT_EQ(signature[62], std::byte{0x0c});
  EXPECT_TRUE(key->public_key().verifies(message, signature));
}

TokenNonce nonce_of(std::uint64_t number) {
  TokenNonce nonce{};
  seeded_random(number)(nonce);
  return nonce;
}

TEST(NonceStore, KnowsEveryNonceUntilItsTimeIsOver) {
  NonceStore store(8);
  EXPECT_EQ(store.check(nonce_of(1), 100, 50), NonceStore::Answer::kFresh);
  EXPECT_EQ(store.size(), 0u);
  EXPECT_EQ(store.use(nonce_of(1), 100, 50), NonceStore::Answer::kFresh);
  for (const std::int64_t now_s : {50, 99, 100, 101, 1000})
    EXPECT_EQ(store.use(nonce_of(1), 100, now_s), NonceStore::Answer::kUsed) << now_s;
  EXPECT_EQ(store.use(nonce_of(1), 200, 50), NonceStore::Answer::kUsed);
}

TEST(NonceStore, AtItsBoundRefusesAndForgetsOnlyWhatHasExpired) {
  constexpr std::size_t kMost = 100;
  NonceStore store(kMost);
  for (std::uint64_t i = 0; i < kMost; ++i) {
    const auto forget_at_s = static_cast<std::int64_t>(1000 + i);
    ASSERT_EQ(store.use(nonce_of(i), forget_at_s, 0), NonceStore::Answer::kFresh);
  }
  EXPECT_EQ(store.use(nonce_of(kMost), 5000, 999), NonceStore::Answer::kFull);
  EXPECT_EQ(store.use(nonce_of(kMost), 5000, 1000), NonceStore::Answer::kFull);
  EXPECT_EQ(store.size(), kMost);
  for (std::uint64_t i = 0; i < kMost; ++i)
    EXPECT_EQ(store.check(nonce_of(i), static_cast<std::int64_t>(1000 + i), 999),
              NonceStore::Answer::kUsed);
  EXPECT_EQ(store.use(nonce_of(kMost), 5000, 1001), NonceStore::Answer::kFresh);
  EXPECT_EQ(store.size(), kMost);
}

TEST(NonceStore, WhatWasForgottenStaysUsedWhenTheClockIsSetBack) {
  NonceStore store(1);
  ASSERT_EQ(store.use(nonce_of(1), 100, 0), NonceStore::Answer::kFresh);
  ASSERT_EQ(store.use(nonce_of(2), 90000, 86400), NonceStore::Answer::kFresh);
  EXPECT_EQ(store.use(nonce_of(1), 100, 0), NonceStore::Answer::kUsed);
}

TEST(NonceStore, WhatIsGivenBackIsFreshOnce) {
  NonceStore store(1);
  store.give_back(nonce_of(1));
  ASSERT_EQ(store.use(nonce_of(1), 100, 0), NonceStore::Answer::kFresh);
  store.give_back(nonce_of(2));
  EXPECT_EQ(store.use(nonce_of(1), 100, 0), NonceStore::Answer::kUsed);
  store.give_back(nonce_of(1));
  EXPECT_EQ(store.size(), 0u);
  EXPECT_EQ(store.use(nonce_of(2), 200, 0), NonceStore::Answer::kFresh) << "there is room again";
  EXPECT_EQ(store.use(nonce_of(1), 100, 201), NonceStore::Answer::kFresh);
}

}  // namespace
}  // namespace cycloid::server
