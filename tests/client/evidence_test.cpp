#include "client/replica/evidence.hpp"

#include <gtest/gtest.h>

#include "tests/client/authority.hpp"

namespace cycloid::client {
namespace {

template <class Message>
std::vector<Message> those_of(const Outbox& outbox) {
  std::vector<Message> found;
  for (const protocol::ClientMessage& message : outbox)
    if (const auto* wanted = std::get_if<Message>(&message)) found.push_back(*wanted);
  return found;
}

class EvidenceTest : public testing::Test {
 protected:
  /// Steps so many ticks, each seen as a replica shows it.
  void run(Evidence& evidence, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      evidence.leaving(authority_.simulation(), out_);
      authority_.frame();
    }
    evidence.leaving(authority_.simulation(), out_);
  }

  scenes::Scene scene_ = Authority::scene();
  Authority authority_{scene_};
  Outbox out_;
};

TEST_F(EvidenceTest, TellsTheDigestsSinceTheLastEqualOne) {
  Evidence evidence;
  run(evidence, 10);
  evidence.agreed(10);
  std::vector<std::uint64_t> right = {authority_.simulation().digest()};
  for (int i = 0; i < 20; ++i) {
    run(evidence, 1);
    right.push_back(authority_.simulation().digest());
  }
  evidence.diverged(30, out_);
  const auto digests = those_of<protocol::TickDigests>(out_);
  ASSERT_EQ(digests.size(), 1u);
  EXPECT_EQ(digests[0].first_tick, 10u);
  EXPECT_EQ(digests[0].digests, right);
}

TEST_F(EvidenceTest, TellsMoreThanOneMessageHolds) {
  Evidence evidence;
  run(evidence, 250);
  evidence.diverged(250, out_);
  const auto digests = those_of<protocol::TickDigests>(out_);
  ASSERT_EQ(digests.size(), 2u);
  EXPECT_EQ(digests[0].first_tick, 1u);
  EXPECT_EQ(digests[0].digests.size(), protocol::kTickDigestsMax);
  EXPECT_EQ(digests[1].first_tick, 1 + protocol::kTickDigestsMax);
  EXPECT_EQ(digests[1].digests.size(), 250 - protocol::kTickDigestsMax);
}

TEST_F(EvidenceTest, ShowsWhatWasInMemoryAFewPartsATick) {
  Evidence evidence;
  run(evidence, 5);
  disturb(authority_.simulation());
  evidence.leaving(authority_.simulation(), out_);
  std::vector<std::byte> right;
  authority_.simulation().encode(right);
  run(evidence, 5);
  evidence.diverged(10, out_);
  evidence.wanted({5}, out_);
  out_.clear();
  std::vector<std::byte> shown;
  std::size_t calls = 0;
  while (shown.size() < right.size() && calls < 100) {
    evidence.leaving(authority_.simulation(), out_);
    ++calls;
    const auto parts = those_of<protocol::StatePart>(out_);
    EXPECT_LE(parts.size(), EvidenceOptions{}.parts_per_tick);
    for (const protocol::StatePart& part : parts) {
      EXPECT_EQ(part.tick, 5u);
      EXPECT_EQ(part.total_bytes, right.size());
      EXPECT_EQ(part.offset, shown.size());
      EXPECT_LE(part.bytes.size(), protocol::kStatePartBytesMax);
      shown.insert(shown.end(), part.bytes.begin(), part.bytes.end());
    }
    out_.clear();
  }
  EXPECT_EQ(shown, right);
  evidence.leaving(authority_.simulation(), out_);
  EXPECT_TRUE(out_.empty());
}

TEST_F(EvidenceTest, SaysNothingOfWhatItDoesNotKeepOrWasNotInDoubt) {
  Evidence evidence;
  run(evidence, 10);
  evidence.wanted({5}, out_);  // No mismatch is open.
  evidence.leaving(authority_.simulation(), out_);
  EXPECT_TRUE(out_.empty());
  evidence.diverged(10, out_);
  out_.clear();
  evidence.wanted({500}, out_);
  evidence.wanted({5}, out_);  // The one answer was given: none.
  evidence.leaving(authority_.simulation(), out_);
  EXPECT_TRUE(out_.empty());
}

TEST_F(EvidenceTest, KeepsToItsBudgetOfBytesAndTicks) {
  const std::size_t size = authority_.simulation().encoded_bytes();
  Evidence few(EvidenceOptions{5 * size + size / 2, 256, 4});
  run(few, 50);
  EXPECT_EQ(few.ticks(), 5u);
  EXPECT_LE(few.bytes(), 5 * size + size / 2);
  Evidence none(EvidenceOptions{size / 2, 256, 4});
  run(none, 5);
  EXPECT_EQ(none.ticks(), 0u);
  none.diverged(authority_.simulation().tick(), out_);
  EXPECT_TRUE(out_.empty());
  Evidence short_lived(EvidenceOptions{std::size_t{1} << 30, 7, 4});
  run(short_lived, 50);
  EXPECT_EQ(short_lived.ticks(), 7u);
}

TEST_F(EvidenceTest, ADefaultHoldsTwoIntervalsAndASecondOf50Kilobytes) {
  EXPECT_GE(EvidenceOptions{}.bytes_max, std::size_t{180} * 50'000);
  EXPECT_GE(EvidenceOptions{}.ticks_max, 180u);
}

TEST_F(EvidenceTest, AfterTheServersStateNoOlderTickIsInDoubt) {
  Evidence evidence;
  run(evidence, 30);
  evidence.replaced(authority_.simulation());
  run(evidence, 10);
  evidence.diverged(40, out_);
  const auto digests = those_of<protocol::TickDigests>(out_);
  ASSERT_EQ(digests.size(), 1u);
  EXPECT_EQ(digests[0].first_tick, 30u);
  EXPECT_EQ(digests[0].digests.size(), 11u);
}

}  // namespace
}  // namespace cycloid::client
