#include <functional>
#include <limits>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct BadBody {
  const char* field;
  int index;
  std::function<void(BodyDef<2>&, std::vector<ShapeDef<2>>&)> spoil;
};

// Each mistake alone is refused, with the field's name, and leaves the digest as it was.
TEST(CreateBody, RefusesEachMistakeByItsFieldAndChangesNothing) {
  const std::vector<BadBody> mistakes = {
      {"kind", -1, [](auto& b, auto&) { b.kind = BodyKind::kFree; }},
      {"position", -1, [](auto& b, auto&) { b.position[1] = kNan; }},
      {"position", -1, [](auto& b, auto&) { b.position[0] = kInfinity; }},
      {"position", -1, [](auto& b, auto&) { b.position[0] = 2.0e7f; }},
      {"position", -1,  // Of the centre of mass.
       [](auto& b, auto& s) {
         b.position[0] = 1.0e7f, s[0].points = {{{10.0f, 0.0f}}};
       }},
      {"rotation", -1,
       [](auto& b, auto&) {
         b.rotation = {{0.0f, 0.0f}};
       }},
      {"rotation", -1,
       [](auto& b, auto&) {
         b.rotation = {{kNan, 0.0f}};
       }},
      {"velocity", -1, [](auto& b, auto&) { b.velocity[0] = kNan; }},
      {"velocity", -1, [](auto& b, auto&) { b.kind = BodyKind::kStatic, b.velocity[0] = 1.0f; }},
      {"spin", -1, [](auto& b, auto&) { b.spin[0] = -kInfinity; }},
      {"spin", -1, [](auto& b, auto&) { b.kind = BodyKind::kStatic, b.spin[0] = 1.0f; }},
      {"mass", -1, [](auto& b, auto&) { b.mass = -1.0f; }},
      {"mass", -1, [](auto& b, auto&) { b.mass = kNan; }},
      {"mass", -1, [](auto& b, auto&) { b.kind = BodyKind::kParticle; }},
      {"mass", -1, [](auto&, auto& s) { s.clear(); }},
      {"mass", -1, [](auto&, auto& s) { s[0].density = s[1].density = 0.0f; }},
      {"linear_damping", -1, [](auto& b, auto&) { b.linear_damping = -1.0f; }},
      {"angular_damping", -1, [](auto& b, auto&) { b.angular_damping = kNan; }},
      {"gravity_scale", -1, [](auto& b, auto&) { b.gravity_scale = kInfinity; }},
      {"radius", 0, [](auto&, auto& s) { s[0].radius = 0.0f; }},
      {"radius", 0, [](auto&, auto& s) { s[0].radius = -1.0f; }},
      {"radius", 0, [](auto&, auto& s) { s[0].radius = kNan; }},
      {"radius", 1, [](auto&, auto& s) { s[1].radius = -0.1f; }},
      {"density", 1, [](auto&, auto& s) { s[1].density = -1.0f; }},
      {"material", 0, [](auto&, auto& s) { s[0].material = 1; }},
      {"kind", 0, [](auto&, auto& s) { s[0].kind = ShapeKind::kHalfSpace; }},
      {"kind", 0, [](auto&, auto& s) { s[0].kind = ShapeKind::kSegment; }},
      {"points", 0,
       [](auto&, auto& s) {
         s[0].points = {{{kNan, 0.0f}}};
       }},
      {"points", 1, [](auto&, auto& s) { s[1].points.resize(2); }},
      {"points", 1,
       [](auto&, auto& s) {
         s[1].points.resize(9, {{0.0f, 0.0f}});
       }},
      {"points", 1, [](auto&, auto& s) { s[1].points[2] = s[1].points[1]; }},
      {"points", 1,
       [](auto&, auto& s) {
         s[1].points[2] = {{0.0f, -0.5f}};
       }},
      {"points", 1,
       [](auto&, auto& s) {
         s[1].points[3] = {{0.3f, 0.3f}};
       }},
      {"points", 1,
       [](auto&, auto& s) {
         // A star winds twice: every turn is convex, the polygon is not.
         s[1].points = {{{0.0f, 1.0f}},
                        {{-0.59f, -0.81f}},
                        {{0.95f, 0.31f}},
                        {{-0.95f, 0.31f}},
                        {{0.59f, -0.81f}}};
       }},
  };
  for (std::size_t i = 0; i < mistakes.size(); ++i) {
    World<2> world = make_world(with_gravity<2>());
    add_ground<2>(world, up<2>());
    const std::uint64_t before = world.digest();
    BodyDef<2> def;
    std::vector<ShapeDef<2>> shapes = {ball<2>(0.5f), box(0.5f, 0.5f)};
    mistakes[i].spoil(def, shapes);
    const Result<BodyId> result = world.create_body(def, shapes);
    ASSERT_FALSE(result.ok()) << "mistake " << i;
    EXPECT_EQ(result.error().code, Code::kInvalid) << "mistake " << i;
    EXPECT_STREQ(result.error().field, mistakes[i].field) << "mistake " << i;
    EXPECT_EQ(result.error().index, mistakes[i].index) << "mistake " << i;
    EXPECT_EQ(world.digest(), before) << "mistake " << i;
  }
}

