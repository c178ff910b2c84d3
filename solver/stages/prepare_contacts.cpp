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

/// What gravity and forces do to a body without contacts, m/s^2.
template <int D>
static Vec<D> free_acceleration(const StepContext<D>& context, const Body<D>& body) {
  if (body.inverse_mass == 0.0f) return Vec<D>::zero();
  return body.gravity_scale * context.gravity + body.inverse_mass * body.force;
}

/// What balls about their centres of mass ask for.
template <int D, int W>
static void set_balls(const WorldState<D>& state, const Contact<D>& contact,
                      const LiveContact<D>& live, int lane, ContactExtra<D, W>& extra,
                      ContactBlock<D, W>& block) {
  block.has_ball = true;
  set_lane(extra.turns_a, lane, live.a_is_ball ? 0.0f : 1.0f);
  set_lane(extra.turns_b, lane, live.b_is_ball ? 0.0f : 1.0f);
  if (!live.a_is_ball || !live.b_is_ball) return;
  set_lane(extra.is_round, lane, 1.0f);
  set_lane(extra.radius_a, lane, state.shapes[contact.shape_a].radius);
  set_lane(extra.radius_b, lane, state.shapes[contact.shape_b].radius);
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
  const float radius = max(rolling_radius(state.shapes[contact.shape_a]),
                           rolling_radius(state.shapes[contact.shape_b]));
  if (radius == 0.0f) return;
  set_lane(extra.rolling, lane, materials.rolling_resistance * radius);
  set_lane(extra.twist, lane, materials.twist_resistance * radius);
  set_lane(extra.rolling_impulse, lane, context.tuning.warm_starting * contact.rolling_impulse);
  block.rolls = true;
}

/// What balls and materials ask for of the contact in one lane.
template <int D, int W>
static void set_extra(const StepContext<D>& context, const WorldState<D>& state,
                      const StepScratch<D>& scratch, const LiveContact<D>& live, int lane,
                      std::size_t place, ContactBlocks<D, W>& contacts) {
  ContactBlock<D, W>& block = contacts.blocks[place];
  const Contact<D>& contact = scratch.contacts[live.contact];
  if (live.a_is_ball || live.b_is_ball)
    set_balls(state, contact, live, lane, contacts.extra_of(place), block);
  const ContactMaterials materials =
      materials_of<D>(state.materials[live.material_a], state.materials[live.material_b]);
  if (materials.restitution > 0.0f || materials.rolling_resistance > 0.0f ||
      materials.twist_resistance > 0.0f)
    set_materials(context, state, contact, live, materials, lane, contacts.extra_of(place), block);
}

/// Shares the contacts of each colour out to blocks of W; the overflow gets one contact per block.
template <int D, int W>
static void lay_out(const Coloring& coloring, ContactBlocks<D, W>& out) {
  out.members.clear();
  const auto add = [&](const Range& color, int width) {
    const auto first = static_cast<int>(out.members.size());
    for (int begin = color.begin; begin < color.end; begin += width)
      out.members.push_back({begin, begin + width < color.end ? begin + width : color.end});
    return Range{first, static_cast<int>(out.members.size())};
  };
  out.colors.clear();
  for (const Range& color : coloring.colors) out.colors.push_back(add(color, kLaneCount<W>));
  out.overflow = add(coloring.overflow, 1);
  out.blocks.resize(out.members.size());
  out.extras.resize(out.members.size());
}

/// Fills blocks of W contacts, colour by colour.
///
/// Reads live contacts, their impulses, materials, masses, bodies and colouring; writes the blocks
/// of width W, each from its own contacts, so any split into ranges gives the same bits.
template <int D, int W>
void prepare_contacts(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch) {
  auto& out = std::get<ContactBlocks<D, W>>(scratch.contact_blocks);
  const Coloring& coloring = scratch.contact_coloring;
  const ContactInputs<D> inputs{scratch.live.data(), scratch.contacts.data(), scratch.masses.data(),
                                static_cast<std::uint32_t>(state.bodies.size()),
                                context.tuning.warm_starting};
  lay_out(coloring, out);
  const bool always_extra = context.tuning.stabilisation == Stabilisation::kXpbd ||
                            context.tuning.stabilisation == Stabilisation::kSplitImpulse;
  const auto fill = [&](std::size_t place) {
    const Range members = out.members[place];
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
  workers.parallel_for(static_cast<int>(out.blocks.size()), kBlockGrain, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i) fill(static_cast<std::size_t>(i));
    ContactKernels<D, W>::complete(bounds, block_range<D, W>({}, scratch, range));
  });
  out.follows = false;
  out.bounces = false;
  for (const ContactBlock<D, W>& block : out.blocks) {
    out.follows = out.follows || block.follows;
    out.bounces = out.bounces || block.bounces;
  }
}

template <int D, int W>
struct InstantiatePrepare {
  static constexpr auto kPrepare = &prepare_contacts<D, W>;
};
template struct InstantiatePrepare<2, 1>;
template struct InstantiatePrepare<2, 4>;
template struct InstantiatePrepare<2, 8>;
template struct InstantiatePrepare<2, 16>;
template struct InstantiatePrepare<2, kAvx2Lanes>;
template struct InstantiatePrepare<2, kAvx512Lanes>;
template struct InstantiatePrepare<3, 1>;
template struct InstantiatePrepare<3, 4>;
template struct InstantiatePrepare<3, 8>;
template struct InstantiatePrepare<3, 16>;
template struct InstantiatePrepare<3, kAvx2Lanes>;
template struct InstantiatePrepare<3, kAvx512Lanes>;

}  // namespace cycloid::solver
