#include "solver/validate.hpp"

namespace cycloid::solver {

Error validate(const Tuning& t) {
  if (t.substeps < 1 || t.substeps > 64) return invalid("substeps");
  if (t.sweeps < 1 || t.sweeps > 1000) return invalid("sweeps");
  if (t.relax_sweeps > 1000) return invalid("relax_sweeps");
  if (t.position_sweeps > 1000) return invalid("position_sweeps");
  if (t.substeps * (t.sweeps + t.relax_sweeps + t.position_sweeps) > kSweepsMax)
    return invalid("substeps");
  if (t.stabilisation > Stabilisation::kXpbd) return invalid("stabilisation");
  if (t.order > Order::kReverse) return invalid("order");
  if (t.contact_block > ContactBlockRows::kLoadedIsland) return invalid("contact_block");
  if (t.contact_block == ContactBlockRows::kIsland && t.stabilisation != Stabilisation::kSoft)
    return invalid("contact_block");
  if (t.joint_solver > JointSolver::kDirect) return invalid("joint_solver");
  if (!within(t.warm_starting, 0.0f, 1.0f)) return invalid("warm_starting");
  if (!within(t.over_relaxation, 0.01f, 1.99f)) return invalid("over_relaxation");
  if (!within(t.correction_max, 0.0f, 10.0f)) return invalid("correction_max");
  if (!within(t.sleep_s, 0.0f, 1.0e6f)) return invalid("sleep_s");
  if (!within(t.sleep_speed, 0.0f, kSpeedMax)) return invalid("sleep_speed");
  if (t.continuous > 1) return invalid("continuous");
  if (t.particle_substeps < 1 || t.particle_substeps > 256) return invalid("particle_substeps");
  if (t.particle_sweeps < 1 || t.particle_sweeps > 1000) return invalid("particle_sweeps");
  if (t.particle_substeps * t.particle_sweeps > kSweepsMax) return invalid("particle_substeps");
  if (!within(t.particle_damping, 0.0f, 1.0e4f)) return invalid("particle_damping");
  if (!within(t.baumgarte, 0.0f, 2.0f)) return invalid("baumgarte");
  if (!within(t.slop, 0.0f, 1.0f)) return invalid("slop");
  if (!within(t.contact_hertz, 1.0e-3f, 1.0e5f)) return invalid("contact_hertz");
  if (!within(t.contact_damping_ratio, 0.0f, 1.0e3f)) return invalid("contact_damping_ratio");
  if (!within(t.joint_hertz, 1.0e-3f, 1.0e5f)) return invalid("joint_hertz");
  if (!within(t.joint_damping_ratio, 0.0f, 1.0e3f)) return invalid("joint_damping_ratio");
  if (!within(t.push_speed_max, 0.0f, kSpeedMax)) return invalid("push_speed_max");
  if (!within(t.restitution_threshold, 0.0f, kSpeedMax)) return invalid("restitution_threshold");
  if (!within(t.speculative_distance, 0.0f, 10.0f)) return invalid("speculative_distance");
  return {};
}

Error validate(const Limits& limits) {
  constexpr std::uint32_t kMax = 1u << 24;
  if (limits.bodies > kMax) return invalid("limits.bodies");
  if (limits.shapes > kMax) return invalid("limits.shapes");
  if (limits.joints > kMax) return invalid("limits.joints");
  if (limits.contacts > kMax) return invalid("limits.contacts");
  if (limits.materials > kMax) return invalid("limits.materials");
  if (limits.registers > kMax) return invalid("limits.registers");
  if (limits.particles > kMax) return invalid("limits.particles");
  if (limits.links > kMax) return invalid("limits.links");
  if (limits.pins > kMax) return invalid("limits.pins");
  return {};
}

Error validate(const Material& material, int index) {
  if (!within(material.friction, 0.0f, 1.0e3f)) return invalid("friction", index);
  if (!within(material.restitution, 0.0f, 1.0f)) return invalid("restitution", index);
  if (!within(material.rolling_resistance, 0.0f, 1.0e3f))
    return invalid("rolling_resistance", index);
  if (!within(material.twist_resistance, 0.0f, 1.0e3f)) return invalid("twist_resistance", index);
  return {};
}

template <int D>
Error validate(const WorldDef<D>& def) {
  if (!within(def.gravity, 1.0e4f)) return invalid("gravity");
  if (!within(def.tick_s, 1.0e-5f, 1.0f)) return invalid("tick_s");
  if (const Error error = validate(def.tuning); !error.ok()) return error;
  if (const Error error = validate(def.limits); !error.ok()) return error;
  if (def.materials.empty()) return invalid("materials");
  if (def.materials.size() > def.limits.materials) return {Code::kCapacity, "limits.materials"};
  for (std::size_t i = 0; i < def.materials.size(); ++i)
    if (const Error error = validate(def.materials[i], static_cast<int>(i)); !error.ok())
      return error;
  return {};
}

template <int D>
Error validate(const BodyDef<D>& def) {
  if (def.kind < BodyKind::kStatic || def.kind > BodyKind::kParticle) return invalid("kind");
  if (!within(def.position, kPositionMax)) return invalid("position");
  if (!is_unit(def.rotation)) return invalid("rotation");
  if (!within(def.velocity, kSpeedMax)) return invalid("velocity");
  if (!within(def.spin, kSpinMax)) return invalid("spin");
  const bool stated = def.mass != 0.0f || def.kind == BodyKind::kParticle;
  if (stated && !within(def.mass, kMassMin, kMassMax)) return invalid("mass");
  if (!within(def.linear_damping, 0.0f, 1.0e4f)) return invalid("linear_damping");
  if (!within(def.angular_damping, 0.0f, 1.0e4f)) return invalid("angular_damping");
  if (!within(def.gravity_scale, -1.0e3f, 1.0e3f)) return invalid("gravity_scale");
  if (def.kind == BodyKind::kStatic && dot(def.velocity, def.velocity) != 0.0f)
    return invalid("velocity");
  if (def.kind == BodyKind::kStatic && dot(def.spin, def.spin) != 0.0f) return invalid("spin");
  return {};
}

/// Kinds that exist in the plane only have one spin, those of space three.
static bool has_dimension(ShapeKind kind, int spin) {
  switch (kind) {
    case ShapeKind::kBall:
    case ShapeKind::kHalfSpace:
    case ShapeKind::kCapsule:
      return true;
    case ShapeKind::kPolygon:
    case ShapeKind::kChain:
      return spin == 1;
    case ShapeKind::kBox:
    case ShapeKind::kHull:
    case ShapeKind::kMesh:
    case ShapeKind::kHeightField:
      return spin != 1;
    default:
      return false;
  }
}

bool is_of_static_bodies(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::kHalfSpace:
    case ShapeKind::kSegment:
    case ShapeKind::kChain:
    case ShapeKind::kTriangle:
    case ShapeKind::kMesh:
    case ShapeKind::kHeightField:
      return true;
    default:
      return false;
  }
}

