#include "solver/record_bytes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "solver/tracing/digest_writer.hpp"

namespace cycloid::solver {

/// Any bits, but mostly those that are special: zeros of both signs, NaN of both signs and of
/// several kinds, infinities, subnormals.
class AnyNumbers {
 public:
  template <class T>
  void operator()(T& value) {
    static constexpr std::uint32_t kSpecial[] = {0u,          0x80000000u, 0x7fc00000u, 0xffc00000u,
                                                 0x7f800001u, 0xffffffffu, 0x7f800000u, 0xff800000u,
                                                 1u,          0x80000001u, 0x3f800000u};
    const std::uint32_t pick = draw() % 16;
    const std::uint32_t bits = pick < std::size(kSpecial) ? kSpecial[pick] : draw();
    value = std::bit_cast<T>(bits);
  }

 private:
  std::uint32_t draw() { return static_cast<std::uint32_t>(random_()); }

  std::mt19937 random_{7};
};

template <class R>
std::vector<R> any_records(std::size_t count) {
  std::vector<R> records(count);
  AnyNumbers any;
  for (R& record : records) visit_words(record, any);
  return records;
}

/// The same, of which most are canonical: one number of so many records is one that is not.
template <class R>
std::vector<R> mostly_canonical_records(std::size_t count, std::size_t records_apart) {
  std::mt19937 random(11);
  std::vector<R> records(count);
  std::size_t at = 0;
  for (R& record : records) {
    const bool spoilt = at++ % records_apart == records_apart / 2;
    std::size_t left = spoilt ? random() % kRecordWords<R> : visited_bytes<R>();
    visit_words(record, [&](auto& value) {
      using T = std::remove_reference_t<decltype(value)>;
      const auto drawn = static_cast<std::uint32_t>(random());
      const std::uint32_t spoiling = drawn % 2 != 0 ? 0x80000000u : 0xffc00001u;
      const std::uint32_t bits = left-- == 0 ? spoiling : 0x3f800000u + drawn % 1000;
      value = std::bit_cast<T>(static_cast<decltype(bits_of(value))>(bits));
    });
  }
  return records;
}

template <class R>
class Records : public testing::Test {};
using EveryRecord =
    testing::Types<Material, Body<2>, Body<3>, Shape<2>, Shape<3>, Contact<2>, Contact<3>, Joint<2>,
                   Joint<3>, Particle<2>, Particle<3>, Link, Pin<2>, Pin<3>, Polyhedron,
                   PolyhedronVertex, PolyhedronFace, PolyhedronEdge, std::uint32_t>;
TYPED_TEST_SUITE(Records, EveryRecord);

TYPED_TEST(Records, AreTheSameBytesByCopyAndByNumber) {
  for (std::size_t count : {0u, 1u, 3u, 4u, 5u, 33u}) {
    const std::vector<TypeParam> records = any_records<TypeParam>(count);
    const std::size_t size = count * visited_bytes<TypeParam>();
    // One byte more, which nobody may write.
    std::vector<std::byte> by_number(size + 1, std::byte{0x5a});
    std::vector<std::byte> written(size + 1, std::byte{0x5a});
    EXPECT_EQ(write_by_number(std::span(records), by_number.data()), by_number.data() + size);
    EXPECT_EQ(write_records(std::span(records), written.data()), written.data() + size);
    EXPECT_EQ(written, by_number);

    std::vector<TypeParam> read(count);
    ByteReader reader{std::span(written).first(size)};
    read_records(reader, std::span(read));
    EXPECT_FALSE(reader.failed);
    EXPECT_TRUE(reader.bytes.empty());
    std::vector<std::byte> again(size + 1, std::byte{0x5a});
    write_by_number(std::span<const TypeParam>(read), again.data());
    EXPECT_EQ(again, by_number);
  }
}

/// Records enter a digest as their numbers, or as the digest of these where they are many; parts
/// always as their numbers.
template <class R>
void expect_digested_as_numbers(const std::vector<R>& records) {
  // Begun with some numbers, so that records start at every place of the buffer.
  for (std::uint32_t before : {0u, 1u, 5u, 1021u}) {
    DigestWriter by_number;
    DigestWriter by_record;
    DigestWriter all_numbers;
    DigestWriter by_part;
    const auto in_all = [&](std::uint32_t number) {
      for (DigestWriter* writer : {&by_number, &by_record, &all_numbers, &by_part})
        (*writer)(number);
    };
    for (std::uint32_t i = 0; i < before; ++i) in_all(i);
    DigestWriter numbers;
    for (const R& record : records) visit_words(record, numbers);
    if (records.size() * visited_bytes<R>() > DigestWriter::kFewBytes)
      by_number(numbers.digest());
    else
      for (const R& record : records) visit_words(record, by_number);
    for (const R& record : records) visit_words(record, all_numbers);
    by_record.records(std::span(records));
    by_part.template parts<R>(std::span(records));
    in_all(7u);
    EXPECT_EQ(by_record.digest(), by_number.digest()) << records.size() << " after " << before;
    EXPECT_EQ(by_part.digest(), all_numbers.digest()) << records.size() << " after " << before;
  }
}

TYPED_TEST(Records, AreDigestedAsTheirNumbers) {
  for (std::size_t count : {0u, 1u, 3u, 4u, 5u, 33u, 400u}) {
    expect_digested_as_numbers(any_records<TypeParam>(count));
    for (std::size_t apart : {2u, 7u, 40u, 1000u})
      expect_digested_as_numbers(mostly_canonical_records<TypeParam>(count, apart));
  }
}

constexpr std::size_t kPeriod = 16;

/// What `canonical_bytes` says, by the definition: periods that making them canonical leaves alone.
std::size_t canonical_numbers(const std::vector<std::uint32_t>& numbers,
                              const std::array<std::uint32_t, kPeriod>& floats) {
  for (std::size_t at = 0; at < numbers.size(); at += kPeriod) {
    const std::size_t count = std::min(kPeriod, numbers.size() - at);
    const std::vector<std::uint32_t> before(
        numbers.begin() + static_cast<std::ptrdiff_t>(at),
        numbers.begin() + static_cast<std::ptrdiff_t>(at + count));
    std::vector<std::uint32_t> made = before;
    make_canonical(std::as_writable_bytes(std::span(made)).data(), count, floats.data());
    if (made != before) return at;
  }
  return numbers.size();
}

// No state holds the one NaN that is canonical, so to take it for another costs nothing.
TEST(CanonicalNumbers, AreThoseThatMakingThemSoLeavesAsTheyAre) {
  AnyNumbers any;
  std::array<std::size_t, 3> periods{};
  for (std::uint32_t round = 0; round < 20000; ++round) {
    std::vector<std::uint32_t> words(round % 20);
    for (std::uint32_t& word : words) {
      any(word);
      if (word == 0x7fc00000u) word = 1u;
    }
    if (round % 3 == 0) {  // Many that are canonical, and at most one that is not.
      words.assign(round % 400, 0x3f800000u);
      if (round % 2 == 0 && !words.empty()) words[round * 7919u % words.size()] = 0x80000000u;
    }
    std::array<std::uint32_t, kPeriod> floats;
    for (std::size_t i = 0; i < kPeriod; ++i) floats[i] = (round >> i % 4 & 1) != 0 ? ~0u : 0u;
    const std::size_t expected = sizeof(std::uint32_t) * canonical_numbers(words, floats);
    const auto* bytes = std::as_bytes(std::span(words)).data();
    const std::size_t size = sizeof(std::uint32_t) * words.size();
    for (const auto canonical_bytes :
         {&DigestKernels<4>::canonical_bytes, digest_functions().canonical_bytes})
      EXPECT_EQ(canonical_bytes(bytes, size, floats.data(), sizeof floats), expected);
    ++periods[expected == size ? 2 : expected == 0 ? 0 : 1];
  }
  for (const std::size_t count : periods) EXPECT_GT(count, 100u);
}

}  // namespace cycloid::solver
