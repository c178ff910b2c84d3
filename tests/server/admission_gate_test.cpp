#include <gtest/gtest.h>

#include "tests/server/admission_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::Refusal;

const GateAdmitted* admitted_of(const GateResult& result) {
  const auto* refused = std::get_if<GateRefused>(&result);
  EXPECT_EQ(refused, nullptr) << (refused == nullptr ? "" : refused->reason);
  return std::get_if<GateAdmitted>(&result);
}

TEST(Gate, AdmitsAGoodTokenWithWhatItSays) {
  GateFixture fixture;
  AdmissionToken token = arena_token();
  token.seat = 1;
  const GateResult result = fixture.say(hello_with(token));
  const GateAdmitted* admitted = admitted_of(result);
  ASSERT_NE(admitted, nullptr);
  EXPECT_EQ(admitted->admission.hello.room, "arena");
  EXPECT_EQ(admitted->admission.hello.name, "ada");
  EXPECT_EQ(admitted->admission.identity, "ada");
  EXPECT_EQ(admitted->admission.seat, 1);
  EXPECT_EQ(admitted->admission.role, Role::kPlayer);
  EXPECT_EQ(admitted->admission.address, "192.0.2.7");
  EXPECT_EQ(fixture.asked, 1);
  EXPECT_EQ(fixture.gate.counts().admitted, 1u);
}

TEST(Gate, RefusesEachFaultWithItsOwnCodeAndAsksForNoRoom) {
  struct Case {
    protocol::Hello hello;
    Refusal code;
    const char* reason;
  };
  AdmissionToken seated = arena_token();
  seated.seat = 1;
  AdmissionToken watching = arena_token();
  watching.role = Role::kSpectator;
  AdmissionToken old = arena_token();
  old.not_before_unix_s -= 1000;
  old.expires_unix_s -= 1000;
  auto broken = sign_token(arena_token(), issuer_key());
  broken[3] ^= std::byte{16};
  std::vector<Case> cases = {
      {hello_with(arena_token()), Refusal::kProtocolVersion, "protocol version 9, here 2"},
      {hello_with(std::vector<std::byte>{}), Refusal::kTokenInvalid,
       "no token, and this server asks for one"},
      {hello_with(broken), Refusal::kTokenInvalid, "the token's signature is not of its bytes"},
      {hello_with(old), Refusal::kTokenExpired,
       "the token expired at 1799999060, the clock here says 1800000000"},
      {hello_with(arena_token()), Refusal::kTokenScope,
       "room \"lobby\" is wished, the token is for \"arena\""},
      {hello_with(seated), Refusal::kTokenScope, "seat 2 is wished, the token is for seat 1"},
      {hello_with(seated), Refusal::kTokenScope, "no seat is wished, the token is for seat 1"},
      {hello_with(watching), Refusal::kTokenScope,
       "seat 0 is wished, the token is for a spectator"},
  };
  cases[0].hello.protocol_version = 9;
  cases[4].hello.room = "lobby";
  cases[5].hello.seat_wish = 2;
  cases[6].hello.seat_wish = protocol::kSpectator;
  cases[7].hello.seat_wish = 0;
  GateFixture fixture;
  for (const Case& bad : cases) {
    SCOPED_TRACE(bad.reason);
    expect_refused(fixture.say(bad.hello), bad.code, bad.reason);
  }
  EXPECT_EQ(fixture.asked, 0);
  EXPECT_EQ(fixture.gate.counts().refused[static_cast<std::size_t>(Refusal::kTokenScope)], 4u);
  // Nothing of it was counted as used: the same nonce still lets its bearer in.
  EXPECT_NE(admitted_of(fixture.say(hello_with(arena_token()))), nullptr);
}

TEST(Gate, RefusesWhatIsNoHello) {
  GateFixture fixture;
  const auto feed = [&](const std::vector<unsigned>& values) {
    protocol::Bytes bytes;
    for (const unsigned value : values) bytes.push_back(static_cast<std::byte>(value));
    const GateId id = fixture.begin();
    GateResult result = fixture.gate.feed(id, bytes, fixture.now);
    fixture.gate.end(id);
    return result;
  };
  const GateResult garbage = feed({4, 0, 0, 0, 1, 2, 0, 0});
  ASSERT_TRUE(std::holds_alternative<GateRefused>(garbage));
  EXPECT_EQ(std::get<GateRefused>(garbage).code, Refusal::kBadMessage);
  expect_refused(feed({1, 4, 0, 0}), Refusal::kTooLarge, "a message of 1025 bytes, of 1 to 1024");
  expect_refused(feed({0, 0, 0, 0}), Refusal::kBadMessage, "a message of 0 bytes, of 1 to 1024");
  const GateId id = fixture.begin();
  const protocol::Bytes ping = protocol::encode(protocol::ClientMessage(protocol::Ping{7}));
  expect_refused(fixture.gate.feed(id, ping, fixture.now), Refusal::kBadMessage,
                 "the first message is not a hello");
  EXPECT_EQ(fixture.asked, 0);
}

