#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solver/dim.hpp"

namespace cycloid::solver {

/// All ticks lie below. No match comes near it, ticks of a lead can be added without a thought, and
/// each is a number that a double, and so JSON, has too.
inline constexpr std::uint64_t kTickEnd = std::uint64_t{1} << 53;

/// Names one body for as long as it lives. A body created later in the same slot has another
/// generation, so a stale id is refused and never names another body.
struct BodyId {
  std::uint32_t index = 0xffffffffu;
  std::uint32_t generation = 0;
  friend bool operator==(const BodyId&, const BodyId&) = default;
};

struct JointId {
  std::uint32_t index = 0xffffffffu;
  std::uint32_t generation = 0;
  friend bool operator==(const JointId&, const JointId&) = default;
};

struct ParticleId {
  std::uint32_t index = 0xffffffffu;
  std::uint32_t generation = 0;
  friend bool operator==(const ParticleId&, const ParticleId&) = default;
};

struct LinkId {
  std::uint32_t index = 0xffffffffu;
  std::uint32_t generation = 0;
  friend bool operator==(const LinkId&, const LinkId&) = default;
};

struct PinId {
  std::uint32_t index = 0xffffffffu;
  std::uint32_t generation = 0;
  friend bool operator==(const PinId&, const PinId&) = default;
};

/// Two shapes began or ceased to touch in the last step. They touch in a step if no more than
/// Tuning::slop was between them as it began, or if they pushed each other in it: a bounce begins
/// in its own step, though they may part again before its end, and ends in the first step after it
/// in which they do not touch.
struct ContactEvent {
  BodyId body_a;
  BodyId body_b;
  std::uint32_t shape_a = 0;  ///< Index of the shape within its body.
  std::uint32_t shape_b = 0;
  bool began = false;
  friend bool operator==(const ContactEvent&, const ContactEvent&) = default;
};

enum class BodyKind : std::uint32_t {
  kFree = 0,   ///< An unused slot; never a valid definition.
  kStatic,     ///< Does not move.
  kKinematic,  ///< Moves at its velocity, whatever it hits.
  kDynamic,
  kParticle,  ///< Dynamic without rotation or inertia; needs `mass`.
};

enum class ShapeKind : std::uint32_t {
  kFree = 0,
  kBall,       ///< centre points[0], radius. Both dimensions.
  kHalfSpace,  ///< solid where dot(normal, x) <= offset. Static bodies only. Both dimensions.
  kCapsule,    ///< points[0..1], radius. Both dimensions.
  kPolygon,    ///< 3 to 8 convex points in either winding, rounded by radius >= 0. 2D.
  kSegment,    ///< One edge of a chain; made by kChain, never defined directly.
  kChain,  ///< Open or closed polyline of a static body, solid to the right of its direction. 2D.
  kBox,    ///< `half` extents, turned by `rotation`, about points[0] (none: the origin). 3D.
  kHull,   ///< The convex hull of 4 to 256 points with at most 64 corners. 3D.
  kTriangle,     ///< One face of a mesh; made by kMesh and kHeightField, never defined directly.
  kMesh,         ///< Triangles of a static body, counter-clockwise seen from their free side. 3D.
  kHeightField,  ///< A grid of heights of a static body, free above. 3D.
};

/// Which shapes meet: (a.category & b.mask) and (b.category & a.mask), unless both carry the same
/// non-zero group: then they always meet if it is positive, and never if it is negative.
struct Filter {
  std::uint32_t category = 1;
  std::uint32_t mask = 0xffffffffu;
  std::int32_t group = 0;

