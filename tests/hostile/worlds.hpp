#pragma once

#include <stdexcept>
#include <string>

#include "solver/world.hpp"

namespace cycloid::hostile {

/// Small worlds in which every kind of record is in use: contacts, joints with a hole among them,
/// hulls, particles with links and pins, free slots, registers, pending forces. Few substeps, so
/// that a test can step tens of thousands of damaged copies.

template <class T>
T checked(solver::Result<T> result) {
  if (!result.ok()) throw std::logic_error(std::string("a sample: ") + result.error().field);
  return std::move(result.value());
}
inline void checked(const solver::Error& error) {
  if (!error.ok()) throw std::logic_error(std::string("a sample: ") + error.field);
}

template <int D>
solver::World<D> sample_world() {
  solver::WorldDef<D> def;
  def.gravity[1] = -10.0f;
  def.tuning.substeps = 2;
  def.tuning.particle_substeps = 2;
  def.materials = {{0.5f, 0.2f, 0.0f, 0.0f}, {0.1f, 0.0f, 0.01f, 0.01f}};
  return checked(solver::World<D>::create(def));
}

template <int D>
solver::ShapeDef<D> sample_ball(float radius) {
  solver::ShapeDef<D> shape;
  shape.radius = radius;
  shape.material = 1;
  return shape;
}

template <int D>
solver::ShapeDef<D> sample_capsule() {
  solver::ShapeDef<D> shape;
  shape.kind = solver::ShapeKind::kCapsule;
  shape.points.assign(2, solver::Vec<D>::zero());
  shape.points[0][0] = -0.3f;
  shape.points[1][0] = 0.3f;
  shape.radius = 0.2f;
  return shape;
}

template <int D>
solver::BodyId put(solver::World<D>& world, float x, float y, const solver::ShapeDef<D>& shape,
                   solver::BodyKind kind = solver::BodyKind::kDynamic) {
  solver::BodyDef<D> def;
  def.kind = kind;
  def.position[0] = x;
  def.position[1] = y;
  return checked(world.create_body(def, std::span(&shape, 1)));
}

template <int D>
solver::BodyId put_ground(solver::World<D>& world) {
  solver::ShapeDef<D> shape;
  shape.kind = solver::ShapeKind::kHalfSpace;
  shape.normal[1] = 1.0f;
  return put(world, 0.0f, 0.0f, shape, solver::BodyKind::kStatic);
}

template <int D>
solver::JointDef<D> joint_between(solver::JointKind kind, solver::BodyId a, solver::BodyId b) {
  solver::JointDef<D> def;
  def.kind = kind;
  def.body_a = a;
  def.body_b = b;
  return def;
}

/// A motor, a rope and the place of one that is gone.
template <int D>
void join(solver::World<D>& world, solver::BodyId a, solver::BodyId b) {
  using solver::JointKind;
  solver::JointDef<D> slide = joint_between<D>(JointKind::kPrismatic, a, b);
  slide.axis[1] = 1.0f;
  slide.limit_enabled = true;
  slide.lower = -0.5f;
  slide.upper = 0.5f;
  slide.motor = solver::MotorKind::kPosition;
  slide.motor_max = 5.0f;
  slide.drive_amplitude = 0.1f;
  slide.drive_hertz = 2.0f;
  checked(world.create_joint(slide));
  solver::JointDef<D> rope = joint_between<D>(JointKind::kDistance, a, b);
  rope.length = 2.0f;
  rope.hertz = 3.0f;
  rope.damping_ratio = 0.5f;
  const solver::JointId gone = checked(world.create_joint(rope));
  checked(world.create_joint(rope));
  checked(world.destroy_joint(gone));
}

template <int D>
void hang_rope(solver::World<D>& world, solver::BodyId from) {
  solver::ParticleId last;
  for (int i = 0; i < 4; ++i) {
    solver::ParticleDef<D> def;
    def.position[0] = 1.0f + 0.2f * static_cast<float>(i);
    def.position[1] = 0.3f;
    def.radius = 0.05f;
    const solver::ParticleId id = checked(world.create_particle(def));
    if (i > 0) checked(world.create_link({last, id, 0.2f, 1.0e-4f}));
    if (i == 0) checked(world.create_pin({id, from, solver::Vec<D>::zero()}));
    last = id;
  }
  checked(world.destroy_particle(last));
}

template <int D>
void finish(solver::World<D>& world, solver::BodyId pushed) {
  checked(world.resize_registers(2));
  checked(world.set_register(1, 7));
  for (int tick = 0; tick < 8; ++tick) checked(world.step());
  solver::Vec<D> force = solver::Vec<D>::zero();
  force[0] = 1.0f;
  checked(world.apply_force(pushed, force));
}

inline solver::World<2> planar_sample() {
  using namespace solver;
  World<2> world = sample_world<2>();
  put_ground(world);
  const BodyId gone = put(world, 9.0f, 5.0f, sample_ball<2>(0.5f));
  ShapeDef<2> box;
  box.kind = ShapeKind::kPolygon;
  box.points = {{{-0.5f, -0.5f}}, {{0.5f, -0.5f}}, {{0.5f, 0.5f}}, {{-0.5f, 0.5f}}};
  const BodyId a = put(world, 0.0f, 0.5f, box);
  const BodyId b = put(world, 0.1f, 1.2f, sample_capsule<2>());
  const BodyId c = put(world, 1.5f, 0.3f, sample_ball<2>(0.3f));
  ShapeDef<2> chain;
  chain.kind = ShapeKind::kChain;
  chain.points = {{{1.0f, 0.05f}}, {{2.0f, 0.0f}}, {{3.0f, 0.05f}}};
  put(world, 0.0f, 0.0f, chain, BodyKind::kStatic);
  join(world, a, b);
  checked(world.create_joint(joint_between<2>(JointKind::kGear, b, c)));
  JointDef<2> curve = joint_between<2>(JointKind::kCurve, a, c);
  curve.curve = CurveKind::kEllipse;
  curve.size = {1.5f, 1.0f};
  checked(world.create_joint(curve));
  hang_rope(world, c);
  checked(world.destroy_body(gone));
  finish(world, c);
  return world;
}

inline solver::World<3> spatial_sample() {
  using namespace solver;
  World<3> world = sample_world<3>();
  put_ground(world);
  const BodyId gone = put(world, 9.0f, 5.0f, sample_ball<3>(0.5f));
  ShapeDef<3> box;
  box.kind = ShapeKind::kBox;
  box.half = {{0.5f, 0.5f, 0.5f}};
  ShapeDef<3> hull;
  hull.kind = ShapeKind::kHull;
  hull.points = {
      {{-0.4f, -0.3f, -0.4f}}, {{0.4f, -0.3f, -0.4f}}, {{0, -0.3f, 0.5f}}, {{0, 0.5f, 0}}};
  const BodyId a = put(world, 0.0f, 0.5f, box);
  const BodyId b = put(world, 0.1f, 1.29f, hull);
  const BodyId c = put(world, 1.5f, 0.3f, sample_capsule<3>());
  ShapeDef<3> mesh;
  mesh.kind = ShapeKind::kMesh;
  mesh.points = {
      {{1.0f, 0.05f, -1.0f}}, {{2.0f, 0.05f, -1.0f}}, {{2.0f, 0.1f, 1.0f}}, {{1.0f, 0.1f, 1.0f}}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  put(world, 0.0f, 0.0f, mesh, BodyKind::kStatic);
  join(world, a, b);
  JointDef<3> wheel = joint_between<3>(JointKind::kWheel, b, c);
  wheel.axis = {{0, 1.0f, 0}};
  wheel.axle = {{0, 0, 1.0f}};
  wheel.hertz = 4.0f;
  checked(world.create_joint(wheel));
  JointDef<3> cone = joint_between<3>(JointKind::kConeTwist, a, c);
  cone.axis = {{1.0f, 0, 0}};
  cone.limit_enabled = true;
  cone.cone = 0.5f;
  cone.lower = -0.2f;
  cone.upper = 0.2f;
  checked(world.create_joint(cone));
  hang_rope(world, c);
  checked(world.destroy_body(gone));
  finish(world, c);
  return world;
}

template <int D>
solver::World<D> small_sample();
template <>
inline solver::World<2> small_sample<2>() {
  return planar_sample();
}
template <>
inline solver::World<3> small_sample<3>() {
  return spatial_sample();
}

}  // namespace cycloid::hostile
