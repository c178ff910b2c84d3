#include <cstring>
#include <type_traits>

#include "solver/constraints/contact_lanes.hpp"
#include "solver/constraints/contact_rolling.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// The numbers of one contact, before they take their lane. Dimension in, floats out.
template <int D>
struct ContactNumbers {
  std::uint32_t body_a;
  std::uint32_t body_b;
  float square_friction;  ///< Of the pair's coefficient.
  float restitution;
  float rolling;  ///< m
  float twist;    ///< m
};

/// What a shape rolls on; 0 for what has corners.
template <int D>
static float rolling_radius(const Shape<D>& shape) {
  const bool round = shape.kind == ShapeKind::kBall || shape.kind == ShapeKind::kCapsule;
  return round ? shape.radius : 0.0f;
}

template <int D>
static ContactNumbers<D> numbers_of(const WorldState<D>& state, const Contact<D>& contact) {
  const Shape<D>& a = state.shapes[contact.shape_a];
  const Shape<D>& b = state.shapes[contact.shape_b];
  const Material& material_a = state.materials[a.material];
  const Material& material_b = state.materials[b.material];
  const float radius = max(rolling_radius(a), rolling_radius(b));
  return {a.body,
          b.body,
          material_a.friction * material_b.friction,
          max(material_a.restitution, material_b.restitution),
          max(material_a.rolling_resistance, material_b.rolling_resistance) * radius,
          twist_resistance<D>(material_a, material_b) * radius};
}

template <int D>
struct PointInput {
  const ManifoldPoint<D>& geometry;
  const ContactPoint<D>& impulses;
  float warm_starting;
};

template <int D, int W>
static void set_point(typename ContactBlock<D, W>::Point& point, int lane,
                      const PointInput<D>& in) {
  set_lane(point.r_a, lane, in.geometry.anchor_a);
  set_lane(point.r_b, lane, in.geometry.anchor_b);
  set_lane(point.separation, lane, in.geometry.separation);
  set_lane(point.normal_mass, lane, 1.0f);
  set_lane(point.normal_impulse, lane, in.warm_starting * in.impulses.normal_impulse);
  for (int t = 0; t < Dim<D>::kTangents; ++t) {
    set_lane(point.tangent_impulse[t], lane, in.warm_starting * in.impulses.tangent_impulse[t]);
  }
}

/// What gravity and forces do to a body without contacts, m/s^2.
template <int D>
static Vec<D> free_acceleration(const StepContext<D>& context, const Body<D>& body) {
  if (body.inverse_mass == 0.0f) return Vec<D>::zero();
  return body.gravity_scale * context.gravity + body.inverse_mass * body.force;
}

template <int D>
static bool is_centred_ball(const Shape<D>& shape) {
  return shape.kind == ShapeKind::kBall && length(shape.vertices[0]) <= 1.0e-6f * shape.radius;
}

template <int D, int W>
static void set_round(const WorldState<D>& state, const Contact<D>& contact, int lane,
                      ContactBlock<D, W>& block) {
  const Shape<D>& a = state.shapes[contact.shape_a];
  const Shape<D>& b = state.shapes[contact.shape_b];
  const bool round = is_centred_ball(a) && is_centred_ball(b);
  set_lane(block.turns_a, lane, is_centred_ball(a) ? 0.0f : 1.0f);
  set_lane(block.turns_b, lane, is_centred_ball(b) ? 0.0f : 1.0f);
  if (!round) return;
  set_lane(block.is_round, lane, 1.0f);
  set_lane(block.radius_a, lane, a.radius);
  set_lane(block.radius_b, lane, b.radius);
  set_lane(block.centre_offset, lane,
           state.bodies[b.body].position - state.bodies[a.body].position);
  block.follows = true;
}

