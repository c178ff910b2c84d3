#include <gtest/gtest.h>
#include <malloc.h>

#include "tests/server/admission_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::Refusal;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// The n-th of many addresses, each in a network of its own.
PeerAddress address_of(std::uint32_t number) {
  return PeerAddress::v4({static_cast<std::uint8_t>(number >> 16),
                          static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number),
                          1});
}

/// Options in which only what a test sets is a bound.
GateOptions unbounded() {
  GateOptions options;
  options.addresses.all_connects = {};
  options.addresses.host_connects = {};
  options.addresses.network_connects = {};
  return options;
}

TEST(GateBounds, BytesDoNotMoveTheDeadline) {
  GateFixture fixture;
  const protocol::Bytes hello = bytes_of(hello_with(arena_token()));
  const GateId dripping = fixture.begin();
  const GateId silent = fixture.begin();
  EXPECT_EQ(fixture.gate.next_deadline_ns(), 5 * kSecond_ns);
  // One byte every 25 ms would take longer than the hello has.
  ASSERT_GT(hello.size() * 25, 5000u);
  for (std::size_t i = 0; i < 199; ++i) {
    fixture.now.now_ns += kSecond_ns / 40;
    const GateResult result =
        fixture.gate.feed(dripping, std::span(hello).subspan(i, 1), fixture.now);
    ASSERT_TRUE(std::holds_alternative<GateWaiting>(result)) << i;
    ASSERT_TRUE(fixture.gate.overdue(fixture.now.now_ns).empty());
  }
  EXPECT_EQ(fixture.gate.next_deadline_ns(), 5 * kSecond_ns);
  fixture.now.now_ns += kSecond_ns / 40;
  const std::vector<GateOverdue> over = fixture.gate.overdue(fixture.now.now_ns);
  ASSERT_EQ(over.size(), 2u);
  EXPECT_EQ(over[0].id, dripping);
  EXPECT_EQ(over[1].id, silent);
  EXPECT_EQ(over[0].refused.code, Refusal::kTooSlow);
  EXPECT_EQ(over[0].refused.reason, "no hello within 5000 ms");
  EXPECT_EQ(refused_of(over[0].refused.message).code, Refusal::kTooSlow);
  EXPECT_TRUE(fixture.gate.overdue(fixture.now.now_ns).empty());
  EXPECT_FALSE(fixture.gate.next_deadline_ns().has_value());
}

TEST(GateBounds, TheLastByteAtTheDeadlineIsTooLate) {
  GateFixture fixture;
  const protocol::Bytes hello = bytes_of(hello_with(arena_token()));
  const GateId id = fixture.begin();
  fixture.now.now_ns = 5 * kSecond_ns;
  expect_refused(fixture.gate.feed(id, hello, fixture.now), Refusal::kTooSlow,
                 "no hello within 5000 ms");
  const GateId next = fixture.begin();
  fixture.now.now_ns += 5 * kSecond_ns - 1;
  EXPECT_TRUE(std::holds_alternative<GateAdmitted>(fixture.gate.feed(next, hello, fixture.now)));
  EXPECT_EQ(fixture.asked, 1);
}

TEST(GateBounds, HoldsOneHelloAndNoMore) {
  GateFixture fixture;
  const GateId id = fixture.begin();
  protocol::Bytes bytes(1 << 20, std::byte{0});
  bytes[1] = std::byte{4};  // A hello of 1024 bytes that never comes whole.
  const auto fed = fixture.gate.feed(id, std::span(bytes).first(1027), fixture.now);
  EXPECT_TRUE(std::holds_alternative<GateWaiting>(fed));
  EXPECT_EQ(fixture.gate.held_bytes(), 1027u);
  const GateResult result = fixture.gate.feed(id, bytes, fixture.now);
  ASSERT_TRUE(std::holds_alternative<GateRefused>(result));
  EXPECT_EQ(std::get<GateRefused>(result).code, Refusal::kBadMessage);
  EXPECT_EQ(fixture.gate.held_bytes(), 0u);
}