TEST(CreateBody, RefusesPlanarShapesInSpace) {
  World<3> world = make_world<3>();
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kPolygon;
  shape.points.resize(3, Vec<3>::zero());
  const Result<BodyId> result = world.create_body({}, std::span(&shape, 1));
  ASSERT_FALSE(result.ok());
  EXPECT_STREQ(result.error().field, "kind");
}

TEST(CreateJoint, RefusesEachMistakeByItsField) {
  World<2> world = make_world<2>();
  const BodyId a = add_at<2>(world, {{0.0f, 0.0f}}, ball<2>(0.5f));
  const BodyId b = add_at<2>(world, {{2.0f, 0.0f}}, ball<2>(0.5f));
  BodyDef<2> fixed;
  fixed.kind = BodyKind::kStatic;
  const BodyId wall = world.create_body(fixed, {}).value();
  const BodyId floor = world.create_body(fixed, {}).value();
  const auto expect = [&](const char* field, Code code, auto&& spoil) {
    JointDef<2> def;
    def.body_a = a;
    def.body_b = b;
    def.length = 1.0f;
    spoil(def);
    const std::uint64_t before = world.digest();
    const Result<JointId> result = world.create_joint(def);
    ASSERT_FALSE(result.ok()) << field;
    EXPECT_EQ(result.error().code, code) << field;
    EXPECT_STREQ(result.error().field, field);
    EXPECT_EQ(world.digest(), before);
  };
  expect("body_a", Code::kUnknownId, [](auto& d) { d.body_a = {77, 0}; });
  expect("body_b", Code::kUnknownId, [](auto& d) { d.body_b.generation = 5; });
  expect("body_b", Code::kInvalid, [&](auto& d) { d.body_b = a; });
  expect("body_b", Code::kInvalid, [&](auto& d) { d.body_a = wall, d.body_b = floor; });
  expect("kind", Code::kInvalid, [](auto& d) { d.kind = JointKind::kFree; });
  expect("anchor_a", Code::kInvalid, [](auto& d) { d.anchor_a[0] = kNan; });
  expect("anchor_b", Code::kInvalid, [](auto& d) { d.anchor_b[1] = kInfinity; });
  expect("length", Code::kInvalid, [](auto& d) { d.kind = JointKind::kDistance, d.length = 0.0f; });
  expect("hertz", Code::kInvalid, [](auto& d) { d.hertz = -1.0f; });
  expect("damping_ratio", Code::kInvalid, [](auto& d) { d.damping_ratio = kNan; });
  expect("upper", Code::kInvalid, [](auto& d) { d.lower = 1.0f, d.upper = 0.5f; });
  expect("lower", Code::kInvalid, [](auto& d) { d.lower = kNan; });
  expect("motor_max", Code::kInvalid, [](auto& d) { d.motor_max = -1.0f; });
  expect("motor_speed", Code::kInvalid, [](auto& d) { d.motor_speed = kNan; });
  expect("motor", Code::kInvalid,
         [](auto& d) { d.kind = JointKind::kWeld, d.motor = MotorKind::kSpeed; });
  expect("axis", Code::kInvalid, [](auto& d) { d.kind = JointKind::kPrismatic; });
  expect("axis", Code::kInvalid, [](auto& d) { d.axis = {{2.0f, 0.0f}}; });
  expect("limit_enabled", Code::kInvalid,
         [](auto& d) { d.kind = JointKind::kWeld, d.limit_enabled = true; });
  expect("ratio", Code::kInvalid, [](auto& d) { d.kind = JointKind::kGear, d.ratio = 0.0f; });
  expect("size", Code::kInvalid, [](auto& d) { d.kind = JointKind::kCurve; });
  expect("size", Code::kInvalid, [](auto& d) { d.size[0] = kNan; });
  expect("size", Code::kInvalid, [](auto& d) {
    d.kind = JointKind::kCurve, d.size = {1.0f, kInfinity};
  });
  expect("curve", Code::kInvalid,
         [](auto& d) { d.kind = JointKind::kCurve, d.curve = CurveKind::kPolyline; });
  expect("user_kind", Code::kInvalid, [](auto& d) { d.kind = JointKind::kUser; });
  expect("force_max", Code::kInvalid, [](auto& d) { d.force_max = -1.0f; });
}