template <int D, int W>
static void set_contact(const StepContext<D>& context, const WorldState<D>& state,
                        const StepScratch<D>& scratch, int index, int lane,
                        ContactBlock<D, W>& block) {
  const auto i = static_cast<std::size_t>(index);
  const Contact<D>& contact = scratch.contacts[i];
  const Manifold<D>& manifold = scratch.manifolds[i];
  const ContactNumbers<D> numbers = numbers_of(state, contact);
  block.body_a[lane] = numbers.body_a;
  block.body_b[lane] = numbers.body_b;
  block.contact[lane] = static_cast<std::uint32_t>(index);
  const BodyMass<D>& mass_a = scratch.masses[numbers.body_a];
  const BodyMass<D>& mass_b = scratch.masses[numbers.body_b];
  if (mass_a.inverse_mass != 0.0f) block.moves_a |= LaneBits{1} << lane;
  if (mass_b.inverse_mass != 0.0f) block.moves_b |= LaneBits{1} << lane;
  set_mass(block.mass_a, lane, mass_a);
  set_mass(block.mass_b, lane, mass_b);
  set_lane(block.normal, lane, manifold.normal);
  set_lane(block.friction, lane,
           numbers.square_friction);  // ContactKernels::complete takes the root.
  set_lane(block.restitution, lane, numbers.restitution);
  set_lane(block.rolling, lane, numbers.rolling);
  set_lane(block.twist, lane, numbers.twist);
  set_lane(block.rolling_impulse, lane, context.tuning.warm_starting * contact.rolling_impulse);
  if (numbers.restitution > 0.0f) {  // Only bounces ask for it.
    const Vec<D> pulls = free_acceleration(context, state.bodies[numbers.body_a]) -
                         free_acceleration(context, state.bodies[numbers.body_b]);
    set_lane(block.pull, lane, max(dot(manifold.normal, pulls), 0.0f));
  }
  set_round(state, contact, lane, block);
  block.turns = block.turns || can_turn(mass_a) || can_turn(mass_b);
  block.rubs = block.rubs || numbers.square_friction > 0.0f;
  block.rolls = block.rolls || numbers.rolling > 0.0f || numbers.twist > 0.0f;
  block.bounces = block.bounces || numbers.restitution > 0.0f;
  if (contact.point_count > block.point_count) block.point_count = contact.point_count;
  for (std::uint32_t p = 0; p < contact.point_count; ++p) {
    const PointInput<D> in{manifold.points[p], contact.points[p], context.tuning.warm_starting};
    set_point<D, W>(block.points[p], lane, in);
    block.has_point[p] |= LaneBits{1} << lane;
  }
}

template <int D, int W>
static void clear(std::uint32_t resting_body, ContactBlock<D, W>& block) {
  static_assert(std::is_trivially_copyable_v<ContactBlock<D, W>>);
  std::memset(&block, 0,
              sizeof block);  // Assigned, a zero block would first be made and then copied.
  for (std::uint32_t& body : block.body_a) body = resting_body;
  for (std::uint32_t& body : block.body_b) body = resting_body;
  for (std::uint32_t& contact : block.contact) contact = kNone;
}

/// Which contacts of the colouring's order a block holds.
static Range contacts_of_block(const Range& color, int block, int width) {
  const int begin = color.begin + block * width;
  return {begin, begin + width < color.end ? begin + width : color.end};
}

/// Fills blocks of W contacts, colour by colour; the overflow gets one contact per block.
///
/// Reads contacts, manifolds, materials, masses, bodies and colouring; writes the blocks of width
/// W, each from its own contacts, so any split into ranges gives the same bits.
template <int D, int W>
void prepare_contacts(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch) {
  auto& out = std::get<ContactBlocks<D, W>>(scratch.contact_blocks);
  const Coloring& coloring = scratch.contact_coloring;
  const auto resting = static_cast<std::uint32_t>(state.bodies.size());
  out.colors.clear();
  int blocks = 0;
  for (const Range& color : coloring.colors) {
    const int count = (color.end - color.begin + kLaneCount<W> - 1) / kLaneCount<W>;
    out.colors.push_back({blocks, blocks + count});
    blocks += count;
  }
  out.overflow = {blocks, blocks + coloring.overflow.end - coloring.overflow.begin};
  out.blocks.resize(static_cast<std::size_t>(out.overflow.end));
  const auto fill = [&](int block, Range members) {
    auto& into = out.blocks[static_cast<std::size_t>(block)];
    clear(resting, into);
    for (int i = members.begin; i < members.end; ++i)
      set_contact(context, state, scratch, coloring.order[static_cast<std::size_t>(i)],
                  i - members.begin, into);
  };
  for (std::size_t c = 0; c < out.colors.size(); ++c) {
    const Range color = out.colors[c];
    workers.parallel_for(color.end - color.begin, kBlockGrain, [&](Range range) {
      for (int i = range.begin; i < range.end; ++i)
        fill(color.begin + i, contacts_of_block(coloring.colors[c], i, kLaneCount<W>));
    });
  }
  for (int i = out.overflow.begin; i < out.overflow.end; ++i)
    fill(i, contacts_of_block(coloring.overflow, i - out.overflow.begin, 1));
  workers.parallel_for(out.overflow.end, kBlockGrain, [&](Range range) {
    ContactKernels<D, W>::complete(context, block_range<D, W>(scratch, range));
  });
  out.follows = false;
  out.bounces = false;
  for (const ContactBlock<D, W>& block : out.blocks) {
    out.follows = out.follows || block.follows;
    out.bounces = out.bounces || block.bounces;
  }
  scratch.poses = 0;
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
template struct InstantiatePrepare<3, 1>;
template struct InstantiatePrepare<3, 4>;
template struct InstantiatePrepare<3, 8>;
template struct InstantiatePrepare<3, 16>;
template struct InstantiatePrepare<3, kAvx2Lanes>;

}  // namespace cycloid::solver