TEST(GateBounds, InAllAndOpenConnectionsAreCapped) {
  GateOptions options = unbounded();
  options.pending_max = 3;
  options.connections_max = 5;
  GateFixture fixture(options);
  const protocol::Bytes hello = bytes_of(protocol::Hello{});
  const auto begin = [&](std::uint32_t number) {
    return fixture.gate.begin(address_of(number), fixture.now.now_ns);
  };
  const auto reason_of = [](const std::variant<GateId, GateRefused>& begun) {
    const auto* refused = std::get_if<GateRefused>(&begun);
    return refused == nullptr ? std::string() : refused->reason;
  };
  std::vector<GateId> ids;
  for (std::uint32_t i = 1; i <= 3; ++i) ids.push_back(std::get<GateId>(begin(i)));
  EXPECT_EQ(reason_of(begin(4)), "3 connections wait for their hello already");
  for (const GateId id : ids) (void)fixture.gate.feed(id, hello, fixture.now);
  EXPECT_EQ(fixture.gate.pending(), 0u);
  EXPECT_EQ(fixture.gate.connections(), 3u);
  ids.push_back(std::get<GateId>(begin(5)));
  ids.push_back(std::get<GateId>(begin(6)));
  EXPECT_EQ(reason_of(begin(7)), "5 connections are open, no more may be");
  // One that was refused still reads why: it counts until its socket is closed.
  fixture.now.now_ns += 10 * kSecond_ns;
  EXPECT_EQ(fixture.gate.overdue(fixture.now.now_ns).size(), 2u);
  EXPECT_EQ(fixture.gate.pending(), 2u);
  EXPECT_NE(reason_of(begin(8)), "");
  for (const GateId id : ids) fixture.gate.end(id);
  EXPECT_EQ(fixture.gate.connections(), 0u);
  EXPECT_EQ(fixture.gate.pending(), 0u);
  EXPECT_EQ(reason_of(begin(9)), "");
}

TEST(GateBounds, OneAddressLeavesRoomForTheOthers) {
  GateOptions options;
  options.addresses.host_pending_max = 4;
  options.addresses.host_connections_max = 6;
  GateFixture fixture(options);
  const PeerAddress one = PeerAddress::v4({192, 0, 2, 7});
  std::vector<GateId> ids;
  for (int i = 0; i < 4; ++i) ids.push_back(fixture.begin(one));
  expect_refused(std::get<GateRefused>(fixture.gate.begin(one, 0)), Refusal::kRateLimited,
                 "4 connections wait for their hello from 192.0.2.7 at a time");
  (void)fixture.begin(PeerAddress::v4({192, 0, 2, 8}));
  const protocol::Bytes hello = bytes_of(protocol::Hello{});
  for (const GateId id : ids) (void)fixture.gate.feed(id, hello, fixture.now);
  ids.push_back(fixture.begin(one));
  ids.push_back(fixture.begin(one));
  expect_refused(std::get<GateRefused>(fixture.gate.begin(one, 0)), Refusal::kRateLimited,
                 "6 connections are open from 192.0.2.7 at a time");
  fixture.gate.end(ids[0]);
  (void)fixture.begin(one);
}

// Who goes without a hello, and who is refused, waits for nothing once its socket is closed.
TEST(GateBounds, OneThatIsGoneLeavesItsAddressItsPlaces) {
  GateOptions options;
  options.addresses.host_pending_max = 2;
  options.addresses.host_connects = {};
  options.addresses.network_connects = {};
  GateFixture fixture(options);
  const PeerAddress one = PeerAddress::v4({192, 0, 2, 7});
  for (int i = 0; i < 5; ++i) fixture.gate.end(fixture.begin(one));
  for (int i = 0; i < 5; ++i) {
    const GateId id = fixture.begin(one);
    (void)fixture.gate.feed(id, protocol::Bytes(4), fixture.now);
    fixture.gate.end(id);
  }
}