TEST(CreateWorld, RefusesEachMistakeByItsField) {
  const auto expect = [](const char* field, auto&& spoil) {
    WorldDef<3> def;
    spoil(def);
    const Result<World<3>> result = World<3>::create(def);
    ASSERT_FALSE(result.ok()) << field;
    EXPECT_STREQ(result.error().field, field);
  };
  expect("gravity", [](auto& d) { d.gravity[2] = kNan; });
  expect("tick_s", [](auto& d) { d.tick_s = 0.0f; });
  expect("tick_s", [](auto& d) { d.tick_s = kNan; });
  expect("substeps", [](auto& d) { d.tuning.substeps = 0; });
  expect("sweeps", [](auto& d) { d.tuning.sweeps = 0; });
  expect("slop", [](auto& d) { d.tuning.slop = -0.1f; });
  expect("contact_hertz", [](auto& d) { d.tuning.contact_hertz = kInfinity; });
  expect("materials", [](auto& d) { d.materials.clear(); });
  expect("friction", [](auto& d) { d.materials[0].friction = -0.5f; });
  expect("restitution", [](auto& d) { d.materials[0].restitution = 1.5f; });
  expect("limits.bodies", [](auto& d) { d.limits.bodies = 0xffffffffu; });
}

TEST(Limits, OverflowOfEachCapacityIsNamedAndChangesNothing) {
  WorldDef<2> def;
  def.limits.bodies = 3;
  def.limits.shapes = 2;
  def.limits.joints = 1;
  def.limits.registers = 4;
  World<2> world = make_world(def);
  const BodyId a = add_at<2>(world, {{0.0f, 0.0f}}, ball<2>(0.5f));
  const BodyId b = add_at<2>(world, {{5.0f, 0.0f}}, ball<2>(0.5f));
  JointDef<2> joint;
  joint.body_a = a;
  joint.body_b = b;
  ASSERT_TRUE(world.create_joint(joint).ok());
  const std::uint64_t before = world.digest();

  const ShapeDef<2> shape = ball<2>(0.5f);
  EXPECT_STREQ(world.create_body({}, std::span(&shape, 1)).error().field, "limits.shapes");
  EXPECT_EQ(world.create_body({}, std::span(&shape, 1)).error().code, Code::kCapacity);
  EXPECT_STREQ(world.create_joint(joint).error().field, "limits.joints");
  EXPECT_STREQ(world.resize_registers(5).field, "limits.registers");
  EXPECT_EQ(world.digest(), before);
  BodyDef<2> bare;
  bare.mass = 1.0f;
  ASSERT_TRUE(world.create_body(bare, {}).ok());
  EXPECT_STREQ(world.create_body(bare, {}).error().field, "limits.bodies");
}

TEST(Limits, MoreContactsThanStatedFaultTheWorldAndKeepItsState) {
  WorldDef<2> def = with_gravity<2>();
  def.limits.contacts = 1;
  World<2> world = make_world(def);
  add_ground<2>(world, up<2>());
  add_at<2>(world, {{0.0f, 0.5f}}, ball<2>(0.5f));
  const BodyId b = add_at<2>(world, {{5.0f, 0.5f}}, ball<2>(0.5f));
  const Error error = world.step();
  EXPECT_EQ(error.code, Code::kFaulted);
  EXPECT_STREQ(error.field, "limits.contacts");
  ASSERT_TRUE(world.fault().has_value());
  EXPECT_EQ(world.fault()->tick, 1u);
  EXPECT_EQ(world.tick(), 0u);
  EXPECT_EQ(view(world, b).position[1], 0.5f);
}

