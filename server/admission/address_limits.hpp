#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "server/admission/peer_address.hpp"
#include "server/admission/refill_bucket.hpp"

namespace cycloid::server {

/// A host is an IPv4 /32 or an IPv6 /64, a network an IPv4 /24 or an IPv6 /48.
struct AddressLimitOptions {
  std::uint32_t host_connections_max = 64;
  std::uint32_t network_connections_max = 512;
  std::uint32_t host_pending_max = 16;  ///< Of those, before their hello was accepted.
  Rate host_connects{10, 64};
  Rate network_connects{100, 512};
  Rate all_connects{1000, 4000};
  /// Hosts and networks that are remembered. One without connections whose rate has recovered is
  /// forgotten when another needs the place.
  std::size_t entries_max = 32768;
  /// From this machine come proxies, monitors and tests: all from one address, none from afar.
  bool exempts_loopback = true;
};

/// How many connections come from where.
class AddressLimits {
 public:
  explicit AddressLimits(const AddressLimitOptions& options, std::int64_t now_ns = 0);

  /// Takes the bounds of connections; rates stay, and so does who is in.
  void set_limits(const AddressLimitOptions& limits);
  /// A connection was accepted. "" and it is counted as open and pending, or the reason of a
  /// kRateLimited refusal and nothing is counted.
  std::string open(const PeerAddress& address, std::int64_t now_ns);
  /// An open one is no longer pending.
  void settle(const PeerAddress& address);
  /// An open one has closed; `pending` where it was never settled.
  void close(const PeerAddress& address, bool pending);
  std::size_t entries() const { return hosts_.size() + networks_.size(); }

 private:
  struct Entry {
    RefillBucket connects;
    std::uint32_t open = 0;
    std::uint32_t pending = 0;
  };
  using Entries = std::map<PeerAddress, Entry>;

  bool make_room(std::int64_t now_ns);
  Entry& entry_of(Entries& entries, const PeerAddress& key, Rate rate, std::int64_t now_ns);

  AddressLimitOptions options_;
  RefillBucket all_connects_;
  Entries hosts_;
  Entries networks_;
  std::int64_t next_sweep_ns_ = 0;
};

}  // namespace cycloid::server
