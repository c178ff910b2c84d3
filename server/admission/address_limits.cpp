#include "server/admission/address_limits.hpp"

#include <algorithm>

namespace cycloid::server {
namespace {

/// Looking through all entries takes a millisecond or two; an attacker may not ask for it at will.
constexpr std::int64_t kSweepInterval_ns = 1'000'000'000;

std::string too_many(std::uint32_t most, const std::string& what, const PeerAddress& from) {
  return std::to_string(most) + " connections " + what + " from " + from.text() + " at a time";
}

std::string too_fast(const Rate& rate, const std::string& from) {
  return "more than " + std::to_string(rate.per_s) + " connections per second from " + from;
}

}  // namespace

AddressLimits::AddressLimits(const AddressLimitOptions& options, std::int64_t now_ns)
    : options_(options), all_connects_(options.all_connects, now_ns) {}

void AddressLimits::set_limits(const AddressLimitOptions& limits) {
  options_.host_connections_max = limits.host_connections_max;
  options_.network_connections_max = limits.network_connections_max;
  options_.host_pending_max = limits.host_pending_max;
}

bool AddressLimits::make_room(std::int64_t now_ns) {
  if (entries() + 2 <= options_.entries_max) return true;
  if (now_ns < next_sweep_ns_) return false;
  next_sweep_ns_ = now_ns + kSweepInterval_ns;
  const auto says_nothing = [now_ns](const auto& each) {
    return each.second.open == 0 && each.second.connects.full(now_ns);
  };
  std::erase_if(hosts_, says_nothing);
  std::erase_if(networks_, says_nothing);
  return entries() + 2 <= options_.entries_max;
}

AddressLimits::Entry& AddressLimits::entry_of(Entries& entries, const PeerAddress& key, Rate rate,
                                              std::int64_t now_ns) {
  return entries.try_emplace(key, Entry{RefillBucket(rate, now_ns), 0, 0}).first->second;
}

std::string AddressLimits::open(const PeerAddress& address, std::int64_t now_ns) {
  if (options_.exempts_loopback && address.is_loopback()) return "";
  const PeerAddress host_key = address.host();
  const PeerAddress network_key = address.network();
  if (!all_connects_.has(1, now_ns)) return too_fast(options_.all_connects, "everywhere");
  if (!make_room(now_ns)) return "connections from too many addresses at a time";
  Entry& host = entry_of(hosts_, host_key, options_.host_connects, now_ns);
  Entry& network = entry_of(networks_, network_key, options_.network_connects, now_ns);
  if (host.open >= options_.host_connections_max)
    return too_many(options_.host_connections_max, "are open", host_key);
  if (host.pending >= options_.host_pending_max)
    return too_many(options_.host_pending_max, "wait for their hello", host_key);
  if (network.open >= options_.network_connections_max)
    return too_many(options_.network_connections_max, "are open", network_key);
  if (!host.connects.has(1, now_ns)) return too_fast(options_.host_connects, host_key.text());
  if (!network.connects.has(1, now_ns))
    return too_fast(options_.network_connects, network_key.text());
  (void)all_connects_.take(1, now_ns);
  (void)host.connects.take(1, now_ns);
  (void)network.connects.take(1, now_ns);
  ++host.open;
  ++host.pending;
  ++network.open;
  return "";
}

void AddressLimits::settle(const PeerAddress& address) {
  const auto host = hosts_.find(address.host());
  if (host != hosts_.end() && host->second.pending > 0) --host->second.pending;
}

void AddressLimits::close(const PeerAddress& address, bool pending) {
  if (pending) settle(address);
  const auto host = hosts_.find(address.host());
  if (host != hosts_.end() && host->second.open > 0) --host->second.open;
  const auto network = networks_.find(address.network());
  if (network != networks_.end() && network->second.open > 0) --network->second.open;
}

}  // namespace cycloid::server