TEST(Ids, StaleIdIsRefusedAndNeverNamesAnotherBody) {
  World<2> world = make_world<2>();
  const BodyId first = add_at<2>(world, {{0.0f, 0.0f}}, ball<2>(0.5f));
  ASSERT_TRUE(world.destroy_body(first).ok());
  const BodyId second = add_at<2>(world, {{1.0f, 0.0f}}, ball<2>(0.5f));
  ASSERT_EQ(first.index, second.index);
  EXPECT_NE(first, second);
  EXPECT_FALSE(world.contains(first));
  const std::uint64_t before = world.digest();
  EXPECT_EQ(world.destroy_body(first).code, Code::kUnknownId);
  EXPECT_EQ(world.apply_force(first, {{1.0f, 0.0f}}).code, Code::kUnknownId);
  EXPECT_EQ(world.apply_impulse(first, {{1.0f, 0.0f}}).code, Code::kUnknownId);
  EXPECT_EQ(world.set_velocity(first, {{1.0f, 0.0f}}, {{0.0f}}).code, Code::kUnknownId);
  EXPECT_EQ(world.set_mass(first, 2.0f).code, Code::kUnknownId);
  EXPECT_EQ(world.body(first).error().code, Code::kUnknownId);
  EXPECT_EQ(world.digest(), before);
  EXPECT_TRUE(world.contains(second));
}

TEST(Ids, DestroyedBodyTakesItsJointsAndContactsWithIt) {
  World<2> world = make_world(with_gravity<2>());
  add_ground<2>(world, up<2>());
  const BodyId a = add_at<2>(world, {{0.0f, 0.5f}}, box(0.5f, 0.5f));
  const BodyId b = add_at<2>(world, {{0.0f, 1.5f}}, box(0.5f, 0.5f));
  JointDef<2> joint;
  joint.body_a = a;
  joint.body_b = b;
  joint.anchor_a = {{0.5f, 0.5f}};
  joint.anchor_b = {{0.5f, -0.5f}};
  const JointId id = world.create_joint(joint).value();
  step(world, 5);
  ASSERT_TRUE(world.destroy_body(a).ok());
  EXPECT_EQ(world.destroy_joint(id).code, Code::kUnknownId);
  step(world, 60);
  EXPECT_NEAR(view(world, b).position[1], 0.5f, 0.02f);
}

TEST(Setters, ForceAndTorqueOfABodyWithoutMassAreLookedAtAndNotKept) {
  World<2> world = make_world<2>();
  for (const BodyKind kind : {BodyKind::kStatic, BodyKind::kKinematic}) {
    BodyDef<2> def;
    def.kind = kind;
    const BodyId id = add(world, def, ball<2>(0.5f));
    const std::uint64_t before = world.digest();
    EXPECT_TRUE(world.apply_force(id, {{1.0f, 2.0f}}).ok());
    EXPECT_TRUE(world.apply_torque(id, {{3.0f}}).ok());
    EXPECT_EQ(world.digest(), before);
    EXPECT_STREQ(world.apply_force(id, {{kNan, 0.0f}}).field, "force_n");
    EXPECT_STREQ(world.apply_torque(id, {{kInfinity}}).field, "torque_n_m");
    EXPECT_EQ(world.digest(), before);
  }
}

TEST(Setters, RefuseWhatIsNotFiniteAndChangeNothing) {
  World<2> world = make_world<2>();
  const BodyId id = add_at<2>(world, {{0.0f, 0.0f}}, ball<2>(0.5f));
  const std::uint64_t before = world.digest();
  EXPECT_STREQ(world.apply_force(id, {{kNan, 0.0f}}).field, "force_n");
  EXPECT_STREQ(world.apply_torque(id, {{kInfinity}}).field, "torque_n_m");
  EXPECT_STREQ(world.apply_impulse(id, {{0.0f, kNan}}).field, "impulse_n_s");
  EXPECT_STREQ(world.apply_angular_impulse(id, {{kNan}}).field, "impulse_n_m_s");
  EXPECT_STREQ(world.set_velocity(id, {{kNan, 0.0f}}, {{0.0f}}).field, "velocity");
  EXPECT_STREQ(world.set_pose(id, {{kNan, 0.0f}}, {{1.0f, 0.0f}}).field, "position");
  EXPECT_STREQ(world.set_pose(id, {{0.0f, 0.0f}}, {{0.5f, 0.0f}}).field, "rotation");
  EXPECT_STREQ(world.set_gravity({{0.0f, kInfinity}}).field, "gravity");
  EXPECT_STREQ(world.set_mass(id, 0.0f).field, "mass_kg");
  EXPECT_STREQ(world.set_damping(id, -1.0f, 0.0f).field, "linear");
  EXPECT_STREQ(world.set_material(9, {}).field, "material");
  EXPECT_STREQ(world.set_filter(id, 1, {}).field, "shape");
  EXPECT_STREQ(world.set_register(0, 1).field, "index");
  EXPECT_STREQ(world.set_workers(0).field, "workers");
  EXPECT_STREQ(world.set_lanes(3).field, "lanes");
  Tuning tuning;
  tuning.substeps = 65;
  EXPECT_STREQ(world.set_tuning(tuning).field, "substeps");
  EXPECT_EQ(world.digest(), before);
}

