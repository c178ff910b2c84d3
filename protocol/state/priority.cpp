#include "protocol/state/priority.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace cycloid::protocol {

static constexpr std::uint8_t kCharacters = 0;
static constexpr std::uint8_t kBodies = 1;
static constexpr std::uint8_t kParticles = 2;

/// Appearing and vanishing: farther than any move.
static constexpr std::uint64_t kErrorOfExistence = std::uint64_t{1} << 34;

static std::uint64_t distance_between(const std::array<std::int32_t, 3>& a,
                                      const std::array<std::int32_t, 3>& b) {
  std::int64_t most = 0;
  for (std::size_t i = 0; i < 3; ++i) most = std::max(most, std::abs(std::int64_t{a[i]} - b[i]));
  return static_cast<std::uint64_t>(most);
}

/// A turn counts by its parts, which is what it moves on a body of about half a metre.
static std::uint64_t error_between(const QuantisedBody& a, const QuantisedBody& b) {
  std::uint64_t most = std::max<std::uint64_t>(1, distance_between(a.position, b.position));
  if (a.rotation.largest != b.rotation.largest) most = std::max<std::uint64_t>(most, 16);
  for (std::size_t i = 0; i < 3; ++i) {
    const int turned = std::abs(a.rotation.parts[i] - b.rotation.parts[i]);
    most = std::max(most, static_cast<std::uint64_t>(turned));
  }
  return most;
}

/// Calls found(base or null, now or null) for every index, in order.
template <class F>
static void for_pairs(const std::vector<QuantisedBody>& base, const std::vector<QuantisedBody>& now,
                      F&& found) {
  auto a = base.begin();
  auto b = now.begin();
  while (a != base.end() || b != now.end()) {
    const bool take_a = a != base.end() && (b == now.end() || a->index <= b->index);
    const bool take_b = b != now.end() && (a == base.end() || b->index <= a->index);
    found(take_a ? &*a : nullptr, take_b ? &*b : nullptr);
    if (take_a) ++a;
    if (take_b) ++b;
  }
}

static void find_changes(std::uint8_t list, const std::vector<QuantisedBody>& base,
                         const std::vector<QuantisedBody>& now,
                         std::vector<PendingChange>& changes) {
  for_pairs(base, now, [&](const QuantisedBody* a, const QuantisedBody* b) {
    if (a != nullptr && b != nullptr && *a == *b) return;
    const bool same = a != nullptr && b != nullptr && a->generation == b->generation;
    changes.push_back({{list, b != nullptr ? b->index : a->index, 0},
                       same ? error_between(*a, *b) : kErrorOfExistence});
  });
}

static bool is_before(const WaitingChange& a, const WaitingChange& b) {
  return a.list != b.list ? a.list < b.list : a.index < b.index;
}

static bool is_more_urgent(const PendingChange& a, const PendingChange& b) {
  const bool late_a = a.what.ticks >= kWaitTicksMax;
  const bool late_b = b.what.ticks >= kWaitTicksMax;
  if (late_a != late_b) return late_a;
  if (late_a && a.what.ticks != b.what.ticks) return a.what.ticks > b.what.ticks;
  const std::uint64_t seen_a = a.error * (1u + a.what.ticks);
  const std::uint64_t seen_b = b.error * (1u + b.what.ticks);
  if (seen_a != seen_b) return seen_a > seen_b;
  return is_before(a.what, b.what);
}

std::vector<PendingChange> changes_by_urgency(const HeldState& baseline,
                                              const QuantisedState& now) {
  std::vector<PendingChange> changes;
  const auto& before = baseline.state.characters;
  for (std::uint32_t i = 0; i < now.characters.size(); ++i)
    if (i >= before.size() || before[i] != now.characters[i])
      changes.push_back({{kCharacters, i, 0}, 2 * kErrorOfExistence});
  find_changes(kBodies, baseline.state.bodies, now.bodies, changes);
  find_changes(kParticles, baseline.state.particles, now.particles, changes);
  const std::uint64_t elapsed = now.tick - std::min(now.tick, baseline.state.tick);
  const auto ticks = static_cast<std::uint32_t>(std::min<std::uint64_t>(elapsed, 1u << 16));
  auto waited = baseline.waiting.begin();
  for (PendingChange& change : changes) {
    while (waited != baseline.waiting.end() && is_before(*waited, change.what)) ++waited;
    const bool known = waited != baseline.waiting.end() && !is_before(change.what, *waited);
    change.what.ticks = std::min(ticks + (known ? waited->ticks : 0u), 1u << 20);
  }
  std::sort(changes.begin(), changes.end(), is_more_urgent);
  return changes;
}

/// @param chosen  sorted indices: these are as they are now, the others as they were.
static void merge_bodies(const std::vector<QuantisedBody>& base,
                         const std::vector<QuantisedBody>& now,
                         const std::vector<std::uint32_t>& chosen,
                         std::vector<QuantisedBody>& into) {
  auto next = chosen.begin();
  for_pairs(base, now, [&](const QuantisedBody* a, const QuantisedBody* b) {
    const std::uint32_t index = a != nullptr ? a->index : b->index;
    const bool takes = next != chosen.end() && *next == index;
    if (takes) ++next;
    const QuantisedBody* body = takes ? b : a;
    if (body != nullptr) into.push_back(*body);
  });
}

HeldState with_changes(const HeldState& baseline, const QuantisedState& now,
                       const std::vector<PendingChange>& changes, std::size_t count) {
  HeldState held;
  if (count == changes.size()) {
    held.state = now;
    return held;
  }
  std::array<std::vector<std::uint32_t>, 3> chosen;
  for (std::size_t i = 0; i < count; ++i)
    chosen[changes[i].what.list].push_back(changes[i].what.index);
  for (auto& indices : chosen) std::sort(indices.begin(), indices.end());
  for (std::size_t i = count; i < changes.size(); ++i) held.waiting.push_back(changes[i].what);
  std::sort(held.waiting.begin(), held.waiting.end(), is_before);
  held.state.tick = now.tick;
  held.state.dimension = now.dimension;
  merge_bodies(baseline.state.bodies, now.bodies, chosen[kBodies], held.state.bodies);
  merge_bodies(baseline.state.particles, now.particles, chosen[kParticles], held.state.particles);
  held.state.characters = baseline.state.characters;
  auto& characters = held.state.characters;
  characters.resize(std::min(characters.size(), now.characters.size()));
  // Only from nothing are there fewer than in the scene; one that would leave a gap stays pending.
  for (const std::uint32_t i : chosen[kCharacters]) {
    if (i == characters.size()) characters.emplace_back();
    if (i < characters.size()) characters[i] = now.characters[i];
  }
  return held;
}

}  // namespace cycloid::protocol
