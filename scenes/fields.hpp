#pragma once

#include <span>
#include <string_view>
#include <utility>

#include "scenes/scene.hpp"

namespace cycloid::scenes {

/// The fields of each part of a scene by name, once: the JSON reader, the JSON writer and the
/// digest of a scene's meaning walk these. `f(name, field)` is called for each.

template <class T>
struct Names;
template <>
struct Names<solver::ShapeKind> {
  static constexpr std::pair<std::string_view, solver::ShapeKind> kAll[] = {
      {"ball", solver::ShapeKind::kBall},
      {"half_space", solver::ShapeKind::kHalfSpace},
      {"capsule", solver::ShapeKind::kCapsule},
      {"polygon", solver::ShapeKind::kPolygon},
      {"chain", solver::ShapeKind::kChain},
      {"box", solver::ShapeKind::kBox},
      {"hull", solver::ShapeKind::kHull},
      {"mesh", solver::ShapeKind::kMesh},
      {"height_field", solver::ShapeKind::kHeightField}};
};
template <>
struct Names<solver::BodyKind> {
  static constexpr std::pair<std::string_view, solver::BodyKind> kAll[] = {
      {"static", solver::BodyKind::kStatic},
      {"kinematic", solver::BodyKind::kKinematic},
      {"dynamic", solver::BodyKind::kDynamic},
      {"particle", solver::BodyKind::kParticle}};
};
/// User-defined kinds are functions of a program, not data, so scenes have no name for them.
template <>
struct Names<solver::JointKind> {
  static constexpr std::pair<std::string_view, solver::JointKind> kAll[] = {
      {"distance", solver::JointKind::kDistance},   {"revolute", solver::JointKind::kRevolute},
      {"prismatic", solver::JointKind::kPrismatic}, {"wheel", solver::JointKind::kWheel},
      {"weld", solver::JointKind::kWeld},           {"motor", solver::JointKind::kMotor},
      {"target", solver::JointKind::kTarget},       {"gear", solver::JointKind::kGear},
      {"pulley", solver::JointKind::kPulley},       {"curve", solver::JointKind::kCurve},
      {"hinge", solver::JointKind::kHinge},         {"cone_twist", solver::JointKind::kConeTwist}};
};
template <>
struct Names<solver::CurveKind> {
  static constexpr std::pair<std::string_view, solver::CurveKind> kAll[] = {
      {"circle", solver::CurveKind::kCircle},
      {"ellipse", solver::CurveKind::kEllipse},
      {"cycloid", solver::CurveKind::kCycloid},
      {"polyline", solver::CurveKind::kPolyline}};
};
template <>
struct Names<solver::MotorKind> {
  static constexpr std::pair<std::string_view, solver::MotorKind> kAll[] = {
      {"off", solver::MotorKind::kOff},
      {"speed", solver::MotorKind::kSpeed},
      {"position", solver::MotorKind::kPosition}};
};
template <>
struct Names<solver::Stabilisation> {
  static constexpr std::pair<std::string_view, solver::Stabilisation> kAll[] = {
      {"baumgarte", solver::Stabilisation::kBaumgarte},
      {"soft", solver::Stabilisation::kSoft},
      {"split_impulse", solver::Stabilisation::kSplitImpulse},
      {"ngs", solver::Stabilisation::kNgs},
      {"xpbd", solver::Stabilisation::kXpbd}};
};
template <>
struct Names<solver::Order> {
  static constexpr std::pair<std::string_view, solver::Order> kAll[] = {
      {"color", solver::Order::kColor},
      {"id", solver::Order::kId},
      {"reverse", solver::Order::kReverse}};
};
template <>
struct Names<solver::ContactBlockRows> {
  static constexpr std::pair<std::string_view, solver::ContactBlockRows> kAll[] = {
      {"none", solver::ContactBlockRows::kNone},
      {"normals", solver::ContactBlockRows::kNormals},
      {"normal_friction", solver::ContactBlockRows::kNormalFriction},
      {"island", solver::ContactBlockRows::kIsland},
      {"loaded_island", solver::ContactBlockRows::kLoadedIsland}};
};
template <>
struct Names<solver::JointSolver> {
  static constexpr std::pair<std::string_view, solver::JointSolver> kAll[] = {
      {"iterated", solver::JointSolver::kIterated}, {"direct", solver::JointSolver::kDirect}};
};
template <>
struct Names<Source> {
  static constexpr std::pair<std::string_view, Source> kAll[] = {{"axis", Source::kAxis},
                                                                 {"button", Source::kButton}};
};
template <>
struct Names<Effect> {
  static constexpr std::pair<std::string_view, Effect> kAll[] = {
      {"force", Effect::kForce},
      {"torque", Effect::kTorque},
      {"motor_speed", Effect::kMotorSpeed},
      {"impulse", Effect::kImpulse},
      {"spawn", Effect::kSpawn},
      {"walk", Effect::kWalk},
      {"jump", Effect::kJump},
      {"steering", Effect::kSteering}};
};
template <>
struct Names<Frame> {
  static constexpr std::pair<std::string_view, Frame> kAll[] = {{"world", Frame::kWorld},
                                                                {"body", Frame::kBody}};
};

/// Whether a field of four numbers is a quaternion: those are written and read in full.
inline bool is_quaternion(std::string_view field) {
  return field == "rotation";
}

/// "" for an enumerator that no scene names.
template <class Enum>
std::string_view name_of(Enum value) {
  for (const auto& [name, known] : Names<Enum>::kAll)
    if (known == value) return name;
  return "";
}

template <class F>
void fields(SceneMaterial& m, F&& f) {
  f("name", m.name);
  f("friction", m.friction);
  f("restitution", m.restitution);
  f("rolling_resistance", m.rolling_resistance);
  f("twist_resistance", m.twist_resistance);
}

template <class F>
void fields(solver::Filter& filter, F&& f) {
  f("category", filter.category);
  f("mask", filter.mask);
  f("group", filter.group);
}

template <class F>
void fields(SceneShape& s, F&& f) {
  f("kind", s.kind);
  f("points", s.points);
  f("radius", s.radius);
  f("normal", s.normal);
  f("offset", s.offset);
  f("loop", s.loop);
  f("half", s.half);
  f("rotation", s.rotation);
  f("triangles", s.triangles);
  f("heights", s.heights);
  f("columns", s.columns);
  f("cell", s.cell);
  f("density", s.density);
  f("material", s.material);
  f("filter", s.filter);
}

template <class F>
void fields(SceneBody& b, F&& f) {
  f("name", b.name);
  f("kind", b.kind);
  f("position", b.position);
  f("angle", b.angle);
  f("rotation", b.rotation);
  f("velocity", b.velocity);
  f("spin", b.spin);
  f("mass", b.mass);
  f("linear_damping", b.linear_damping);
  f("angular_damping", b.angular_damping);
  f("gravity_scale", b.gravity_scale);
  f("fixed_rotation", b.fixed_rotation);
  f("tag", b.tag);
  f("shapes", b.shapes);
}

template <class F>
void fields(SceneJoint& j, F&& f) {
  f("name", j.name);
  f("kind", j.kind);
  f("body_a", j.body_a);
  f("body_b", j.body_b);
  f("anchor_a", j.anchor_a);
  f("anchor_b", j.anchor_b);
  f("axis", j.axis);
  f("axle", j.axle);
  f("steering", j.steering);
  f("cone", j.cone);
  f("length", j.length);
  f("ratio", j.ratio);
  f("hertz", j.hertz);
  f("damping_ratio", j.damping_ratio);
  f("angular_hertz", j.angular_hertz);
  f("angular_damping_ratio", j.angular_damping_ratio);
  f("limit_enabled", j.limit_enabled);
  f("lower", j.lower);
  f("upper", j.upper);
  f("motor", j.motor);
  f("motor_speed", j.motor_speed);
  f("motor_max", j.motor_max);
  f("target", j.target);
  f("drive_amplitude", j.drive_amplitude);
  f("drive_hertz", j.drive_hertz);
  f("force_max", j.force_max);
  f("torque_max", j.torque_max);
  f("ground_a", j.ground_a);
  f("ground_b", j.ground_b);
  f("curve", j.curve);
  f("size", j.size);
  f("collide_connected", j.collide_connected);
}

template <class F>
void fields(ClothPin& p, F&& f) {
  f("column", p.column);
  f("row", p.row);
  f("body", p.body);
}

template <class F>
void fields(Cloth& c, F&& f) {
  f("name", c.name);
  f("origin", c.origin);
  f("across", c.across);
  f("down", c.down);
  f("columns", c.columns);
  f("rows", c.rows);
  f("mass", c.mass);
  f("radius", c.radius);
  f("compliance", c.compliance);
  f("shear_compliance", c.shear_compliance);
  f("material", c.material);
  f("filter", c.filter);
  f("pins", c.pins);
}

template <class F>
void fields(SceneCharacter& c, F&& f) {
  f("name", c.name);
  f("position", c.position);
  f("lower", c.lower);
  f("upper", c.upper);
  f("radius", c.radius);
  f("skin", c.skin);
  f("up", c.up);
  f("slope_cos_min", c.slope_cos_min);
  f("step_height", c.step_height);
  f("push_mass", c.push_mass);
  f("push_force_max", c.push_force_max);
  f("gravity_scale", c.gravity_scale);
  f("speed", c.speed);
  f("acceleration", c.acceleration);
  f("air_acceleration", c.air_acceleration);
  f("jump_speed", c.jump_speed);
  f("filter", c.filter);
}

template <class F>
void fields(Control& c, F&& f) {
  f("source", c.source);
  f("index", c.index);
  f("effect", c.effect);
  f("target", c.target);
  f("value", c.value);
  f("frame", c.frame);
  f("position", c.position);
  f("velocity", c.velocity);
  f("limit", c.limit);
}

template <class F>
void fields(ScriptEntry& e, F&& f) {
  f("from", e.from);
  f("until", e.until);
  f("every", e.every);
  f("hold", e.hold);
  f("axes", e.axes);
  f("buttons", e.buttons);
}

template <class F>
void fields(Seat& s, F&& f) {
  f("name", s.name);
  f("controls", s.controls);
  f("script", s.script);
}

template <class F>
void fields(solver::Tuning& t, F&& f) {
  f("substeps", t.substeps);
  f("sweeps", t.sweeps);
  f("relax_sweeps", t.relax_sweeps);
  f("position_sweeps", t.position_sweeps);
  f("stabilisation", t.stabilisation);
  f("order", t.order);
  f("contact_block", t.contact_block);
  f("joint_solver", t.joint_solver);
  f("warm_starting", t.warm_starting);
  f("over_relaxation", t.over_relaxation);
  f("baumgarte", t.baumgarte);
  f("slop", t.slop);
  f("correction_max", t.correction_max);
  f("contact_hertz", t.contact_hertz);
  f("contact_damping_ratio", t.contact_damping_ratio);
  f("joint_hertz", t.joint_hertz);
  f("joint_damping_ratio", t.joint_damping_ratio);
  f("push_speed_max", t.push_speed_max);
  f("restitution_threshold", t.restitution_threshold);
  f("speculative_distance", t.speculative_distance);
  f("sleep_s", t.sleep_s);
  f("sleep_speed", t.sleep_speed);
  f("continuous", t.continuous);
  f("particle_substeps", t.particle_substeps);
  f("particle_sweeps", t.particle_sweeps);
  f("particle_damping", t.particle_damping);
}

template <class F>
void fields(solver::Limits& l, F&& f) {
  f("bodies", l.bodies);
  f("shapes", l.shapes);
  f("joints", l.joints);
  f("contacts", l.contacts);
  f("materials", l.materials);
  f("registers", l.registers);
  f("particles", l.particles);
  f("links", l.links);
  f("pins", l.pins);
}

template <class F>
void fields(TunedChoice& c, F&& f) {
  f("solver_version", c.solver_version);
  f("tuning", c.tuning);
}

template <class F>
void fields(SceneAccuracy& a, F&& f) {
  f("error_m", a.error_m);
  f("error_percent", a.error_percent);
  f("tuned", a.tuned);
}

template <class F>
void fields(Scene& s, F&& f) {
  f("name", s.name);
  f("summary", s.summary);
  f("dimension", s.dimension);
  f("gravity", s.gravity);
  f("tick_hz", s.tick_hz);
  f("tuning", s.tuning);
  f("limits", s.limits);
  f("materials", s.materials);
  f("bodies", s.bodies);
  f("joints", s.joints);
  f("cloths", s.cloths);
  f("characters", s.characters);
  f("prefabs", s.prefabs);
  f("seats", s.seats);
  f("accuracy", s.accuracy);
}

/// A part of a scene that has fields of its own.
template <class T>
concept HasFields = requires(T& t) {
  fields(t, [](const char*, auto&) {});
};

}  // namespace cycloid::scenes
