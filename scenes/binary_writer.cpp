#include "scene_generated.h"
#include "scenes/accuracy.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::scenes {

static std::unique_ptr<fb::Triple> triple(const Triple& v) {
  return std::make_unique<fb::Triple>(v[0], v[1], v[2]);
}
static std::unique_ptr<fb::Quadruple> quadruple(const std::array<float, 4>& v) {
  return std::make_unique<fb::Quadruple>(v[0], v[1], v[2], v[3]);
}

static std::unique_ptr<fb::MaterialT> packed(const SceneMaterial& from) {
  auto to = std::make_unique<fb::MaterialT>();
  to->name = from.name;
  to->friction = from.friction;
  to->restitution = from.restitution;
  to->rolling_resistance = from.rolling_resistance;
  to->twist_resistance = from.twist_resistance;
  return to;
}

static std::unique_ptr<fb::ShapeT> packed(const SceneShape& from) {
  auto to = std::make_unique<fb::ShapeT>();
  to->kind = static_cast<fb::ShapeKind>(from.kind);
  for (const Triple& point : from.points) to->points.emplace_back(point[0], point[1], point[2]);
  to->radius = from.radius;
  to->normal = triple(from.normal);
  to->offset = from.offset;
  to->loop = from.loop;
  to->half = triple(from.half);
  to->rotation = quadruple(from.rotation);
  for (const std::array<std::uint32_t, 3>& corners : from.triangles)
    to->triangles.emplace_back(corners[0], corners[1], corners[2]);
  to->heights = from.heights;
  to->columns = from.columns;
  to->cell_x = from.cell[0];
  to->cell_z = from.cell[1];
  to->density = from.density;
  to->material = from.material;
  to->filter =
      std::make_unique<fb::Filter>(from.filter.category, from.filter.mask, from.filter.group);
  return to;
}

template <class Packed, class Part>
static void pack_all(const std::vector<Part>& from, std::vector<std::unique_ptr<Packed>>& to);

static std::unique_ptr<fb::BodyT> packed(const SceneBody& from) {
  auto to = std::make_unique<fb::BodyT>();
  to->name = from.name;
  to->kind = static_cast<fb::BodyKind>(from.kind);
  to->position = triple(from.position);
  to->angle = from.angle;
  to->rotation = quadruple(from.rotation);
  to->velocity = triple(from.velocity);
  to->spin = triple(from.spin);
  to->mass = from.mass;
  to->linear_damping = from.linear_damping;
  to->angular_damping = from.angular_damping;
  to->gravity_scale = from.gravity_scale;
  to->fixed_rotation = from.fixed_rotation;
  to->tag = from.tag;
  pack_all(from.shapes, to->shapes);
  return to;
}

static std::unique_ptr<fb::JointT> packed(const SceneJoint& from) {
  auto to = std::make_unique<fb::JointT>();
  to->name = from.name;
  to->kind = static_cast<fb::JointKind>(from.kind);
  to->body_a = from.body_a;
  to->body_b = from.body_b;
  to->anchor_a = triple(from.anchor_a);
  to->anchor_b = triple(from.anchor_b);
  to->axis = triple(from.axis);
  to->length = from.length;
  to->ratio = from.ratio;
  to->hertz = from.hertz;
  to->damping_ratio = from.damping_ratio;
  to->angular_hertz = from.angular_hertz;
  to->angular_damping_ratio = from.angular_damping_ratio;
  to->limit_enabled = from.limit_enabled;
  to->lower = from.lower;
  to->upper = from.upper;
  to->motor = static_cast<fb::MotorKind>(from.motor);
  to->motor_speed = from.motor_speed;
  to->motor_max = from.motor_max;
  to->target = from.target;
  to->drive_amplitude = from.drive_amplitude;
  to->drive_hertz = from.drive_hertz;
  to->force_max = from.force_max;
  to->torque_max = from.torque_max;
  to->ground_a = triple(from.ground_a);
  to->ground_b = triple(from.ground_b);
  to->curve = static_cast<fb::CurveKind>(from.curve);
  to->size_x = from.size[0];
  to->size_y = from.size[1];
  to->axle = triple(from.axle);
  to->steering = from.steering;
  to->cone = from.cone;
  to->collide_connected = from.collide_connected;
  return to;
}

static std::unique_ptr<fb::ControlT> packed(const Control& from) {
  auto to = std::make_unique<fb::ControlT>();
  to->source = static_cast<fb::Source>(from.source);
  to->index = from.index;
  to->effect = static_cast<fb::Effect>(from.effect);
  to->target = from.target;
  to->value = triple(from.value);
  to->frame = static_cast<fb::Frame>(from.frame);
  to->position = triple(from.position);
  to->velocity = triple(from.velocity);
  to->limit = from.limit;
  return to;
}

static std::unique_ptr<fb::ScriptEntryT> packed(const ScriptEntry& from) {
  auto to = std::make_unique<fb::ScriptEntryT>();
  to->from = from.from;
  to->until = from.until;
  to->every = from.every;
  to->hold = from.hold;
  to->axes = quadruple(from.axes);
  to->buttons = from.buttons;
  return to;
}

static std::unique_ptr<fb::SeatT> packed(const Seat& from) {
  auto to = std::make_unique<fb::SeatT>();
  to->name = from.name;
  pack_all(from.controls, to->controls);
  pack_all(from.script, to->script);
  return to;
}

