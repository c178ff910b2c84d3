#include "cli/sim/pipe.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace cycloid::sim {
namespace {

protocol::Bytes counting(std::size_t bytes) {
  protocol::Bytes counted(bytes);
  for (std::size_t i = 0; i < bytes; ++i) counted[i] = static_cast<std::byte>(i * 7);
  return counted;
}

class SimPipe : public testing::Test {
 protected:
  Pipe pipe(const PipeFaults& faults) { return {faults, Random(1), chronicle_}; }

  /// Reads as time goes by, for a second.
  std::vector<protocol::Bytes> reads(Pipe& from) {
    std::vector<protocol::Bytes> all;
    for (int i = 0; i < 1000; ++i) {
      chronicle_.now_ns += kMillisecond;
      for (auto bytes = from.read(65536); !bytes.empty(); bytes = from.read(65536)) {
        all.emplace_back(bytes.begin(), bytes.end());
      }
    }
    return all;
  }

  static protocol::Bytes joined(const std::vector<protocol::Bytes>& parts) {
    protocol::Bytes whole;
    for (const protocol::Bytes& part : parts) whole.insert(whole.end(), part.begin(), part.end());
    return whole;
  }

  Chronicle chronicle_;
};

TEST_F(SimPipe, DeliversInOrderHoweverItCuts) {
  for (const std::uint32_t segment : {1u, 7u, 1460u}) {
    PipeFaults faults;
    faults.segment_bytes_max = segment;
    faults.whole_segments = false;
    faults.jitter_ns = 50 * kMillisecond;
    Pipe one = pipe(faults);
    const protocol::Bytes said = counting(3000);
    EXPECT_EQ(one.write(said), said.size());
    const auto heard = reads(one);
    EXPECT_EQ(joined(heard), said);
    for (const protocol::Bytes& part : heard) EXPECT_LE(part.size(), segment);
    EXPECT_EQ(one.held_bytes(), 0u);
  }
}

TEST_F(SimPipe, CoalescesWhereItIsTold) {
  PipeFaults faults;
  faults.segment_bytes_max = 1;
  faults.coalesces = true;
  Pipe one = pipe(faults);
  (void)one.write(counting(100));
  EXPECT_EQ(reads(one).size(), 1u);
}

TEST_F(SimPipe, TakesNoMoreThanItHolds) {
  PipeFaults faults;
  faults.capacity_bytes = 100;
  Pipe one = pipe(faults);
  EXPECT_EQ(one.write(counting(250)), 100u);
  EXPECT_EQ(one.write(counting(10)), 0u);
  EXPECT_EQ(joined(reads(one)), counting(100));
  EXPECT_EQ(one.write(counting(10)), 10u);
}

TEST_F(SimPipe, IsAsSlowAsItsBandwidthAndLatency) {
  PipeFaults faults;
  faults.bytes_per_s = 10'000;
  faults.latency_ns = 20 * kMillisecond;
  Pipe one = pipe(faults);
  (void)one.write(counting(1000));
  chronicle_.now_ns = 119 * kMillisecond;
  EXPECT_TRUE(one.read(65536).empty());
  chronicle_.now_ns = 120 * kMillisecond;
  EXPECT_EQ(one.read(65536).size(), 1000u);
}

TEST_F(SimPipe, StallsAllThatComesBehind) {
  PipeFaults faults;
  faults.stall_per_million = kMillion;
  faults.stall_ns = 300 * kMillisecond;
  Pipe one = pipe(faults);
  (void)one.write(counting(10));
  chronicle_.now_ns = 299 * kMillisecond;
  EXPECT_TRUE(one.read(65536).empty());
  chronicle_.now_ns = 301 * kMillisecond;
  EXPECT_EQ(one.read(65536).size(), 10u);
  EXPECT_EQ(chronicle_.counted(Event::kStall), 1u);
}

TEST_F(SimPipe, EndsBehindWhatWasSaid) {
  Pipe one = pipe({});
  (void)one.write(counting(10));
  one.finish();
  EXPECT_FALSE(one.at_end());
  EXPECT_EQ(joined(reads(one)), counting(10));
  EXPECT_TRUE(one.at_end());
  EXPECT_FALSE(one.is_reset());
}

TEST_F(SimPipe, LosesWhatIsOnTheWayAtAReset) {
  Pipe one = pipe({});
  (void)one.write(counting(10));
  one.reset();
  EXPECT_TRUE(reads(one).empty());
  EXPECT_TRUE(one.is_reset());
  EXPECT_EQ(one.write(counting(5)), 5u);
  EXPECT_TRUE(reads(one).empty());
}

TEST_F(SimPipe, SwallowsForEverOrForAWhile) {
  PipeFaults faults;
  faults.blackhole_from_ns = 0;
  Pipe lost = pipe(faults);
  faults.blackhole_until_ns = 500 * kMillisecond;
  Pipe late = pipe(faults);
  (void)lost.write(counting(10));
  (void)late.write(counting(10));
  EXPECT_TRUE(lost.is_lost());
  lost.calm();
  EXPECT_TRUE(lost.is_lost());
  EXPECT_TRUE(reads(lost).empty());
  EXPECT_EQ(joined(reads(late)), counting(10));
}

TEST_F(SimPipe, FlipsBitsAndCountsThem) {
  PipeFaults faults;
  faults.flip_per_million = kMillion;
  Pipe one = pipe(faults);
  (void)one.write(counting(10));
  EXPECT_NE(joined(reads(one)), counting(10));
  EXPECT_EQ(one.flips(), 1u);
}

TEST_F(SimPipe, IsQuickOnceCalm) {
  PipeFaults faults;
  faults.bytes_per_s = 1;
  Pipe one = pipe(faults);
  (void)one.write(counting(1000));
  one.calm();
  EXPECT_EQ(joined(reads(one)), counting(1000));
}

TEST(SimRandom, IsTheSameOnEveryPlatform) {
  Random random(1);
  EXPECT_EQ(random.next(), 0xc5883e370b0926c3);
  EXPECT_EQ(Random(1).fork(2).next(), 0xb32b16aebf7d4215);
}

TEST(SimRandom, ForksDependOnNameAndSeedAlone) {
  Random drawn(7);
  (void)drawn.next();
  EXPECT_EQ(drawn.fork(3).next(), Random(7).fork(3).next());
  EXPECT_NE(Random(7).fork(3).next(), Random(7).fork(4).next());
  EXPECT_NE(Random(7).fork(3).next(), Random(8).fork(3).next());
}

TEST(SimRandom, StaysWithinItsBounds) {
  Random random(5);
  std::vector<int> seen(7);
  for (int i = 0; i < 7000; ++i) ++seen[static_cast<std::size_t>(random.between(-3, 3) + 3)];
  for (const int count : seen) EXPECT_NEAR(count, 1000, 200);
  EXPECT_FALSE(random.chance(0));
  EXPECT_TRUE(random.chance(kMillion));
}

}  // namespace
}  // namespace cycloid::sim
