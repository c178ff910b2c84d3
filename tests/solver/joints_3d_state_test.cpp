#include <functional>

#include "solver/validate.hpp"
#include "tests/solver/joint_scene_3d.hpp"

namespace cycloid::solver {

/// What definitions, calls and untrusted states of the joints of space may say, and that a restored
/// world goes the same way.

static JointDef<3> def_of(JointKind kind, BodyId a, BodyId b) {
  JointDef<3> def;
  def.kind = kind;
  def.body_a = a;
  def.body_b = b;
  def.anchor_b = {{-0.5f, 0.0f, 0.0f}};
  def.axis = {{0.0f, 0.6f, 0.8f}};
  if (kind == JointKind::kWheel) def.axle = {{1.0f, 0.0f, 0.0f}};
  if (kind == JointKind::kConeTwist) def.cone = 0.4f, def.torque_max = 0.3f;
  def.limit_enabled = true;
  def.lower = -0.2f;
  def.upper = 0.3f;
  if (kind == JointKind::kConeTwist) return def;
  def.motor = MotorKind::kSpeed;
  def.motor_speed = 2.0f;
  def.motor_max = 4.0f;
  return def;
}

constexpr JointKind kKinds[] = {JointKind::kHinge, JointKind::kPrismatic, JointKind::kWheel,
                                JointKind::kConeTwist};

/// Two chains: one arm per kind on the anchor, and a second one on each arm.
static std::vector<JointId> add_arms(Scene<3>& scene) {
  std::vector<JointId> ids;
  for (std::size_t i = 0; i < std::size(kKinds); ++i) {
    const Vec<3> at = {{0.5f, 0.0f, 3.0f * static_cast<float>(i)}};
    const Vec<3> half = {{0.2f, 0.1f, 0.0f}};
    const BodyId first = add_dumbbell(scene.world, at, half, 2.0f);
    const BodyId second =
        add_dumbbell(scene.world, at + Vec<3>{{1.0f, 0.0f, 0.0f}}, half, 1.0f, 0.15f);
    JointDef<3> def = def_of(kKinds[i], scene.anchor, first);
    def.anchor_a = {{0.0f, 0.0f, 3.0f * static_cast<float>(i)}};
    ids.push_back(scene.create(def));
    def = def_of(kKinds[i], first, second);
    def.anchor_a = {{0.5f, 0.0f, 0.0f}};
    ids.push_back(scene.create(def));
  }
  return ids;
}

TEST(Joints3D, ARestoredWorldOfEveryKindTakesTheSameSteps) {
  for (const Method& method : methods()) {
    Scene<3> scene(method.tuning);
    const std::vector<JointId> ids = add_arms(scene);
    ASSERT_TRUE(scene.world.set_steering(ids[4], 0.3f).ok());
    step(scene.world, 45);
    std::vector<std::byte> bytes;
    scene.world.encode(bytes);
    Scene<3> other(method.tuning);
    ASSERT_TRUE(other.world.decode(bytes).ok());
    const Joint<3>& wheel = other.state_of(ids[4]);
    EXPECT_EQ(wheel.steering, 0.3f);
    float cone_impulse = 0.0f;
    for (int tick = 0; tick < 120; ++tick) {
      step(scene.world, 1);
      step(other.world, 1);
      for (const Joint<3>& joint : scene.world.state().joints)
        cone_impulse = std::max(cone_impulse, joint.cone_impulse);
      std::vector<std::byte> again;
      scene.world.encode(bytes);
      other.world.encode(again);
      ASSERT_EQ(bytes, again) << method.name << " tick " << tick;
    }
    if (std::string_view(method.name) != "xpbd") {
      EXPECT_GT(cone_impulse, 0.0f) << method.name;
    }
  }
}

// The kernel of the trees takes the five rows of hinges and the four of wheels as it takes others.
TEST(Joints3D, TheDirectSolverTakesTheirEqualities) {
  Tuning tuning = Tuning::soft_step();
  tuning.joint_solver = JointSolver::kDirect;
  tuning.sleep_s = 0.0f;
  Scene<3> scene(tuning);
  const std::vector<JointId> ids = add_arms(scene);
  for (int tick = 0; tick < 300; ++tick) {
    step(scene.world, 1);
    for (std::size_t i = 0; i < 6; ++i) ASSERT_LT(scene.error(ids[i]), 0.01f) << tick << " " << i;
  }
  EXPECT_EQ(scene.world.statistics().direct_rows, 2u * (5 + 5 + 4));
}

TEST(Joints3D, WhatADefinitionMayNotSayIsRefusedByTheNameOfItsField) {
  Scene<3> scene(Tuning::soft_step());
  const BodyId body = scene.add_ball({{1.0f, 0.0f, 0.0f}}, 1.0f);
  const auto refused = [&](JointKind kind, const char* field,
                           const std::function<void(JointDef<3>&)>& spoil) {
    JointDef<3> def = def_of(kind, scene.anchor, body);
    spoil(def);
    const Result<JointId> id = scene.world.create_joint(def);
    ASSERT_FALSE(id.ok()) << field;
    EXPECT_STREQ(id.error().field, field);
  };
  for (const JointKind kind : kKinds) {
    refused(kind, "axis", [](auto& d) { d.axis = Vec<3>::zero(); });
    refused(kind, "axle", [](auto& d) { d.axle = {{0.5f, 0.0f, 0.0f}}; });
    refused(kind, "steering", [](auto& d) { d.steering = 1.7f; });
    refused(kind, "cone", [](auto& d) { d.cone = -0.1f; });
    refused(kind, "cone", [](auto& d) { d.cone = std::nanf(""); });
  }
  refused(JointKind::kWheel, "axle", [](auto& d) { d.axle = Vec<3>::zero(); });
  refused(JointKind::kWheel, "axle", [](auto& d) { d.axle = {{0.0f, 0.8f, -0.59f}}; });
  refused(JointKind::kWheel, "axle", [](auto& d) { d.axle = {{0.999f, 0.04f, 0.0f}}; });
  refused(JointKind::kWheel, "motor", [](auto& d) { d.motor = MotorKind::kPosition; });
  refused(JointKind::kConeTwist, "motor", [](auto& d) { d.motor = MotorKind::kSpeed; });
  refused(JointKind::kHinge, "upper", [](auto& d) { d.upper = 3.3f; });
  refused(static_cast<JointKind>(14), "kind", [](auto&) {});
  refused(JointKind::kGear, "kind", [](auto&) {});
}

TEST(Joints3D, ThePlaneHasNeitherHingesNorConesNorAxles) {
  Scene<2> scene(Tuning::soft_step());
  const BodyId body = scene.add_ball({{1.0f, 0.0f}}, 1.0f);
  const auto field_of = [&](const std::function<void(JointDef<2>&)>& spoil) -> std::string {
    JointDef<2> def = scene.joint(JointKind::kWheel, scene.anchor, body);
    def.axis = {{0.0f, 1.0f}};
    spoil(def);
    const Result<JointId> id = scene.world.create_joint(def);
    return id.ok() ? "" : id.error().field;
  };
  EXPECT_EQ(field_of([](auto&) {}), "");
  EXPECT_EQ(field_of([](auto& d) { d.kind = JointKind::kHinge; }), "kind");
  EXPECT_EQ(field_of([](auto& d) { d.kind = JointKind::kConeTwist; }), "kind");
  EXPECT_EQ(field_of([](auto& d) { d.axle = {{1.0f, 0.0f}}; }), "axle");
  EXPECT_EQ(field_of([](auto& d) { d.steering = 0.1f; }), "steering");
}

TEST(Joints3D, SteeringIsOfWheelsAndWithinItsRange) {
  Scene<3> scene(Tuning::soft_step());
  const std::vector<JointId> ids = add_arms(scene);
  const auto field_of = [&](JointId id, float angle) -> std::string {
    const Error error = scene.world.set_steering(id, angle);
    return error.ok() ? "" : error.field;
  };
  EXPECT_EQ(field_of(ids[4], 1.6f), "");
  EXPECT_EQ(scene.state_of(ids[4]).steering, 1.6f);
  EXPECT_EQ(field_of(ids[4], 1.61f), "angle");
  EXPECT_EQ(field_of(ids[4], std::nanf("")), "angle");
  EXPECT_EQ(field_of(ids[0], 0.1f), "joint");
  EXPECT_EQ(scene.world.set_steering({99, 0}, 0.1f).code, Code::kUnknownId);
  EXPECT_EQ(scene.state_of(ids[4]).steering, 1.6f);
  EXPECT_FALSE(scene.world.joint_angle(ids[2]).ok());
  EXPECT_TRUE(scene.world.joint_angle(ids[0]).ok());
}

// Each of these would read past a table or leave the numbers; a state from outside may hold it.
TEST(Joints3D, AStateWithASpoiltJointIsRefused) {
  Scene<3> scene(Tuning::soft_step());
  const std::vector<JointId> ids = add_arms(scene);
  const auto accepts = [&](JointId id, const std::function<void(Joint<3>&)>& spoil) {
    WorldState<3> state = scene.world.state();
    state.joints.edit_one(id.index, spoil);
    return validate(state).ok();
  };
  EXPECT_TRUE(accepts(ids[4], [](auto&) {}));
  EXPECT_FALSE(accepts(ids[4], [](auto& j) { j.steering = 1.7f; }));
  EXPECT_FALSE(accepts(ids[4], [](auto& j) { j.steering = std::nanf(""); }));
  EXPECT_FALSE(accepts(ids[4], [](auto& j) { j.axle = j.axis; }));
  EXPECT_FALSE(accepts(ids[4], [](auto& j) { j.axle = Vec<3>::zero(); }));
  EXPECT_FALSE(accepts(ids[6], [](auto& j) { j.cone = 3.2f; }));
  EXPECT_FALSE(accepts(ids[6], [](auto& j) { j.cone_impulse = HUGE_VALF; }));
  EXPECT_FALSE(accepts(ids[0], [](auto& j) { j.axis = Vec<3>::zero(); }));
  EXPECT_FALSE(accepts(ids[0], [](auto& j) { j.kind = static_cast<JointKind>(14); }));
  EXPECT_FALSE(accepts(ids[0], [](auto& j) { j.kind = JointKind::kGear; }));
}

}  // namespace cycloid::solver
