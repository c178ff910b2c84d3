#pragma once

#include <cstdint>
#include <vector>

#include "solver/dim.hpp"

namespace cycloid::solver {

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
  kCapsule,    ///< points[0..1], radius. 2D.
  kPolygon,    ///< 3 to 8 convex points in either winding, rounded by radius >= 0. 2D.
  kSegment,    ///< One edge of a chain; made by kChain, never defined directly.
  kChain,  ///< Open or closed polyline of a static body, solid to the right of its direction. 2D.
};

/// Which shapes meet: (a.category & b.mask) and (b.category & a.mask), unless both carry the same
/// non-zero group: then they always meet if it is positive, and never if it is negative.
struct Filter {
  std::uint32_t category = 1;
  std::uint32_t mask = 0xffffffffu;
  std::int32_t group = 0;
};

/// Friction mixes as sqrt(a b), restitution as max(a, b).
struct Material {
  float friction = 0.6f;     ///< Coulomb coefficient, >= 0.
  float restitution = 0.0f;  ///< 0 to 1.
};

template <int D>
struct ShapeDef {
  ShapeKind kind = ShapeKind::kBall;
  std::vector<Vec<D>> points;  ///< Body frame, m. Ball: its centre (none: the origin).
  float radius = 0.0f;         ///< m.
  Vec<D> normal = Vec<D>::zero();
  float offset = 0.0f;   ///< m along `normal`.
  bool loop = false;     ///< Chain: the last point joins the first.
  float density = 1.0f;  ///< kg/m^D; ignored where the body states its mass or is not dynamic.
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
  kDistance,  ///< |anchor_b - anchor_a| = length; a spring where hertz > 0.
  kRevolute,  ///< anchor_a = anchor_b. In 2D with limits and a motor; in 3D a ball joint.
};

template <int D>
struct JointDef {
  JointKind kind = JointKind::kRevolute;
  BodyId body_a;
  BodyId body_b;
  Vec<D> anchor_a = Vec<D>::zero();  ///< Frame of body a, from its origin, m.
  Vec<D> anchor_b = Vec<D>::zero();
  float length = 0.0f;         ///< Distance: m; > 0.
  float hertz = 0.0f;          ///< Distance: spring frequency; 0 is rigid.
  float damping_ratio = 0.0f;  ///< Distance: of the spring.
  bool limit_enabled = false;  ///< Revolute, 2D.
  float lower_angle = 0.0f;    ///< rad, of b relative to a at creation; lower <= upper.
  float upper_angle = 0.0f;
  bool motor_enabled = false;     ///< Revolute, 2D.
  float motor_speed = 0.0f;       ///< rad/s of b relative to a.
  float motor_torque_max = 0.0f;  ///< N m, >= 0.
  bool collide_connected = false;
};

/// How contact and joint errors are corrected. Both run through the same kernels.
enum class Stabilisation : std::uint32_t {
  kBaumgarte,  ///< bias = (baumgarte / h) (C + slop) in the velocity rows.
  kSoft,       ///< A damped spring per row; then relax sweeps without bias. Catto, Solver2D 2024.
};

/// The named settings of the one solver.
struct Tuning {
  std::uint32_t substeps = 4;
  std::uint32_t sweeps = 1;        ///< Biased sweeps per substep.
  std::uint32_t relax_sweeps = 1;  ///< Unbiased sweeps after the positions have moved.
  Stabilisation stabilisation = Stabilisation::kSoft;
  float baumgarte = 0.2f;
  float slop = 0.005f;          ///< m of overlap that is left alone.
  float contact_hertz = 30.0f;  ///< At most an eighth of the substep rate is used.
  float contact_damping_ratio = 10.0f;
  float joint_hertz = 60.0f;  ///< At most a quarter of the substep rate is used.
  float joint_damping_ratio = 2.0f;
  float push_speed_max = 3.0f;         ///< m/s at which overlap is resolved at most.
  float restitution_threshold = 1.0f;  ///< m/s of approach below which nothing bounces.
  float speculative_distance = 0.02f;  ///< m of gap at which a contact point is made.

  static Tuning soft_step() { return {}; }
  /// Projected Gauss-Seidel with Baumgarte's bias, as in Box2D Lite (Catto, GDC 2006).
  static Tuning pgs() {
    Tuning tuning;
    tuning.substeps = 1;
    tuning.sweeps = 10;
    tuning.relax_sweeps = 0;
    tuning.stabilisation = Stabilisation::kBaumgarte;
    return tuning;
  }
};

/// Stated capacities. What would exceed one is refused with the name of the field.
struct Limits {
  std::uint32_t bodies = 65536;
  std::uint32_t shapes = 65536;
  std::uint32_t joints = 65536;
  std::uint32_t contacts = 262144;
  std::uint32_t materials = 256;
  std::uint32_t registers = 4096;
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