  friend bool filters_meet(const Filter& a, const Filter& b) {
    if (a.group != 0 && a.group == b.group) return a.group > 0;
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
  }
};

/// Friction mixes as sqrt(a b), restitution and both resistances as max(a, b).
struct Material {
  float friction = 0.6f;            ///< Coulomb coefficient, >= 0.
  float restitution = 0.0f;         ///< 0 to 1.
  float rolling_resistance = 0.0f;  ///< Moment over force and smaller radius; balls and capsules.
  float twist_resistance = 0.0f;    ///< The same about the normal, against spin; only in space.
};

template <int D>
struct ShapeDef {
  ShapeKind kind = ShapeKind::kBall;
  std::vector<Vec<D>> points;  ///< Body frame, m. Ball: its centre (none: the origin).
  float radius = 0.0f;         ///< m.
  Vec<D> normal = Vec<D>::zero();
  float offset = 0.0f;                                  ///< m along `normal`.
  bool loop = false;                                    ///< Chain: the last point joins the first.
  Vec<D> half = Vec<D>::zero();                         ///< Box: half extents, m, > 0.
  Rotation<D> rotation = identity_rotation<D>();        ///< Box: of its axes, body frame.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Mesh: indices into points.
  /// Height field: `heights`[row * columns + column] above the plane y = 0 of the body frame, the
  /// columns `cell`[0] apart along x from points[0] (none: the origin), the rows cell[1] along z.
  std::vector<float> heights;
  std::uint32_t columns = 0;
  std::array<float, 2> cell{};
  /// kg/m^D. A body that states its mass shares it out among its shapes by density times volume,
  /// by volume alone where that comes to nothing; one that is not dynamic has none.
  float density = 1.0f;
  std::uint32_t material = 0;  ///< Index of a material of the world.
  Filter filter;
};

template <int D>
struct BodyDef {
  BodyKind kind = BodyKind::kDynamic;
  Vec<D> position = Vec<D>::zero();  ///< Origin of the body frame in the world, m.
  Rotation<D> rotation = identity_rotation<D>();
  Vec<D> velocity = Vec<D>::zero();  ///< Of the centre of mass, m/s.
  Spin<D> spin = Spin<D>::zero();    ///< rad/s.
  float mass = 0.0f;                 ///< kg; 0 means from the shapes and their densities.
  float linear_damping = 0.0f;       ///< 1/s.
  float angular_damping = 0.0f;      ///< 1/s.
  float gravity_scale = 1.0f;
  bool fixed_rotation = false;
  std::uint64_t tag = 0;  ///< The user's own; part of state, snapshot and digest.
};

enum class JointKind : std::uint32_t {
  kFree = 0,
  kDistance,   ///< |anchor_b - anchor_a| = length; a spring or, with limits, a rope.
  kRevolute,   ///< anchor_a = anchor_b; in space a ball joint. Coordinate: the angle, 2D.
  kPrismatic,  ///< b slides along `axis` of a without turning. Coordinate: the way, m.
  kWheel,      ///< b turns freely, in space about its axle, and slides along `axis` on a spring.
               ///< Coordinate: the way.
  kWeld,       ///< b keeps its pose relative to a; soft where hertz > 0.
  kMotor,      ///< A weld that yields at force_max and torque_max; `target` is its angle, 2D.
  kTarget,     ///< anchor_b is drawn to anchor_a on a spring with at most force_max.
  kGear,       ///< angle_a + ratio angle_b stays; with `axis`, b's way along it (world). 2D.
  kPulley,     ///< |anchor_a - ground_a| + ratio |anchor_b - ground_b| = length.
  kCurve,      ///< anchor_b stays on a curve of body a; with limits, between offsets of it. 2D.
  kUser,       ///< Rows from a function of the user's: World::register_constraint.
  kHinge,      ///< anchor_a = anchor_b; b turns about `axis` alone. 3D. Coordinate: the angle.
  kConeTwist,  ///< A ball joint; with limits `axis` stays in a cone and its twist within. 3D.
};

/// Curves of a kCurve joint, in the frame of `anchor_a`.
enum class CurveKind : std::uint32_t {
  kCircle = 0,  ///< Radius size[0].
  kEllipse,     ///< Half axes size[0] and size[1].
  kCycloid,     ///< x = R (t + sin t), y = -R (1 + cos t), |t| <= pi, R = size[0]: a trough.
  kPolyline,    ///< The chains and polygons of body a.
};

/// What drives the coordinate of a joint.
enum class MotorKind : std::uint32_t {
  kOff = 0,
  kSpeed,  ///< Holds motor_speed; has no memory of where it was.
  /// Holds the coordinate at target + drive_amplitude sin(2 pi drive_hertz t). An angle goes there
  /// the shorter way round, as a spring about `target` does; between limits that are less than a
  /// turn apart, the way that they leave.
  kPosition,
};

template <int D>
struct JointDef {
  JointKind kind = JointKind::kRevolute;
  BodyId body_a;
  BodyId body_b;
  Vec<D> anchor_a = Vec<D>::zero();  ///< Frame of body a, from its origin, m.
  Vec<D> anchor_b = Vec<D>::zero();
  Vec<D> axis = Vec<D>::zero();  ///< Unit, frame of body a.
  /// Wheel in space: what b spins about at creation; unit, frame of body a, across `axis`.
  Vec<D> axle = Vec<D>::zero();
  float steering = 0.0f;  ///< Wheel in space: turn of the axle about `axis`, |.| <= 1.6 rad.
  float cone = 0.0f;      ///< Cone-twist: largest angle of swing, 0 to pi rad.
  float length = 0.0f;    ///< m; > 0 for distance; pulley: 0 is what it is at creation.
  float ratio = 1.0f;     ///< Gear and pulley; not 0.