TEST(Gate, TakesATokenOnce) {
  GateFixture fixture;
  EXPECT_NE(admitted_of(fixture.say(hello_with(arena_token(1)))), nullptr);
  expect_refused(fixture.say(hello_with(arena_token(1))), Refusal::kTokenUsed,
                 "the token was used before; each is good once");
  EXPECT_NE(admitted_of(fixture.say(hello_with(arena_token(2)))), nullptr);
  fixture.gate.set_keys({issuer_key().public_key()});
  expect_refused(fixture.say(hello_with(arena_token(1))), Refusal::kTokenUsed,
                 "the token was used before; each is good once");
  EXPECT_EQ(fixture.asked, 2);
}

TEST(Gate, ATokenIsStillGoodAfterTheRoomWasFull) {
  GateFixture fixture;
  fixture.verdict = {RoomFound::kFull, "8 seats taken, of 8"};
  expect_refused(fixture.say(hello_with(arena_token())), Refusal::kRoomFull, "8 seats taken, of 8");
  fixture.verdict = {};
  EXPECT_NE(admitted_of(fixture.say(hello_with(arena_token()))), nullptr);
}

TEST(Gate, AFullNonceStoreRefusesAndKeepsWhatItHas) {
  GateOptions options = GateFixture::required();
  options.nonces_max = 3;
  GateFixture fixture(options);
  for (std::uint64_t i = 1; i <= 3; ++i)
    EXPECT_NE(admitted_of(fixture.say(hello_with(arena_token(i)))), nullptr);
  expect_refused(fixture.say(hello_with(arena_token(4))), Refusal::kRateLimited,
                 "3 used tokens have not expired yet, no more can be remembered");
  expect_refused(fixture.say(hello_with(arena_token(1))), Refusal::kTokenUsed,
                 "the token was used before; each is good once");
  fixture.now.unix_s += 60 + 30 + 1;
  AdmissionToken later = arena_token(4);
  later.expires_unix_s += 60;
  EXPECT_NE(admitted_of(fixture.say(hello_with(later))), nullptr);
}

TEST(Gate, SaysWhatTheRoomSays) {
  struct Case {
    RoomVerdict verdict;
    Refusal code;
    const char* reason;
  };
  const Case cases[] = {
      {{RoomFound::kLocked, ""}, Refusal::kRoomLocked, "room \"arena\" is locked"},
      {{RoomFound::kFull, ""}, Refusal::kRoomFull, "room \"arena\" is full"},
      {{RoomFound::kDraining, ""}, Refusal::kDraining, "room \"arena\" takes nobody in any more"},
      {{RoomFound::kNoSuchRoom, ""}, Refusal::kNoSuchRoom, "there is no room \"arena\""},
      {{RoomFound::kLocked, "for the final"}, Refusal::kRoomLocked, "for the final"},
  };
  GateFixture fixture;
  for (const Case& each : cases) {
    fixture.verdict = each.verdict;
    expect_refused(fixture.say(hello_with(arena_token())), each.code, each.reason);
  }
  fixture.verdict = {RoomFound::kCreated, ""};
  EXPECT_NE(admitted_of(fixture.say(hello_with(arena_token()))), nullptr);
}

TEST(Gate, WithoutTokensAnybodyComesInAndATokenIsNotLookedAt) {
  GateFixture fixture{GateOptions{}};
  protocol::Hello hello = hello_with(std::vector<std::byte>(9));
  hello.seat_wish = protocol::kSpectator;
  const GateResult result = fixture.say(hello);
  const GateAdmitted* admitted = admitted_of(result);
  ASSERT_NE(admitted, nullptr);
  EXPECT_EQ(admitted->admission.role, Role::kSpectator);
  EXPECT_EQ(admitted->admission.identity, "");
  hello.room = "cellar";
  expect_refused(fixture.say(hello), Refusal::kNoSuchRoom, "there is no room \"cellar\"");
}

TEST(Gate, OptionalTokensMustBeGoodWhereTheyAreShown) {
  GateOptions options = GateFixture::required();
  options.tokens = TokenPolicy::kOptional;
  GateFixture fixture(options);
  EXPECT_NE(admitted_of(fixture.say(hello_with(std::vector<std::byte>{}))), nullptr);
  expect_refused(fixture.say(hello_with(std::vector<std::byte>(9))), Refusal::kTokenInvalid,
                 "a token of 9 bytes, of 113 to 512");
  EXPECT_NE(admitted_of(fixture.say(hello_with(arena_token()))), nullptr);
}

