#include "cli/sim/network.hpp"

namespace cycloid::sim {
namespace {

/// In which stretch of a connection's life its own faults begin.
constexpr std::int64_t kFateNs = 6 * kSecond;

PipeFaults draw_direction(const NetworkSettings& network, Random& random, std::int64_t now_ns) {
  PipeFaults faults;
  faults.latency_ns = random.between(0, network.latency_max_ns);
  faults.jitter_ns = random.between(0, network.jitter_max_ns);
  if (network.bytes_per_s_min != 0 && random.one_in(2)) {
    faults.bytes_per_s = network.bytes_per_s_min * static_cast<std::uint64_t>(random.between(1, 8));
  }
  faults.segment_bytes_max = network.segment_bytes_max;
  faults.whole_segments = !network.ragged;
  faults.coalesces = network.coalesces;
  faults.stall_per_million = network.stall_per_million;
  faults.stall_ns = random.between(0, network.stall_max_ns);
  faults.capacity_bytes = network.capacity_bytes;
  if (random.chance(network.blackhole_per_million)) {
    faults.blackhole_from_ns = now_ns + random.between(0, kFateNs);
    if (random.one_in(2)) {
      faults.blackhole_until_ns = faults.blackhole_from_ns + random.between(1, 4 * kSecond);
    }
  }
  return faults;
}

}  // namespace

std::shared_ptr<Wire> make_wire(const NetworkSettings& network, Random& random,
                                Chronicle& chronicle) {
  const Random own(random.next());
  if (chronicle.quiet) return std::make_shared<Wire>(PipeFaults{}, PipeFaults{}, own, chronicle);
  const std::int64_t now = chronicle.now_ns;
  PipeFaults up = draw_direction(network, random, now);
  PipeFaults down = draw_direction(network, random, now);
  if (random.chance(network.flipping_per_million)) {
    (random.one_in(2) ? up : down).flip_per_million = network.flip_per_million;
  }
  auto wire = std::make_shared<Wire>(up, down, own, chronicle);
  wire->flips_up = up.flip_per_million != 0;
  wire->flips_down = down.flip_per_million != 0;
  if (random.chance(network.reset_per_million))
    wire->reset_at_ns = now + random.between(0, kFateNs);
  return wire;
}

}  // namespace cycloid::sim