  /// A damped spring, the same for every mass: of what moves while the rigid rest of the joint
  /// holds; beside another spring, as always in a motor joint, of what moves without that one.
  /// Distance and weld: 0 is rigid. Motor and target: 0 is tuning.joint_hertz. Revolute, hinge,
  /// prismatic and wheel: about `target`, 0 is none.
  float hertz = 0.0f;
  float damping_ratio = 0.0f;
  float angular_hertz = 0.0f;  ///< Of the rotation of weld, motor and cone-twist (0: no spring).
  float angular_damping_ratio = 0.0f;

  bool limit_enabled = false;  ///< lower <= coordinate <= upper. Distance: a rope of that length.
  float lower = 0.0f;          ///< rad of b relative to a at creation, or m; lower <= upper.
  float upper = 0.0f;
  MotorKind motor = MotorKind::kOff;
  float motor_speed = 0.0f;  ///< rad/s of b relative to a, or m/s.
  float motor_max = 0.0f;    ///< N m or N, >= 0.
  float target = 0.0f;       ///< rad or m.
  float drive_amplitude = 0.0f;
  float drive_hertz = 0.0f;

  float force_max = 0.0f;  ///< Motor and target: N, >= 0.
  /// N m, >= 0. Motor. Cone-twist: its friction or, with angular_hertz, its spring; 0: no friction,
  /// and a spring without bound.
  float torque_max = 0.0f;
  Vec<D> ground_a = Vec<D>::zero();  ///< Pulley: where the rope turns, world, m.
  Vec<D> ground_b = Vec<D>::zero();
  CurveKind curve = CurveKind::kCircle;
  std::array<float, 2> size{};        ///< Curve: m, > 0.
  std::uint32_t user_kind = 0;        ///< User: the number the function was registered under.
  std::array<float, 4> parameters{};  ///< User: for the function.
  bool collide_connected = false;
};

/// A point of a rope or a cloth: position-based, it meets shapes and does not push them.
template <int D>
struct ParticleDef {
  Vec<D> position = Vec<D>::zero();  ///< World, m.
  Vec<D> velocity = Vec<D>::zero();  ///< m/s.
  float mass = 0.01f;                ///< kg; 0: pinned where it is.
  float radius = 0.01f;              ///< m, > 0.
  std::uint32_t material = 0;
  std::uint32_t group = 0;  ///< The user's own: which rope or cloth it is of.
  Filter filter;
};

/// Keeps two particles `length` apart.
struct LinkDef {
  ParticleId particle_a;
  ParticleId particle_b;
  float length = 0.0f;      ///< m, >= 0.
  float compliance = 0.0f;  ///< m/N; 0 is rigid.
};

/// Holds a particle to a point of a body, which does not feel it.
template <int D>
struct PinDef {
  ParticleId particle;
  BodyId body;
  Vec<D> anchor = Vec<D>::zero();  ///< Frame of the body, from its origin, m.
};

/// How the errors of contacts and joints are corrected. All run through the same kernels.
enum class Stabilisation : std::uint32_t {
  kBaumgarte,  ///< bias = (baumgarte / h) (C + slop) in the velocity rows.
  kSoft,       ///< A damped spring per row; then relax sweeps without bias. Catto, Solver2D 2024.
  kSplitImpulse,  ///< Baumgarte's bias on pseudo-velocities, which move bodies and are forgotten.
  kNgs,           ///< Position sweeps on re-evaluated errors: non-linear Gauss-Seidel.
  kXpbd,          ///< Positions are projected, velocities follow. Mueller et al. 2020.
};

/// In which order one sweep visits the constraints.
enum class Order : std::uint32_t {
  kColor,    ///< Colour after colour; the only one that uses lanes and workers.
  kId,       ///< By the slots of joints, then by those of the shapes in contact.
  kReverse,  ///< Contacts and joints each in the reverse of kId.
};

/// Which rows of a contact are solved together instead of one after the other.
enum class ContactBlockRows : std::uint32_t {
  kNone,
  kNormals,  ///< The normals of a manifold: every case of the linear complementarity problem.
  kNormalFriction,  ///< Normal and tangents of a point: separate, stick or slide.
  kIsland,  ///< All that push and stick in an island, with its rigid joints; only with kSoft.
  /// The same where it is needed and costs little: thin islands (stacks, chains, bridges, arches)
  /// whose load a soft row would give way to, that rest or have joints; those that move are swept
  /// as rigid rows (stages/find_landing.cpp). Where such islands have all that moves, a tick takes
  /// fewer substeps (stages/choose_substeps.cpp). Springs of contacts are twice as stiff until they
  /// have given way by the slop (make_step_context). Without kSoft or with kDirect, kNone.
  kLoadedIsland,
};

/// How the equality rows of joints are solved.
enum class JointSolver : std::uint32_t {
  kIterated,
  kDirect,  ///< Exactly, where they form trees; what closes a loop is iterated.
};

/// The named settings of the one solver.
struct Tuning {
  std::uint32_t substeps = 4;
  std::uint32_t sweeps = 1;           ///< Sweeps per substep; biased where the method has a bias.
  std::uint32_t relax_sweeps = 1;     ///< Unbiased sweeps after the positions have moved.
  std::uint32_t position_sweeps = 0;  ///< Of kNgs and kXpbd, and pseudo-velocity sweeps.
  Stabilisation stabilisation = Stabilisation::kSoft;
  Order order = Order::kColor;
  ContactBlockRows contact_block = ContactBlockRows::kLoadedIsland;
  JointSolver joint_solver = JointSolver::kIterated;
  float warm_starting = 1.0f;    ///< Share of the last impulses to start from: 0 to 1.
  float over_relaxation = 1.0f;  ///< Factor on each change of an impulse (SOR): above 0, below 2.
  float baumgarte = 0.2f;
  float slop = 0.005f;          ///< m of overlap that is left alone, but by springs (kSoft).
  float correction_max = 0.2f;  ///< m or rad that one position sweep moves a row at most.
  float contact_hertz = 30.0f;  ///< At most an eighth of the substep rate is used.
  float contact_damping_ratio = 10.0f;
  float joint_hertz = 60.0f;  ///< At most a quarter of the substep rate is used.
  float joint_damping_ratio = 2.0f;
  float push_speed_max = 3.0f;         ///< m/s at which overlap is resolved at most.
  float restitution_threshold = 1.0f;  ///< m/s of approach below which nothing bounces.
  float speculative_distance = 0.02f;  ///< m of gap at which a contact point is made.
  float sleep_s = 0.5f;                ///< An island that rests so long is left alone; 0: never.
  float sleep_speed = 0.05f;           ///< m/s of a body's farthest point below which it rests.
  std::uint32_t continuous = 1;  ///< 1: Fast bodies stop at what they would pass through in a tick.
  /// Of particles: substeps do more against stretching than sweeps (particles/particle.hpp).
  std::uint32_t particle_substeps = 40;
  std::uint32_t particle_sweeps = 2;
  float particle_damping = 0.0f;  ///< 1/s.

