#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/hostile/snapshot_checks.hpp"
#include "tests/hostile/worlds.hpp"

namespace cycloid::hostile {

template <class Dimension>
struct HostileSnapshot : testing::Test {
  static constexpr int kDimension = Dimension::value;

  solver::World<kDimension> original = small_sample<kDimension>();
  Encoded bytes = encoded(original);
  std::uint64_t digest = original.digest();
  solver::World<kDimension> world = checked(solver::World<kDimension>::create({}));
  int refused = 0;
  int taken = 0;

  Verdict judge(std::span<const std::byte> damaged, int ticks = 10) {
    const Verdict verdict = try_snapshot(damaged, ticks, world);
    ++(verdict.accepted ? taken : refused);
    if (verdict.accepted) world = checked(solver::World<kDimension>::create({}));
    return verdict;
  }
};

using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(HostileSnapshot, Dimensions);

TYPED_TEST(HostileSnapshot, TheOriginalIsTaken) {
  const Verdict verdict = this->judge(this->bytes);
  EXPECT_TRUE(verdict.accepted);
  EXPECT_EQ(verdict.complaint, "");
  EXPECT_EQ(verdict.digest, this->digest);
}

TYPED_TEST(HostileSnapshot, EveryBitFlipIsRefusedOrIsAnotherStateThatSteps) {
  Encoded& good = this->bytes;
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    const auto mask = static_cast<std::byte>(1u << (bit % 8));
    good[bit / 8] ^= mask;
    const Verdict verdict = this->judge(good);
    EXPECT_EQ(verdict.complaint, "") << "bit " << bit;
    // The sign of a zero is all that the digest leaves out.
    const bool same = verdict.accepted && verdict.digest == this->digest;
    ASSERT_TRUE(!same || bit % 32 == 31) << "bit " << bit;
    good[bit / 8] ^= mask;
  }
  EXPECT_GT(this->refused, 1000);
  EXPECT_GT(this->taken, 1000);
  std::printf("%d flips refused, %d taken\n", this->refused, this->taken);
}

TYPED_TEST(HostileSnapshot, CutAnywhereOrLengthenedItIsRefused) {
  Encoded& good = this->bytes;
  for (std::size_t size = 0; size < good.size(); ++size) {
    const Verdict verdict = this->judge(std::span(good).first(size));
    ASSERT_FALSE(verdict.accepted) << size;
    EXPECT_EQ(verdict.complaint, "") << size;
  }
  for (const std::size_t more : {1u, 3u, 4u, 4096u}) {
    Encoded longer = good;
    longer.resize(good.size() + more);
    ASSERT_FALSE(this->judge(longer).accepted) << more;
  }
}

TYPED_TEST(HostileSnapshot, EveryCountMadeHugeIsRefused) {
  Encoded& good = this->bytes;
  for (const std::size_t place : count_places(this->original.state()))
    for (const std::uint32_t count : {0xffffffffu, 0x7fffffffu, 0x10000000u, 65537u}) {
      Encoded damaged = good;
      solver::store_little(count, damaged.data() + place);
      const Verdict verdict = this->judge(damaged);
      ASSERT_FALSE(verdict.accepted) << place;
      EXPECT_EQ(verdict.complaint, "");
    }
}

TYPED_TEST(HostileSnapshot, EveryNumberMadeExtremeIsRefusedOrSteps) {
  constexpr int D = TestFixture::kDimension;
  solver::WorldState<D> state = this->original.state();
  std::vector<std::string> names;
  for_each_number(state, [&](const char* name, auto&) { names.emplace_back(name); });
  std::map<std::string, std::pair<int, int>> counts;
  for (std::size_t number = 0; number < names.size(); ++number)
    for (const std::uint32_t extreme : extremes()) {
      state = this->original.state();
      std::size_t at = 0;
      for_each_number(state, [&](const char*, auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        using U = decltype(solver::bits_of(value));
        if (at++ != number) return;
        U bits = extreme;
        if (sizeof(U) == 8 && extreme == 0xffffffffu) bits = ~U{0};
        value = std::bit_cast<T>(bits);
      });
      solver::World<D> made = checked(solver::World<D>::create({}));
      made.restore(state);
      const Verdict verdict = this->judge(encoded(made));
      ++(verdict.accepted ? counts[names[number]].second : counts[names[number]].first);
      EXPECT_EQ(verdict.complaint, "")
          << names[number] << ", number " << number << ", bits " << std::hex << extreme;
    }
  for (const auto& [name, count] : counts)
    std::printf("%-18s %6d refused %6d taken\n", name.c_str(), count.first, count.second);
}

/// Arrays of one good state among those of another: every index may now lead elsewhere.
TYPED_TEST(HostileSnapshot, ArraysOfAnotherStateAreRefusedOrStep) {
  constexpr int D = TestFixture::kDimension;
  solver::World<D> other = small_sample<D>();
  put(other, 5.0f, 3.0f, sample_capsule<D>());
  for (int tick = 0; tick < 30; ++tick) checked(other.step());
  for (std::size_t from = 0; from < 19; ++from)
    for (std::size_t until = from + 1; until <= 19; ++until) {
      solver::WorldState<D> state = this->original.state();
      solver::WorldState<D> donor = other.state();
      std::vector<void*> donated;
      solver::visit_arrays(donor, [&](const char*, auto& array) { donated.push_back(&array); });
      std::size_t at = 0;
      solver::visit_arrays(state, [&](const char*, auto& array) {
        using Array = std::remove_cvref_t<decltype(array)>;
        if (at >= from && at < until) array = *static_cast<Array*>(donated[at]);
        ++at;
      });
      solver::World<D> made = checked(solver::World<D>::create({}));
      made.restore(state);
      EXPECT_EQ(this->judge(encoded(made)).complaint, "") << from << " to " << until;
    }
}

TYPED_TEST(HostileSnapshot, RandomSplicesAreRefusedOrStep) {
  constexpr int D = TestFixture::kDimension;
  solver::World<D> later = small_sample<D>();
  for (int tick = 0; tick < 7; ++tick) checked(later.step());
  const Encoded other = encoded(later);
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    Encoded spliced = this->bytes;
    const std::size_t words = std::min(spliced.size(), other.size()) / 4;
    const std::size_t from = random() % words;
    const std::size_t count = random() % (words - from) + 1;
    std::copy_n(other.begin() + static_cast<std::ptrdiff_t>(4 * from), 4 * count,
                spliced.begin() + static_cast<std::ptrdiff_t>(4 * from));
    EXPECT_EQ(this->judge(spliced).complaint, "") << from << " " << count;
    const Encoded tail(other.begin() + static_cast<std::ptrdiff_t>(4 * from), other.end());
    spliced.resize(4 * from);
    spliced.insert(spliced.end(), tail.begin(), tail.end());
    EXPECT_EQ(this->judge(spliced).complaint, "") << from;
  }
}

}  // namespace cycloid::hostile