TEST(GateBounds, ThisMachineIsNoAddress) {
  GateOptions options;
  options.addresses.host_pending_max = 1;
  options.addresses.host_connects = {1, 1};
  GateFixture fixture(options);
  for (int i = 0; i < 100; ++i) (void)fixture.begin(PeerAddress::v4({127, 0, 0, 1}));
  EXPECT_EQ(fixture.gate.pending(), 100u);
}

// Named so that the sanitizers, which allocate otherwise, leave it out.
TEST(GateAllocationBounds, FiveThousandPendingConnectionsTakeLessThanElevenMegabytes) {
  constexpr std::uint32_t kConnections = 5000;
  GateFixture fixture(unbounded());
  protocol::Bytes unfinished(1027, std::byte{0});
  unfinished[1] = std::byte{4};
  const std::size_t before_bytes = mallinfo2().uordblks;
  for (std::uint32_t i = 0; i < kConnections; ++i) {
    const GateId id = fixture.begin(address_of(i));
    // In two parts, as slow peers send: the first must not have the room of the second twice.
    (void)fixture.gate.feed(id, std::span(unfinished).first(500), fixture.now);
    (void)fixture.gate.feed(id, std::span(unfinished).subspan(500), fixture.now);
  }
  const std::size_t taken_bytes = mallinfo2().uordblks - before_bytes;
  EXPECT_EQ(fixture.gate.pending(), kConnections);
  EXPECT_EQ(fixture.gate.held_bytes(), std::size_t{kConnections} * 1027);
  EXPECT_GT(taken_bytes, fixture.gate.held_bytes());
  EXPECT_LT(taken_bytes, std::size_t{kConnections} * 2200);
  fixture.now.now_ns = 5 * kSecond_ns;
  const auto over = fixture.gate.overdue(fixture.now.now_ns);
  EXPECT_EQ(over.size(), kConnections);
  EXPECT_EQ(fixture.gate.held_bytes(), 0u);
}

TEST(AddressLimits, CountByHostAndByNetwork) {
  AddressLimitOptions options;
  options.host_connections_max = 2;
  options.network_connections_max = 3;
  AddressLimits limits(options);
  const PeerAddress a = PeerAddress::v4({10, 1, 2, 3});
  const PeerAddress b = PeerAddress::v4({10, 1, 2, 4});
  const PeerAddress other = PeerAddress::v4({10, 1, 3, 3});
  EXPECT_EQ(limits.open(a, 0), "");
  EXPECT_EQ(limits.open(a, 0), "");
  EXPECT_EQ(limits.open(a, 0), "2 connections are open from 10.1.2.3 at a time");
  EXPECT_EQ(limits.open(b, 0), "");
  EXPECT_EQ(limits.open(b, 0), "3 connections are open from 10.1.2.0 at a time");
  EXPECT_EQ(limits.open(other, 0), "");
  limits.close(a, true);
  EXPECT_EQ(limits.open(b, 0), "");
}

TEST(AddressLimits, TakeAnIpv6SubscriberForOneHost) {
  AddressLimitOptions options;
  options.host_connections_max = 1;
  options.network_connections_max = 2;
  AddressLimits limits(options);
  std::array<std::uint8_t, 16> bytes = {0x20, 0x01, 0x0d, 0xb8, 0, 1, 0, 2};
  EXPECT_EQ(limits.open(PeerAddress::v6(bytes), 0), "");
  bytes[15] = 9;
  EXPECT_EQ(limits.open(PeerAddress::v6(bytes), 0),
            "1 connections are open from 2001:db8:1:2:: at a time");
  bytes[7] = 3;
  EXPECT_EQ(limits.open(PeerAddress::v6(bytes), 0), "");
  bytes[7] = 4;
  EXPECT_EQ(limits.open(PeerAddress::v6(bytes), 0),
            "2 connections are open from 2001:db8:1:: at a time");
  bytes[5] = 2;
  EXPECT_EQ(limits.open(PeerAddress::v6(bytes), 0), "");
}

