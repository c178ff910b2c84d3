#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string>

namespace cycloid::server {

/// Where a connection comes from, as 16 bytes: an IPv4 address stands behind ::ffff:0:0, so that it
/// is the same one on a socket for both.
struct PeerAddress {
  std::array<std::uint8_t, 16> bytes{};

  static PeerAddress v4(const std::array<std::uint8_t, 4>& address);
  static PeerAddress v6(const std::array<std::uint8_t, 16>& address) { return {address}; }

  bool is_v4() const;
  bool is_loopback() const;
  /// What one subscriber has: the IPv4 address itself, or the /64 of an IPv6 address.
  PeerAddress host() const;
  /// What one owner of many hosts has: the /24 of an IPv4 address, or the /48 of an IPv6 address.
  PeerAddress network() const;
  /// As RFC 5952 writes it; IPv4 with dots.
  std::string text() const;

  friend auto operator<=>(const PeerAddress&, const PeerAddress&) = default;

 private:
  PeerAddress first_bytes(std::size_t count) const;
};

}  // namespace cycloid::server