template <int D>
static Error validate_kind(const ShapeDef<D>& def, BodyKind body, int index) {
  if (!has_dimension(def.kind, Dim<D>::kSpin)) return invalid("kind", index);
  if (is_of_static_bodies(def.kind) && body != BodyKind::kStatic) return invalid("kind", index);
  return {};
}

static bool point_count_fits(ShapeKind kind, std::size_t count) {
  switch (kind) {
    case ShapeKind::kBall:
    case ShapeKind::kBox:
    case ShapeKind::kHeightField:
      return count <= 1;
    case ShapeKind::kHalfSpace:
      return count == 0;
    case ShapeKind::kHull:
      return count >= 4 && count <= kHullPointsMax;
    case ShapeKind::kMesh:
      return count >= 3;
    case ShapeKind::kCapsule:
      return count == 2;
    case ShapeKind::kPolygon:
      return count >= 3 && count <= 8;
    default:
      return count >= 2;
  }
}

/// What only a mesh or a height field has.
template <int D>
static Error validate_triangles(const ShapeDef<D>& def, int index) {
  constexpr std::size_t kMax = 1u << 24;
  if (def.kind == ShapeKind::kMesh) {
    if (def.triangles.empty() || def.triangles.size() > kMax) return invalid("triangles", index);
    for (const std::array<std::uint32_t, 3>& triangle : def.triangles)
      for (const std::uint32_t corner : triangle)
        if (corner >= def.points.size()) return invalid("triangles", index);
  }
  if (def.kind == ShapeKind::kHeightField) {
    if (def.columns < 2 || def.columns > kMax) return invalid("columns", index);
    const std::size_t count = def.heights.size();
    if (count < 2 * std::size_t{def.columns} || count % def.columns != 0 || count > kMax)
      return invalid("heights", index);
    for (const float height : def.heights)
      if (!within(height, -kSizeMax, kSizeMax)) return invalid("heights", index);
    const float steps[2] = {static_cast<float>(def.columns - 1),
                            static_cast<float>(count / def.columns - 1)};
    for (std::size_t i = 0; i < 2; ++i)
      if (!within(def.cell[i], kSizeMin, kSizeMax / steps[i])) return invalid("cell", index);
  }
  return {};
}

template <int D>
Error validate(const ShapeDef<D>& def, BodyKind body, std::size_t materials, int index) {
  if (const Error error = validate_kind(def, body, index); !error.ok()) return error;
  if (!point_count_fits(def.kind, def.points.size())) return invalid("points", index);
  for (const Vec<D>& point : def.points)
    if (!within(point, kSizeMax)) return invalid("points", index);
  const bool round = def.kind == ShapeKind::kBall || def.kind == ShapeKind::kCapsule;
  const bool sharp = !has_dimension(def.kind, 1);
  if (!within(def.radius, round ? kSizeMin : 0.0f, sharp ? 0.0f : kSizeMax))
    return invalid("radius", index);
  if (def.kind == ShapeKind::kBox) {
    for (const float half : def.half.v)
      if (!within(half, kSizeMin, kSizeMax)) return invalid("half", index);
    if (!is_unit(def.rotation)) return invalid("rotation", index);
  }
  if (def.kind == ShapeKind::kHalfSpace) {
    if (!is_unit(def.normal)) return invalid("normal", index);
    if (!within(def.offset, -kSizeMax, kSizeMax)) return invalid("offset", index);
  }
  if (const Error error = validate_triangles(def, index); !error.ok()) return error;
  if (!within(def.density, 0.0f, 1.0e9f)) return invalid("density", index);
  if (def.material >= materials) return invalid("material", index);
  return {};
}

template Error validate(const WorldDef<2>&);
template Error validate(const WorldDef<3>&);
template Error validate(const BodyDef<2>&);
template Error validate(const BodyDef<3>&);
template Error validate(const ShapeDef<2>&, BodyKind, std::size_t, int);
template Error validate(const ShapeDef<3>&, BodyKind, std::size_t, int);

}  // namespace cycloid::solver
