#include "protocol/crc32c.hpp"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace cycloid::protocol {
namespace {

std::vector<std::byte> thirty_two(int first, int step) {
  std::vector<std::byte> bytes;
  for (int i = 0; i < 32; ++i) bytes.push_back(static_cast<std::byte>(first + i * step));
  return bytes;
}

/// Source: RFC 3720, B.4.
TEST(Crc32c, AgreesWithRfc3720) {
  EXPECT_EQ(crc32c(thirty_two(0, 0)), 0x8a9136aau);
  EXPECT_EQ(crc32c(thirty_two(0xff, 0)), 0x62a8ab43u);
  EXPECT_EQ(crc32c(thirty_two(0, 1)), 0x46dd794eu);
  EXPECT_EQ(crc32c(thirty_two(31, -1)), 0x113fdb5cu);
  const std::string_view digits = "123456789";
  EXPECT_EQ(crc32c(std::as_bytes(std::span(digits.data(), digits.size()))), 0xe3069283u);
}

TEST(Crc32c, PiecesGiveTheCheckOfTheWhole) {
  const auto bytes = thirty_two(3, 7);
  const std::span<const std::byte> all(bytes);
  for (std::size_t cut = 0; cut <= all.size(); ++cut) {
    EXPECT_EQ(crc32c(all.subspan(cut), crc32c(all.first(cut))), crc32c(all));
  }
  static_assert(crc32c({}) == 0);
}

}  // namespace
}  // namespace cycloid::protocol
