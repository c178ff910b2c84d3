#include "server/admission/peer_address.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>

namespace cycloid::server {
namespace {

constexpr std::array<std::uint8_t, 12> kMapped = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};

/// Where the longest run of zero groups lies, of two at least.
struct ZeroRun {
  std::size_t begin = 0;
  std::size_t count = 0;
};

ZeroRun longest_zeros(const std::array<unsigned, 8>& groups) {
  ZeroRun best;
  for (std::size_t begin = 0; begin < groups.size(); ++begin) {
    std::size_t end = begin;
    while (end < groups.size() && groups[end] == 0) ++end;
    if (end - begin > best.count && end - begin >= 2) best = {begin, end - begin};
  }
  return best;
}

}  // namespace

PeerAddress PeerAddress::v4(const std::array<std::uint8_t, 4>& address) {
  PeerAddress peer;
  std::copy(kMapped.begin(), kMapped.end(), peer.bytes.begin());
  std::copy(address.begin(), address.end(), peer.bytes.begin() + kMapped.size());
  return peer;
}

bool PeerAddress::is_v4() const {
  return std::equal(kMapped.begin(), kMapped.end(), bytes.begin());
}

bool PeerAddress::is_loopback() const {
  if (is_v4()) return bytes[12] == 127;
  PeerAddress one;
  one.bytes[15] = 1;
  return *this == one;
}

PeerAddress PeerAddress::first_bytes(std::size_t count) const {
  PeerAddress cut;
  std::copy_n(bytes.begin(), count, cut.bytes.begin());
  return cut;
}

PeerAddress PeerAddress::host() const {
  return first_bytes(is_v4() ? 16 : 8);
}

PeerAddress PeerAddress::network() const {
  return first_bytes(is_v4() ? 15 : 6);
}

std::string PeerAddress::text() const {
  std::array<char, 16> part{};
  if (is_v4()) {
    (void)std::snprintf(part.data(), part.size(), "%u.%u.%u.%u", unsigned{bytes[12]},
                        unsigned{bytes[13]}, unsigned{bytes[14]}, unsigned{bytes[15]});
    return part.data();
  }
  std::array<unsigned, 8> groups{};
  for (std::size_t i = 0; i < groups.size(); ++i)
    groups[i] = unsigned{bytes[2 * i]} << 8 | unsigned{bytes[2 * i + 1]};
  const ZeroRun zeros = longest_zeros(groups);
  std::string text;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (zeros.count > 0 && i == zeros.begin) {
      text += "::";
      i += zeros.count - 1;
      continue;
    }
    if (!text.empty() && !text.ends_with(':')) text += ':';
    (void)std::snprintf(part.data(), part.size(), "%x", groups[i]);
    text += part.data();
  }
  return text;
}

}  // namespace cycloid::server