  /// Small steps, one soft sweep and one relax sweep each: Soft Step, TGS-Soft (Catto 2024).
  static Tuning soft_step() {
    Tuning tuning;
    tuning.contact_block = ContactBlockRows::kNone;
    return tuning;
  }
  /// The default: the same, but for thin islands whose load it could not hold.
  static Tuning soft_loaded() { return {}; }
  /// Projected Gauss-Seidel with Baumgarte's bias, as in Box2D Lite (Catto, GDC 2006).
  static Tuning pgs() { return classic(Stabilisation::kBaumgarte, 10, 0, 0); }
  /// Overlap leaves through velocities of its own, so that it adds no energy.
  static Tuning split_impulse() { return classic(Stabilisation::kSplitImpulse, 10, 0, 10); }
  static Tuning pgs_ngs() { return classic(Stabilisation::kNgs, 8, 0, 3); }
  /// As Box2D 2.x: the normals of a manifold at once, in velocity and in position.
  static Tuning pgs_ngs_block() {
    Tuning tuning = pgs_ngs();
    tuning.contact_block = ContactBlockRows::kNormals;
    return tuning;
  }
  static Tuning pgs_soft() { return classic(Stabilisation::kSoft, 4, 2, 0); }
  static Tuning tgs_ngs() { return classic(Stabilisation::kNgs, 1, 0, 1).in_substeps(4); }
  static Tuning xpbd() { return classic(Stabilisation::kXpbd, 1, 0, 1).in_substeps(8); }

