#include <algorithm>

#include "solver/stages/counting_sort.hpp"
#include "solver/stages/stages.hpp"
#include "solver/union_find.hpp"

namespace cycloid::solver {

/// Contacts of a lot, where nothing else is asked for: what sweeps read of them, a quarter of a
/// megabyte, stays in the cache of a core. A fourth and twice as many are as good.
static constexpr std::uint32_t kLotContacts = 2048;

/// To look for lots where all is one heap costs time for nothing: so the more contacts there are,
/// the rarer it is done.
static constexpr std::uint64_t kContactsPerTick = 128;

/// Lots are solved apart by sweeps of contacts alone. What moves without mass would have to be in
/// several at once.
template <int D>
static bool may_divide(const Tuning& tuning, const StepScratch<D>& scratch) {
  if (tuning.stabilisation != Stabilisation::kSoft) return false;
  if (tuning.joint_solver == JointSolver::kDirect || !scratch.live_joints.empty()) return false;
  if (tuning.contact_block == ContactBlockRows::kIsland) return false;
  const std::vector<std::uint8_t>& has_mass = scratch.kept->active_bodies.has_mass;
  return std::all_of(scratch.awake_bodies.begin(), scratch.awake_bodies.end(),
                     [&](std::uint32_t slot) { return has_mass[slot] != 0; });
}

static bool joins(const MovingPair& pair) {
  return pair.a != kNone && pair.b != kNone;
}

/// A body of the pair that moves. @pre one does.
static std::uint32_t one_of(const MovingPair& pair) {
  return pair.a != kNone ? pair.a : pair.b;
}

/// Puts each pair into a lot of those that were found, in whatever tick and of whatever world.
/// @returns whether that can be done: no pair is of two.
static bool share_out(const std::vector<MovingPair>& pairs, std::size_t bodies, Lots& lots) {
  if (lots.of_body.size() != bodies) return false;
  lots.of_contact.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::uint32_t lot = lots.of_body[one_of(pairs[i])];
    if (joins(pairs[i]) && lots.of_body[pairs[i].b] != lot) return false;
    lots.of_contact[i] = lot;
  }
  return true;
}

/// Names each body's island by its lowest slot, and counts the contacts of each.
static void find_islands(const std::vector<MovingPair>& pairs, std::size_t bodies, Lots& lots) {
  lots.parent.resize(bodies);
  for (std::uint32_t slot = 0; slot < bodies; ++slot) lots.parent[slot] = slot;
  for (const MovingPair& pair : pairs)
    if (joins(pair)) unite(lots.parent, pair.a, pair.b);
  lots.contacts.assign(bodies, 0);
  for (const MovingPair& pair : pairs) ++lots.contacts[root_of(lots.parent, one_of(pair))];
}

/// Islands in the order of their lowest slots, as many to a lot as have `wanted` contacts. @returns
/// whether that is worth it: no lot has more than half of all.
static bool find_lots(const std::vector<MovingPair>& pairs, std::uint32_t wanted,
                      std::size_t bodies, Lots& lots) {
  find_islands(pairs, bodies, lots);
  lots.of_body.resize(bodies);
  std::uint32_t lot = 0;
  std::uint32_t in_lot = 0;
  std::uint32_t most = 0;
  for (std::uint32_t slot = 0; slot < bodies; ++slot) {
    const std::uint32_t root = root_of(lots.parent, slot);
    if (root != slot) {
      lots.of_body[slot] = lots.of_body[root];
      continue;
    }
    if (in_lot >= wanted) {
      ++lot;
      in_lot = 0;
    }
    in_lot += lots.contacts[slot];
    most = std::max(most, in_lot);
    lots.of_body[slot] = lot;
  }
  lots.count = lot + 1;
  return 2 * std::size_t{most} <= pairs.size();
}

/// Lists the contacts by colour. Where it was done last by the same colours, of whatever world,
/// that list stands.
template <int D>
static void sort_undivided(StepScratch<D>& scratch) {
  const ContactColors& colors = scratch.kept->contact_colors;
  if (!colors.of.empty() && scratch.sorted_by == colors.of) return;
  sort_by_color(colors, scratch.contact_coloring);
  scratch.sorted_by.assign(colors.of.begin(), colors.of.end());
}