TEST(Setters, RefuseAPoseWhoseCentreOfMassIsOutOfBounds) {
  World<2> world = make_world<2>();
  ShapeDef<2> aside = ball<2>(0.5f);
  aside.points = {{{10.0f, 0.0f}}};
  const BodyId id = add_at<2>(world, {{0.0f, 0.0f}}, aside);
  const std::uint64_t before = world.digest();
  EXPECT_STREQ(world.set_pose(id, {{1.0e7f, 0.0f}}, {{1.0f, 0.0f}}).field, "position");
  EXPECT_EQ(world.digest(), before);
  EXPECT_TRUE(world.set_pose(id, {{1.0e7f, 0.0f}}, {{-1.0f, 0.0f}}).ok()) << "it lies inside";
  EXPECT_TRUE(world.step().ok());
}

TEST(Events, BeginAndEndAreReportedOnceAndInOrder) {
  World<2> world = make_world(with_gravity<2>({0.5f, 0.0f}));
  const BodyId ground = add_ground<2>(world, up<2>());
  const BodyId a = add_at<2>(world, {{0.0f, 1.0f}}, ball<2>(0.5f));
  const BodyId b = add_at<2>(world, {{5.0f, 1.0f}}, ball<2>(0.5f));
  std::vector<ContactEvent> events;
  for (int i = 0; i < 120; ++i) {
    step(world, 1);
    events.insert(events.end(), world.contact_events().begin(), world.contact_events().end());
  }
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0], (ContactEvent{ground, a, 0, 0, true}));
  EXPECT_EQ(events[1], (ContactEvent{ground, b, 0, 0, true}));
  ASSERT_TRUE(world.apply_impulse(b, {{0.0f, 5.0f}}).ok());
  ASSERT_TRUE(world.destroy_body(a).ok());
  step(world, 5);
  events.assign(world.contact_events().begin(), world.contact_events().end());
  for (int i = 0; i < 5; ++i) {
    step(world, 1);
    events.insert(events.end(), world.contact_events().begin(), world.contact_events().end());
  }
  EXPECT_TRUE(events.empty());
}

TEST(Events, ADestroyedBodyEndsItsContactsInTheNextStep) {
  World<2> world = make_world(with_gravity<2>());
  const BodyId ground = add_ground<2>(world, up<2>());
  const BodyId a = add_at<2>(world, {{0.0f, 0.5f}}, ball<2>(0.5f));
  step(world, 2);
  ASSERT_TRUE(world.destroy_body(a).ok());
  step(world, 1);
  ASSERT_EQ(world.contact_events().size(), 1u);
  EXPECT_EQ(world.contact_events()[0], (ContactEvent{ground, a, 0, 0, false}));
  step(world, 1);
  EXPECT_TRUE(world.contact_events().empty());
}

TEST(Filter, DecidesWhichShapesMeet) {
  struct Case {
    Filter a;
    Filter b;
    bool meet;
  };
  const Case cases[] = {
      {{1, 0xffffffffu, 0}, {1, 0xffffffffu, 0}, true},
      {{1, 2, 0}, {1, 0xffffffffu, 0}, false},
      {{1, 2, 0}, {2, 1, 0}, true},
      {{1, 0xffffffffu, -3}, {1, 0xffffffffu, -3}, false},
      {{1, 0, 4}, {1, 0, 4}, true},
      {{1, 0xffffffffu, -3}, {1, 0xffffffffu, -4}, true},
  };
  for (const Case& test : cases) {
    World<2> world = make_world<2>();
    ShapeDef<2> a = ball<2>(0.5f);
    a.filter = test.a;
    ShapeDef<2> b = ball<2>(0.5f);
    b.filter = test.b;
    add_at<2>(world, {{0.0f, 0.0f}}, a);
    add_at<2>(world, {{0.8f, 0.0f}}, b);
    step(world, 1);
    EXPECT_EQ(world.statistics().contacts == 1, test.meet);
  }
}

}  // namespace cycloid::solver