TEST(Gate, RolesComeFromTheToken) {
  struct Case {
    Role role;
    std::int32_t wish;
    Role admitted_role;
    std::int32_t seat;
  };
  const Case cases[] = {
      {Role::kPlayer, protocol::kAnySeat, Role::kPlayer, protocol::kAnySeat},
      {Role::kPlayer, 2, Role::kPlayer, protocol::kAnySeat},
      {Role::kPlayer, protocol::kSpectator, Role::kSpectator, protocol::kAnySeat},
      {Role::kSpectator, protocol::kAnySeat, Role::kSpectator, protocol::kSpectator},
      {Role::kSpectator, protocol::kSpectator, Role::kSpectator, protocol::kSpectator},
      {Role::kAdmin, protocol::kSpectator, Role::kAdmin, protocol::kAnySeat},
  };
  GateFixture fixture;
  std::uint64_t number = 1;
  for (const Case& each : cases) {
    AdmissionToken token = arena_token(number++);
    token.role = each.role;
    protocol::Hello hello = hello_with(token);
    hello.seat_wish = each.wish;
    const GateResult result = fixture.say(hello);
    const GateAdmitted* admitted = admitted_of(result);
    ASSERT_NE(admitted, nullptr);
    EXPECT_EQ(admitted->admission.role, each.admitted_role) << number;
    EXPECT_EQ(admitted->admission.seat, each.seat) << number;
  }
}

TEST(Gate, WhoResumesShowsTheRoomsSecretInsteadOfAToken) {
  GateFixture fixture;
  protocol::Hello hello = hello_with(std::vector<std::byte>{});
  hello.room = "arena";
  hello.resume.resize(protocol::kResumeBytes);
  const GateResult result = fixture.say(hello);
  const GateAdmitted* admitted = admitted_of(result);
  ASSERT_NE(admitted, nullptr);
  EXPECT_EQ(admitted->admission.hello.resume, hello.resume);
  EXPECT_EQ(admitted->admission.identity, "");
}

TEST(Gate, CutsTheHelloOffTheStreamWhereverItIsCut) {
  const protocol::Bytes hello = bytes_of(hello_with(arena_token()));
  for (std::size_t cut = 1; cut <= hello.size(); ++cut) {
    GateFixture fixture;
    const GateId id = fixture.begin();
    const auto rest = std::span(hello).subspan(cut);
    GateResult result = fixture.gate.feed(id, std::span(hello).first(cut), fixture.now);
    if (cut < hello.size()) {
      ASSERT_TRUE(std::holds_alternative<GateWaiting>(result)) << cut;
      EXPECT_EQ(fixture.gate.held_bytes(), cut);
      protocol::Bytes more(rest.begin(), rest.end());
      more.insert(more.end(), 5000, std::byte{7});
      result = fixture.gate.feed(id, more, fixture.now);
    }
    const GateAdmitted* admitted = admitted_of(result);
    ASSERT_NE(admitted, nullptr) << cut;
    EXPECT_EQ(admitted->rest.size(), cut < hello.size() ? 5000u : 0u);
  }
}

TEST(Gate, AnswersEachConnectionOnce) {
  GateFixture fixture;
  const GateId id = fixture.begin();
  const protocol::Bytes hello = bytes_of(hello_with(arena_token()));
  ASSERT_NE(admitted_of(fixture.gate.feed(id, hello, fixture.now)), nullptr);
  expect_refused(fixture.gate.feed(id, hello, fixture.now), Refusal::kBadMessage,
                 "the connection has its answer already");
  fixture.gate.end(id);
  fixture.gate.end(id);
  EXPECT_EQ(fixture.gate.connections(), 0u);
}

TEST(Gate, DrainingTakesNobodyIn) {
  GateFixture fixture;
  const GateId id = fixture.begin();
  fixture.gate.drain("the server goes away");
  expect_refused(fixture.gate.feed(id, bytes_of(hello_with(arena_token())), fixture.now),
                 Refusal::kDraining, "the server goes away");
  const auto begun = fixture.gate.begin(PeerAddress::v4({192, 0, 2, 8}), 0);
  ASSERT_TRUE(std::holds_alternative<GateRefused>(begun));
  EXPECT_EQ(std::get<GateRefused>(begun).code, Refusal::kDraining);
  EXPECT_EQ(fixture.asked, 0);
}

// Within the leeway behind its expiry a token is still taken, and so has still to be remembered.
TEST(Gate, AtTheBoundOfUsedTokensForgetsNoneThatIsStillTaken) {
  GateOptions options = GateFixture::required();
  options.nonces_max = 1;
  options.leeway_s = 30;
  GateFixture fixture(options);
  fixture.now.unix_s = arena_token().expires_unix_s + 10;
  EXPECT_TRUE(std::holds_alternative<GateAdmitted>(fixture.say(hello_with(arena_token(1)))));
  const auto code_of = [&](std::uint64_t number) {
    const GateResult result = fixture.say(hello_with(arena_token(number)));
    const auto* refused = std::get_if<GateRefused>(&result);
    return refused == nullptr ? Refusal{} : refused->code;
  };
  EXPECT_EQ(code_of(2), Refusal::kRateLimited);
  EXPECT_EQ(code_of(1), Refusal::kTokenUsed);
}

}  // namespace
}  // namespace cycloid::server