TEST(AddressLimits, LimitHowFastConnectionsCome) {
  AddressLimitOptions options;
  options.host_connects = {2, 3};
  AddressLimits limits(options);
  const PeerAddress from = PeerAddress::v4({10, 1, 2, 3});
  const auto open = [&](std::int64_t now_ns) {
    const std::string reason = limits.open(from, now_ns);
    if (reason.empty()) limits.close(from, true);
    return reason;
  };
  for (int i = 0; i < 3; ++i) EXPECT_EQ(open(0), "");
  EXPECT_EQ(open(0), "more than 2 connections per second from 10.1.2.3");
  EXPECT_NE(open(kSecond_ns / 2 - 1), "");
  EXPECT_EQ(open(kSecond_ns / 2), "");
  EXPECT_NE(open(kSecond_ns / 2), "");
}

TEST(AddressLimits, LimitHowFastConnectionsComeFromEverywhere) {
  AddressLimitOptions options;
  options.all_connects = {10, 20};
  AddressLimits limits(options);
  for (std::uint32_t i = 0; i < 20; ++i) EXPECT_EQ(limits.open(address_of(i), 0), "");
  EXPECT_EQ(limits.open(address_of(20), 0), "more than 10 connections per second from everywhere");
}

TEST(AddressLimits, RememberABoundedNumberAndForgetWhatSaysNothing) {
  AddressLimitOptions options;
  options.entries_max = 100;
  options.all_connects = {};
  options.host_connects = {1, 2};
  AddressLimits limits(options);
  for (std::uint32_t i = 0; i < 50; ++i) ASSERT_EQ(limits.open(address_of(i), 0), "");
  for (std::uint32_t i = 10; i < 50; ++i) limits.close(address_of(i), true);
  // Their rates have not recovered: forgetting them would give a new burst.
  EXPECT_EQ(limits.open(address_of(99), 1), "connections from too many addresses at a time");
  EXPECT_EQ(limits.entries(), 100u);
  // Now they have, but who is refused cannot make it look through all of them each time.
  EXPECT_NE(limits.open(address_of(99), kSecond_ns), "");
  EXPECT_EQ(limits.entries(), 100u);
  EXPECT_EQ(limits.open(address_of(99), kSecond_ns + 1), "");
  EXPECT_EQ(limits.entries(), 22u);
  for (std::uint32_t i = 100; i < 10000; ++i) (void)limits.open(address_of(i), 3 * kSecond_ns);
  EXPECT_LE(limits.entries(), 100u);
}

TEST(PeerAddresses, HaveTheirCanonicalText) {
  const auto v6 = [](std::array<std::uint8_t, 16> bytes) { return PeerAddress::v6(bytes).text(); };
  EXPECT_EQ(PeerAddress::v4({192, 0, 2, 255}).text(), "192.0.2.255");
  EXPECT_EQ(v6({}), "::");
  EXPECT_EQ(v6({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}), "::1");
  EXPECT_EQ(v6({0x20, 0x01, 0x0d, 0xb8, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2}), "2001:db8::1:0:2");
  EXPECT_EQ(v6({0xfe, 0x80, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0, 0}), "fe80:1:2:3:4:5:6:0");
  EXPECT_EQ(v6({1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}), "100::");
  EXPECT_EQ(v6({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 10, 0, 0, 1}), "10.0.0.1");
  EXPECT_TRUE(PeerAddress::v4({127, 8, 9, 1}).is_loopback());
  EXPECT_FALSE(PeerAddress::v4({128, 0, 0, 1}).is_loopback());
}

}  // namespace
}  // namespace cycloid::server