  Tuning in_substeps(std::uint32_t count) const {
    Tuning tuning = *this;
    tuning.substeps = count;
    return tuning;
  }

 private:
  static Tuning classic(Stabilisation stabilisation, std::uint32_t sweeps, std::uint32_t relax,
                        std::uint32_t position) {
    Tuning tuning;
    tuning.contact_block = ContactBlockRows::kNone;
    tuning.substeps = 1;
    tuning.sweeps = sweeps;
    tuning.relax_sweeps = relax;
    tuning.position_sweeps = position;
    tuning.stabilisation = stabilisation;
    return tuning;
  }
};

/// Whether loaded islands are solved at once, and what is swept is as ContactBlockRows says of it.
inline bool solves_loaded_islands(const Tuning& tuning) {
  return tuning.contact_block == ContactBlockRows::kLoadedIsland &&
         tuning.stabilisation == Stabilisation::kSoft &&
         tuning.joint_solver == JointSolver::kIterated;
}

/// Whether islands may be solved at once, all of them or those that are loaded.
inline bool solves_islands(const Tuning& tuning) {
  return tuning.contact_block == ContactBlockRows::kIsland || solves_loaded_islands(tuning);
}

/// Stated capacities. What would exceed one is refused with the name of the field.
struct Limits {
  std::uint32_t bodies = 65536;
  std::uint32_t shapes = 65536;
  std::uint32_t joints = 65536;
  std::uint32_t contacts = 262144;
  std::uint32_t materials = 256;
  std::uint32_t registers = 4096;
  std::uint32_t particles = 65536;
  std::uint32_t links = 262144;
  std::uint32_t pins = 4096;
};

template <int D>
struct WorldDef {
  Vec<D> gravity = Vec<D>::zero();  ///< m/s^2.
  float tick_s = 1.0f / 60.0f;
  Tuning tuning;
  Limits limits;
  std::vector<Material> materials = {Material{}};
};

}  // namespace cycloid::solver