/// Lists the contacts lot by lot, those of each colour after colour.
template <int D>
static void sort_contacts(StepScratch<D>& scratch) {
  Coloring& coloring = scratch.contact_coloring;
  Lots& lots = scratch.lots;
  scratch.sorted_by.clear();
  coloring.order.resize(scratch.kept->contact_colors.pairs.size());
  counting_sort(
      scratch.kept->contact_colors.pairs.size(), lots.all.size() * kColorsMax,
      [&](std::size_t i) {
        return lots.of_contact[i] * std::size_t{kColorsMax} +
               std::size_t{scratch.kept->contact_colors.of[i]};
      },
      lots.ends, [&](std::size_t i, std::size_t to) { coloring.order[to] = static_cast<int>(i); });
  coloring.colors.clear();
  coloring.overflow = {};
  for (std::size_t lot = 0; lot < lots.all.size(); ++lot) {
    lots.all[lot].colors.begin = static_cast<int>(coloring.colors.size());
    for (std::size_t color = 0; color < kColorsMax; ++color) {
      const Range range = range_of_key(lots.ends, lot * kColorsMax + color);
      if (range.begin != range.end) coloring.colors.push_back(range);
    }
    lots.all[lot].colors.end = static_cast<int>(coloring.colors.size());
  }
}

/// Lists who moves lot by lot.
template <int D>
static void sort_bodies(StepScratch<D>& scratch) {
  Lots& lots = scratch.lots;
  counting_sort(
      scratch.awake_bodies.size(), lots.all.size(),
      [&](std::size_t i) { return std::size_t{lots.of_body[scratch.awake_bodies[i]]}; }, lots.ends,
      [&](std::size_t i, std::size_t to) { scratch.moving_bodies[to] = scratch.awake_bodies[i]; });
  for (std::size_t lot = 0; lot < lots.all.size(); ++lot)
    lots.all[lot].bodies = range_of_key(lots.ends, lot);
}

/// Islands that touch no other, in lots which are solved one after the other, each from the first
/// substep to the last: the numbers of a large world would pass through all caches in every sweep.
/// Each thread takes lots of its own, and waits for no other between colours.
///
/// Reads live contacts and their colours, who is awake and who has mass; writes the lots, the order
/// of the contacts, and who moves in the order of the lots. The contacts of an island keep their
/// order whatever the lots are, so these change no bit. Serial.
template <int D>
void divide_into_lots(const StepContext<D>& context, const WorldState<D>& state,
                      StepScratch<D>& scratch) {
  Lots& lots = scratch.lots;
  const std::vector<MovingPair>& pairs = scratch.kept->contact_colors.pairs;
  lots.all.clear();
  scratch.moving_bodies.assign(scratch.awake_bodies.begin(), scratch.awake_bodies.end());
  if (context.tuning.order != Order::kColor) return;
  const auto find = [&] {
    const std::uint32_t wanted = context.lot_contacts > 0 ? context.lot_contacts : kLotContacts;
    if (pairs.size() < 2 * std::size_t{wanted} || !may_divide(context.tuning, scratch))
      return false;
    if (scratch.kept->contact_colors.sizes[kColorsMax] > 0) return false;
    if (share_out(pairs, state.bodies.size(), lots)) return true;
    const bool tries = state.header.tick % (1 + pairs.size() / kContactsPerTick) == 0;
    if (tries && find_lots(pairs, wanted, state.bodies.size(), lots))
      return share_out(pairs, state.bodies.size(), lots);
    lots.of_body.clear();
    return false;
  };
  if (!find()) return sort_undivided(scratch);
  lots.all.assign(lots.count, {});
  sort_contacts(scratch);
  sort_bodies(scratch);
}

template void divide_into_lots(const StepContext<2>&, const WorldState<2>&, StepScratch<2>&);
template void divide_into_lots(const StepContext<3>&, const WorldState<3>&, StepScratch<3>&);

}  // namespace cycloid::solver
