#include <algorithm>
#include <cstring>
#include <type_traits>

#include "solver/constraints/contact_rolling.hpp"
#include "solver/constraints/single_lanes.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// What materials of a contact have to say besides friction.
struct ContactMaterials {
  float restitution;
  float rolling_resistance;
  float twist_resistance;
};

template <int D>
static ContactMaterials materials_of(const Material& a, const Material& b) {
  return {max(a.restitution, b.restitution), max(a.rolling_resistance, b.rolling_resistance),
          twist_resistance<D>(a, b)};
}

/// What a shape rolls on; 0 for what has corners.
template <int D>
static float rolling_radius(const Shape<D>& shape) {
  const bool round = shape.kind == ShapeKind::kBall || shape.kind == ShapeKind::kCapsule;
  return round ? shape.radius : 0.0f;
}

/// What two shapes roll by: of two round ones the smaller, as a marble on a large ball rolls as it
/// does on a plane; 0 where neither is round.
template <int D>
static float rolling_radius(const Shape<D>& a, const Shape<D>& b) {
  const float radius_a = rolling_radius(a);
  const float radius_b = rolling_radius(b);
  const bool both = radius_a > 0.0f && radius_b > 0.0f;
  return both ? min(radius_a, radius_b) : max(radius_a, radius_b);
}

/// What gravity and forces do to a body without contacts, m/s^2.
template <int D>
static Vec<D> free_acceleration(const StepContext<D>& context, const Body<D>& body) {
  if (body.inverse_mass == 0.0f) return Vec<D>::zero();
  return body.gravity_scale * context.gravity + body.inverse_mass * body.force;
}

/// What shapes with a radius ask for, balls about their centres of mass before all.
template <int D, int W>
static void set_round(const WorldState<D>& state, const Contact<D>& contact,
                      const LiveContact<D>& live, int lane, ContactExtra<D, W>& extra,
                      ContactBlock<D, W>& block) {
  block.has_round = true;
  set_lane(extra.turns_a, lane, live.a_is_ball ? 0.0f : 1.0f);
  set_lane(extra.turns_b, lane, live.b_is_ball ? 0.0f : 1.0f);
  set_lane(extra.radius_a, lane, state.shapes[contact.shape_a].radius);
  set_lane(extra.radius_b, lane, state.shapes[contact.shape_b].radius);
  if (!live.a_is_ball || !live.b_is_ball) return;
  set_lane(extra.is_round, lane, 1.0f);
  block.follows = true;
}

/// What materials that bounce or resist rolling ask for.
template <int D, int W>
static void set_materials(const StepContext<D>& context, const WorldState<D>& state,
                          const Contact<D>& contact, const LiveContact<D>& live,
                          const ContactMaterials& materials, int lane, ContactExtra<D, W>& extra,
                          ContactBlock<D, W>& block) {
  if (materials.restitution > 0.0f) {
    const Vec<D> pulls = free_acceleration(context, state.bodies[live.body_a]) -
                         free_acceleration(context, state.bodies[live.body_b]);
    set_lane(extra.restitution, lane, materials.restitution);
    set_lane(extra.pull, lane, max(dot(live.manifold.normal, pulls), 0.0f));
    block.bounces = true;
  }
  if (materials.rolling_resistance == 0.0f && materials.twist_resistance == 0.0f) return;
  const float radius = rolling_radius(state.shapes[contact.shape_a], state.shapes[contact.shape_b]);
  if (radius == 0.0f) return;
  set_lane(extra.rolling, lane, materials.rolling_resistance * radius);
  set_lane(extra.twist, lane, materials.twist_resistance * radius);
  set_lane(extra.rolling_impulse, lane, context.tuning.warm_starting * contact.rolling_impulse);
  block.rolls = true;
}

/// What round shapes and materials ask for of the contact in one lane.
template <int D, int W>
static void set_extra(const StepContext<D>& context, const WorldState<D>& state,
                      const StepScratch<D>& scratch, const LiveContact<D>& live, int lane,
                      std::size_t place, ContactBlocks<D, W>& contacts) {
  ContactBlock<D, W>& block = contacts.blocks[place];
  const Contact<D>& contact = scratch.contacts[live.contact];
  if (live.has_round) set_round(state, contact, live, lane, contacts.extra_of(place), block);
  const ContactMaterials materials =
      materials_of<D>(state.materials[live.material_a], state.materials[live.material_b]);
  if (materials.restitution > 0.0f || materials.rolling_resistance > 0.0f ||
      materials.twist_resistance > 0.0f)
    set_materials(context, state, contact, live, materials, lane, contacts.extra_of(place), block);
}

/// How many blocks there is to be memory for: of all contacts, or where the tick is divided, of one
/// lot for each thread. Those of a lot are done with when the next one begins, so they stay in the
/// cache; and no two threads write to one line.
template <int D, int W>
static std::size_t room_for(int threads, const Lots& lots, const ContactBlocks<D, W>& contacts) {
  if (lots.all.empty()) return contacts.members.size();
  int most = 0;
  for (const Lot& lot : lots.all) {
    const Range blocks = contacts.blocks_of(lot);
    most = std::max(most, blocks.end - blocks.begin);
  }
  return static_cast<std::size_t>(most) * static_cast<std::size_t>(threads);
}

