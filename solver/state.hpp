#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "solver/definitions.hpp"
#include "solver/moved_array.hpp"
#include "solver/particles/particle.hpp"
#include "solver/shared_array.hpp"
#include "solver/solids/polyhedron.hpp"

namespace cycloid::solver {

/// Ends a linked list of shapes and marks an absent index.
inline constexpr std::uint32_t kNone = 0xffffffffu;

/// Why a world no longer steps. The same on every machine.
struct Fault {
  std::uint64_t tick = 0;   ///< The tick that could not be made.
  BodyId body;              ///< index kNone where the fault is not of a body.
  std::uint64_t field = 0;  ///< A FaultField.
};

const char* fault_field_name(std::uint64_t field);

enum FaultField : std::uint64_t {
  kFaultNone,
  kFaultPosition,
  kFaultRotation,
  kFaultVelocity,
  kFaultSpin,
  kFaultContacts,  ///< More contacts than `limits.contacts`, or far more pairs.
  kFaultParticle,  ///< A particle would leave the finite, bounded range.
};

/// The records below are the state: flat, trivially copyable, without padding. Each lists its
/// fields once, in `visit`, which encoding, decoding, digest and comparison all walk; a
/// static_assert in visit.hpp fails when a field is left out.

/// What no tick changes of a body.
template <int D>
struct BodyProperties {
  std::uint32_t generation = 0;
  BodyKind kind = BodyKind::kFree;
  std::uint32_t fixed_rotation = 0;
  std::uint32_t first_shape = kNone;
  std::array<std::uint32_t, 2> tag{};
  float mass;  ///< kg; 0 for static and kinematic bodies.
  float inverse_mass;
  Inertia<D> inertia;          ///< Body frame.
  Inertia<D> inverse_inertia;  ///< Body frame; 0 where rotation is fixed.
  Vec<D> local_center;         ///< Centre of mass in the user's body frame, m.
  float linear_damping;
  float angular_damping;
  float gravity_scale;
  float extent;     ///< Of the farthest point from the centre of mass, m.
  float thickness;  ///< Radius of the largest ball in its thinnest shape, m.
};

/// What ticks move of a body.
template <int D>
struct BodyMotion {
  Vec<D> position;  ///< Centre of mass, world, m.
  Rotation<D> rotation;
  Vec<D> velocity;           ///< m/s.
  Spin<D> spin;              ///< rad/s.
  Vec<D> force;              ///< N, for the coming tick.
  Spin<D> torque;            ///< N m.
  std::uint32_t rest_ticks;  ///< Ticks below tuning.sleep_speed.
  std::uint32_t asleep;      ///< 1: left alone until something wakes its island.
};

template <int D>
struct Body : BodyProperties<D>, BodyMotion<D> {
  using Kept = BodyProperties<D>;
  using Moved = BodyMotion<D>;
};

/// Where a body's motion begins in its record, in bytes: right behind its properties, which
/// record_bytes.hpp asserts.
template <int D>
inline constexpr std::size_t kMotionAt = sizeof(BodyProperties<D>);

/// Whether a body takes part in a tick by itself: it moves, and does not sleep. What moves a
/// sleeping body (a force, a velocity) wakes it.
template <int D>
bool is_active(const Body<D>& body) {
  const bool responds = body.kind == BodyKind::kDynamic || body.kind == BodyKind::kParticle;
  if (!responds && body.kind != BodyKind::kKinematic) return false;
  if (responds && body.asleep == 0) return true;
  if (dot(body.velocity, body.velocity) > 0.0f || dot(body.spin, body.spin) > 0.0f) return true;
  return responds && (dot(body.force, body.force) > 0.0f || dot(body.torque, body.torque) > 0.0f);
}

/// What a shape looks like, in the frame of the centre of mass.
template <int D>
struct Geometry;
template <>
struct Geometry<2> {
  std::array<Vec<2>, 8> vertices;  ///< Counter-clockwise.
  std::array<Vec<2>, 8> normals;   ///< Of the edge from vertex i to i + 1.
};
template <>
struct Geometry<3> {
  /// Ball: centre. Capsule: ends. Triangle: corners, then the far corner of the neighbour across
  /// the edge from corner i to i + 1. Box and hull: the middle of the bounding box.
  std::array<Vec<3>, 6> vertices;
  Vec<3> half;                       ///< Box and hull: half extents of the bounding box; else 0.
  Rotation<3> rotation;              ///< Box and hull: of the bounding box's axes.
  std::uint32_t polyhedron = kNone;  ///< Hull: slot in WorldState::polyhedra.
};

template <int D>
struct Shape : Geometry<D> {
  ShapeKind kind = ShapeKind::kFree;
  std::uint32_t body = kNone;
  std::uint32_t next = kNone;  ///< Next shape of the same body.
  std::uint32_t ordinal = 0;   ///< Index within the body.
  std::uint32_t material = 0;
  Filter filter;
  std::uint32_t vertex_count = 0;  ///< Of `vertices`, without ghosts.
  /// Segment: bit 0: vertices[2] precedes vertex 0, bit 1: [3] follows. Triangle: bit i: edge i has
  /// a neighbour, vertices[3 + i].
  std::uint32_t ghosts = 0;
  float radius = 0.0f;
  float offset = 0.0f;
  Vec<D> normal;  ///< Half-space; triangle: of its free side.
};

template <int D>
struct ContactPoint {
  std::uint32_t feature = 0;    ///< Persists while the same features of the two shapes touch.
  float normal_impulse = 0.0f;  ///< Accumulated over the last substep, N s.
  Vec<Dim<D>::kTangents> tangent_impulse;
};

/// A pair of shapes with at least one contact point; shape_a < shape_b.
template <int D>
struct Contact {
  std::uint32_t shape_a = kNone;
  std::uint32_t shape_b = kNone;
  std::uint32_t touching = 0;  ///< 1 where they touched in the last tick (ContactEvent).
  std::uint32_t point_count = 0;
  std::array<ContactPoint<D>, Dim<D>::kManifoldPoints> points;
  Spin<D> rolling_impulse;  ///< N m s.
};

/// What no tick changes of a joint.
template <int D>
struct JointProperties {
  std::uint32_t generation = 0;
  JointKind kind = JointKind::kFree;
  std::uint32_t body_a = kNone;
  std::uint32_t body_b = kNone;
  Vec<D> anchor_a;  ///< From the centre of mass, body frame, m.
  Vec<D> anchor_b;
  Vec<D> axis;
  Vec<D> axle;
  float steering;
  float cone;
  float length;
  float ratio;
  float hertz;
  float damping_ratio;
  float angular_hertz;
  float angular_damping_ratio;
  Rotation<D> reference;  ///< Rotation of b relative to a at creation.
  std::uint32_t limit_enabled;
  float lower;
  float upper;
  MotorKind motor;
  float motor_speed;
  float motor_max;
  float target;
  float drive_amplitude;
  float drive_hertz;
  float force_max;
  float torque_max;
  Vec<D> ground_a;
  Vec<D> ground_b;
  CurveKind curve;
  std::array<float, 2> size;
  std::uint32_t user_kind;
  std::array<float, 4> parameters;
  std::uint32_t collide_connected;
};

/// What ticks change of a joint.
template <int D>
struct JointImpulses {
  std::array<float, 2> unwrapped;  ///< Gear: angles of a and b, whole turns counted, rad.
  std::array<float, Dim<D>::kFreedoms> impulse;  ///< Accumulated, of the equality rows, N s, N m s.
  float spring_impulse;
  float motor_impulse;
  float lower_impulse;
  float upper_impulse;
  float cone_impulse;
};

template <int D>
struct Joint : JointProperties<D>, JointImpulses<D> {
  using Kept = JointProperties<D>;
  using Moved = JointImpulses<D>;
};

template <int D>
struct WorldHeader {
  std::uint64_t tick = 0;
  Fault fault;
  Vec<D> gravity = Vec<D>::zero();
  float tick_s = 0.0f;
  Tuning tuning;
  Limits limits;
};

/// All that the next step depends on. Slots that are free keep only their generation; the free
/// lists are stacks, so the next id given out is part of the state too. What no tick changes is
/// shared with the copies of a state, so that a save copies what moves.
template <int D>
struct WorldState {
  WorldHeader<D> header;
  std::vector<Material> materials;
  MovedArray<Body<D>> bodies;
  std::vector<std::uint32_t> free_bodies;
  SharedArray<Shape<D>> shapes;
  std::vector<std::uint32_t> free_shapes;
  Polyhedra polyhedra;
  MovedArray<Joint<D>> joints;
  std::vector<std::uint32_t> free_joints;
  std::vector<Contact<D>> contacts;  ///< Sorted by (shape_a, shape_b).
  std::vector<std::uint32_t> registers;
  std::vector<Particle<D>> particles;
  std::vector<std::uint32_t> free_particles;
  SharedArray<Link> links;
  std::vector<std::uint32_t> free_links;
  std::vector<Pin<D>> pins;
  std::vector<std::uint32_t> free_pins;
};

static_assert(std::is_trivially_copyable_v<Body<2>> && std::is_trivially_copyable_v<Body<3>>);
static_assert(std::is_trivially_copyable_v<Contact<2>> && std::is_trivially_copyable_v<Contact<3>>);
static_assert(std::is_trivially_copyable_v<Joint<2>> && std::is_trivially_copyable_v<Shape<2>>);

}  // namespace cycloid::solver