template <class Packed, class Part>
static void pack_all(const std::vector<Part>& from, std::vector<std::unique_ptr<Packed>>& to) {
  for (const Part& part : from) to.push_back(packed(part));
}

static std::unique_ptr<fb::ClothPinT> packed(const ClothPin& from) {
  auto to = std::make_unique<fb::ClothPinT>();
  to->column = from.column;
  to->row = from.row;
  to->body = from.body;
  return to;
}

static std::unique_ptr<fb::ClothT> packed(const Cloth& from) {
  auto to = std::make_unique<fb::ClothT>();
  to->name = from.name;
  to->origin = triple(from.origin);
  to->across = triple(from.across);
  to->down = triple(from.down);
  to->columns = from.columns;
  to->rows = from.rows;
  to->mass = from.mass;
  to->radius = from.radius;
  to->compliance = from.compliance;
  to->shear_compliance = from.shear_compliance;
  to->material = from.material;
  to->filter =
      std::make_unique<fb::Filter>(from.filter.category, from.filter.mask, from.filter.group);
  pack_all(from.pins, to->pins);
  return to;
}

static std::unique_ptr<fb::CharacterT> packed(const SceneCharacter& from) {
  auto to = std::make_unique<fb::CharacterT>();
  to->name = from.name;
  to->position = triple(from.position);
  to->lower = triple(from.lower);
  to->upper = triple(from.upper);
  to->radius = from.radius;
  to->skin = from.skin;
  to->up = triple(from.up);
  to->slope_cos_min = from.slope_cos_min;
  to->step_height = from.step_height;
  to->push_mass = from.push_mass;
  to->push_force_max = from.push_force_max;
  to->gravity_scale = from.gravity_scale;
  to->speed = from.speed;
  to->acceleration = from.acceleration;
  to->air_acceleration = from.air_acceleration;
  to->jump_speed = from.jump_speed;
  to->filter =
      std::make_unique<fb::Filter>(from.filter.category, from.filter.mask, from.filter.group);
  return to;
}

static std::unique_ptr<fb::TuningT> packed(const solver::Tuning& from) {
  auto to = std::make_unique<fb::TuningT>();
  to->substeps = from.substeps;
  to->sweeps = from.sweeps;
  to->relax_sweeps = from.relax_sweeps;
  to->position_sweeps = from.position_sweeps;
  to->stabilisation =
      static_cast<fb::Stabilisation>(static_cast<std::uint32_t>(from.stabilisation) + 1);
  to->order = static_cast<fb::Order>(from.order);
  to->contact_block = static_cast<fb::ContactBlockRows>(from.contact_block);
  to->joint_solver = static_cast<fb::JointSolver>(from.joint_solver);
  to->warm_starting = from.warm_starting;
  to->over_relaxation = from.over_relaxation;
  to->baumgarte = from.baumgarte;
  to->slop = from.slop;
  to->correction_max = from.correction_max;
  to->contact_hertz = from.contact_hertz;
  to->contact_damping_ratio = from.contact_damping_ratio;
  to->joint_hertz = from.joint_hertz;
  to->joint_damping_ratio = from.joint_damping_ratio;
  to->push_speed_max = from.push_speed_max;
  to->restitution_threshold = from.restitution_threshold;
  to->speculative_distance = from.speculative_distance;
  to->sleep_s = from.sleep_s;
  to->sleep_speed = from.sleep_speed;
  to->continuous = from.continuous;
  to->particle_substeps = from.particle_substeps;
  to->particle_sweeps = from.particle_sweeps;
  to->particle_damping = from.particle_damping;
  return to;
}

static std::unique_ptr<fb::LimitsT> packed(const solver::Limits& from) {
  auto to = std::make_unique<fb::LimitsT>();
  to->bodies = from.bodies;
  to->shapes = from.shapes;
  to->joints = from.joints;
  to->contacts = from.contacts;
  to->materials = from.materials;
  to->registers = from.registers;
  to->particles = from.particles;
  to->links = from.links;
  to->pins = from.pins;
  return to;
}

static std::unique_ptr<fb::AccuracyT> packed(const SceneAccuracy& from) {
  auto to = std::make_unique<fb::AccuracyT>();
  to->error_m = from.error_m;
  to->error_percent = from.error_percent;
  to->tuned = std::make_unique<fb::TunedChoiceT>();
  to->tuned->solver_version = from.tuned.solver_version;
  to->tuned->tuning = packed(from.tuned.tuning);
  return to;
}

std::vector<std::byte> to_binary(const Scene& scene) {
  fb::SceneT to;
  to.name = scene.name;
  to.summary = scene.summary;
  to.dimension = scene.dimension;
  to.gravity = triple(scene.gravity);
  to.tick_hz = scene.tick_hz;
  to.tuning = packed(scene.tuning);
  to.limits = packed(scene.limits);
  pack_all(scene.materials, to.materials);
  pack_all(scene.bodies, to.bodies);
  pack_all(scene.joints, to.joints);
  pack_all(scene.cloths, to.cloths);
  pack_all(scene.characters, to.characters);
  pack_all(scene.prefabs, to.prefabs);
  pack_all(scene.seats, to.seats);
  // Scenes that state none keep the bytes that they had before there was one.
  if (states_accuracy(scene)) to.accuracy = packed(scene.accuracy);
  flatbuffers::FlatBufferBuilder builder;
  fb::FinishSceneBuffer(builder, fb::Scene::Pack(builder, &to));
  const auto* data = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  return {data, data + builder.GetSize()};
}

}  // namespace cycloid::scenes