/// Shares the contacts of each colour out to blocks of W; the overflow gets one contact per block.
///
/// Reads the colouring and the lots; writes which contacts each block has, and makes room for the
/// blocks. @returns the lot of all contacts. Serial.
template <int D, int W>
Lot lay_out_contacts(Workers& workers, StepScratch<D>& scratch) {
  auto& out = std::get<ContactBlocks<D, W>>(scratch.contact_blocks);
  const Coloring& coloring = scratch.contact_coloring;
  out.members.clear();
  const auto add = [&](const Range& color, int width) {
    const auto first = static_cast<int>(out.members.size());
    const Range blocks{first, first + (color.end - color.begin + width - 1) / width};
    out.members.resize(static_cast<std::size_t>(blocks.end));
    for (int i = blocks.begin, begin = color.begin; i < blocks.end; ++i, begin += width)
      out.members[static_cast<std::size_t>(i)] = {
          begin, begin + width < color.end ? begin + width : color.end};
    return blocks;
  };
  out.colors.clear();
  for (const Range& color : coloring.colors) out.colors.push_back(add(color, kLaneCount<W>));
  out.overflow = add(coloring.overflow, 1);
  const std::size_t room = room_for(workers.count(), scratch.lots, out);
  out.blocks.resize(room);
  out.extras.resize(room);
  return {in_substeps(scratch), {0, static_cast<int>(out.colors.size())}, out.overflow};
}

template <int D, int W>
void seat_lot(int seat, const Workers& workers, const StepScratch<D>& scratch, Lot& lot) {
  const auto& contacts = std::get<ContactBlocks<D, W>>(scratch.contact_blocks);
  const int room = static_cast<int>(contacts.blocks.size()) / workers.count();
  lot.blocks_before = contacts.blocks_of(lot).begin - seat * room;
}

/// Fills a lot's blocks of W contacts, colour by colour.
///
/// Reads live contacts, their impulses, materials, masses, bodies and colouring; writes the blocks
/// of width W, each from its own contacts, so any split into ranges gives the same bits.
/// @pre lay_out_contacts.
template <int D, int W>
void prepare_contacts(const StepContext<D>& context, const WorldState<D>& state, Lot& lot,
                      Workers& workers, StepScratch<D>& scratch) {
  auto& out = std::get<ContactBlocks<D, W>>(scratch.contact_blocks);
  const Coloring& coloring = scratch.contact_coloring;
  const ContactInputs<D> inputs = contact_inputs(context, state, scratch);
  const bool always_extra = context.tuning.stabilisation == Stabilisation::kXpbd ||
                            context.tuning.stabilisation == Stabilisation::kSplitImpulse;
  const auto fill = [&](int block) {
    const Range members = out.members[static_cast<std::size_t>(block)];
    const auto place = static_cast<std::size_t>(block - lot.blocks_before);
    const int* places = coloring.order.data() + members.begin;
    const int count = members.end - members.begin;
    static_assert(std::is_trivially_copyable_v<ContactBlock<D, W>>);
    std::memset(&out.blocks[place], 0, sizeof out.blocks[place]);
    ContactKernels<D, W>::fill(inputs, places, count, out.blocks[place]);
    if (always_extra) out.extra_of(place);
    for (int lane = 0; lane < count; ++lane) {
      const LiveContact<D>& live = scratch.live[static_cast<std::size_t>(places[lane])];
      if (live.has_extra) set_extra(context, state, scratch, live, lane, place, out);
    }
  };
  const LoadBounds bounds = load_bounds(context);
  Tally follow;
  Tally bounce;
  for_each_part_of_colors(colors_of(lot, out), lot.overflow, workers, [&](Range blocks) {
    for (int i = blocks.begin; i < blocks.end; ++i) fill(i);
    const BlockRange<D, W> filled = block_range<D, W>(lot, scratch, blocks);
    ContactKernels<D, W>::complete(bounds, filled);
    const auto is_among = [&](bool ContactBlock<D, W>::*flag) {
      return std::any_of(filled.begin, filled.end, [&](const auto& block) { return block.*flag; });
    };
    if (is_among(&ContactBlock<D, W>::follows)) follow.add(1);
    if (is_among(&ContactBlock<D, W>::bounces)) bounce.add(1);
  });
  lot.follows = follow.sum() > 0;
  lot.bounces = bounce.sum() > 0;
}

template <int D, int W>
struct InstantiatePrepare {
  decltype(&lay_out_contacts<D, W>) lay_out = &lay_out_contacts<D, W>;
  decltype(&seat_lot<D, W>) seat = &seat_lot<D, W>;
  decltype(&prepare_contacts<D, W>) prepare = &prepare_contacts<D, W>;
};
template struct AtEveryWidth<InstantiatePrepare>;

}  // namespace cycloid::solver
