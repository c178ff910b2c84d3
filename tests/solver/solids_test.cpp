#include "tests/solver/space_fixture.hpp"

namespace cycloid::solver {

/// A plane through the origin that rises along x by `angle` rad.
static BodyId add_slope(World<3>& world, float angle) {
  return add_ground<3>(world, {{-std::sin(angle), std::cos(angle), 0.0f}});
}

TEST(SolidBall, RollsDownASlopeAtFiveSeventhsOfGravity) {
  constexpr float kAngle = 0.5f;
  World<3> world = make_world(with_gravity<3>());
  add_slope(world, kAngle);
  const Vec<3> normal = {{-std::sin(kAngle), std::cos(kAngle), 0.0f}};
  const BodyId id = add_at<3>(world, 0.5f * normal, ball<3>(0.5f));
  step(world, 120);
  const BodyView<3> body = view(world, id);
  const double expected = 5.0 / 7.0 * 10.0 * std::sin(0.5) * 2.0;
  EXPECT_NEAR(static_cast<double>(length(body.velocity)) / expected, 1.0, 0.01);
  EXPECT_NEAR(static_cast<double>(length(body.spin)) * 0.5 / expected, 1.0, 0.01);
}

TEST(BowlingBall, SlidesUntilItRollsAtFiveSeventhsOfItsSpeed) {
  World<3> world = make_world(with_gravity<3>({0.2f, 0.0f, 0.0f}));
  add_ground<3>(world, up<3>());
  BodyDef<3> def;
  def.position = {{0.0f, 0.11f, 0.0f}};
  def.velocity = {{4.2f, 0.0f, 5.6f}};  // 7 m/s, along no axis.
  const BodyId id = add(world, def, ball<3>(0.11f));
  // It slides for 2 v0 / (7 mu g) = 1 s.
  step(world, 54);
  EXPECT_GT(length(view(world, id).velocity), 5.1f);
  step(world, 66);
  const BodyView<3> body = view(world, id);
  EXPECT_NEAR(body.velocity[0], 3.0f, 0.03f);
  EXPECT_NEAR(body.velocity[2], 4.0f, 0.04f);
  EXPECT_NEAR(body.spin[2], -3.0f / 0.11f, 0.3f);
  EXPECT_NEAR(body.spin[0], 4.0f / 0.11f, 0.4f);
}

static BodyId add_box_stack(World<3>& world, int count) {
  BodyId last;
  for (int i = 0; i < count; ++i)
    last = add_at<3>(world, {{0.0f, 0.5f + static_cast<float>(i), 0.0f}},
                     box_def({{0.5f, 0.5f, 0.5f}}));
  return last;
}

TEST(BoxStack, OfTenStandsAMinuteAndSleeps) {
  World<3> world = make_world(with_gravity<3>());
  add_ground<3>(world, up<3>());
  const BodyId top = add_box_stack(world, 10);
  step(world, 3600);
  const BodyView<3> body = view(world, top);
  // What ten soft contacts give way.
  EXPECT_NEAR(body.position[1], 9.5f, 0.04f);
  EXPECT_LT(std::hypot(body.position[0], body.position[2]), 0.05f);
  EXPECT_EQ(world.statistics().asleep, 10u);
  EXPECT_EQ(world.statistics().rows, 0u);
}

TEST(BoxStack, OfTenStandsAMinuteAwake) {
  WorldDef<3> def = with_gravity<3>();
  def.tuning.sleep_s = 0.0f;
  World<3> world = make_world(def);
  add_ground<3>(world, up<3>());
  const BodyId top = add_box_stack(world, 10);
  step(world, 3600);
  const BodyView<3> body = view(world, top);
  EXPECT_NEAR(body.position[1], 9.5f, 0.08f);
  EXPECT_LT(std::hypot(body.position[0], body.position[2]), 0.05f);
}

/// Linear and angular momentum about the origin, in double.
struct Momentum {
  double linear[3] = {};
  double angular[3] = {};
  double linear_sum = 0.0;  ///< Of the lengths, the scale of rounding.
  double angular_sum = 0.0;
};

static Momentum momentum_of(const World<3>& world) {
  Momentum sum;
  for (const Body<3>& body : world.state().bodies) {
    if (body.kind != BodyKind::kDynamic) continue;
    const Vec<3> spin = rotate(body.rotation, body.inertia * rotate_back(body.rotation, body.spin));
    double p[3];
    double x[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = static_cast<double>(body.mass) * static_cast<double>(body.velocity[i]);
      x[i] = static_cast<double>(body.position[i]);
    }
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const int k = (i + 2) % 3;
      sum.linear[i] += p[i];
      sum.linear_sum += std::abs(p[i]);
      sum.angular[i] += x[j] * p[k] - x[k] * p[j] + static_cast<double>(spin[i]);
      sum.angular_sum += std::abs(x[j] * p[k]) + std::abs(x[k] * p[j]);
    }
  }
  return sum;
}

TEST(IsolatedPile, KeepsItsMomentumToRounding) {
  World<3> world = make_world(WorldDef<3>{});
  for (int i = 0; i < 27; ++i) {
    BodyDef<3> def;
    const Vec<3> place = {{static_cast<float>(i % 3) - 1.0f, static_cast<float>(i / 3 % 3) - 1.0f,
                           static_cast<float>(i / 9) - 1.0f}};
    def.position = 1.3f * place;
    // Towards the middle, and round it.
    def.velocity = -1.0f * place + cross(Vec<3>{{0.2f, 0.5f, -0.3f}}, def.position);
    def.spin = {{0.3f * place[1], 0.2f, -0.4f * place[0]}};
    const ShapeDef<3> shape =
        i % 3 == 0 ? ball<3>(0.5f)
                   : (i % 3 == 1 ? box_def({{0.5f, 0.4f, 0.3f}})
                                 : capsule_def({{-0.3f, 0, 0}}, {{0.3f, 0, 0}}, 0.3f));
    add(world, def, shape);
  }
  const Momentum start = momentum_of(world);
  std::uint32_t contacts = 0;
  for (int tick = 0; tick < 300; ++tick) {
    ASSERT_TRUE(world.step().ok());
    contacts += world.statistics().contacts;
  }
  EXPECT_GT(contacts, 500u);
  const Momentum end = momentum_of(world);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(end.linear[i], start.linear[i], 1e-5 * start.linear_sum);
    EXPECT_NEAR(end.angular[i], start.angular[i], 1e-4 * start.angular_sum);
  }
}

/// The same bodies in the plane and, half a metre deep to either side, in space.
struct Twin {
  World<2> plane;
  World<3> space;

  explicit Twin(Material material)
      : plane(make_world(with_gravity<2>(material))), space(make_world(with_gravity<3>(material))) {
    add_ground<2>(plane, up<2>());
    add_ground<3>(space, up<3>());
  }
  struct Ids {
    BodyId plane;
    BodyId space;
  };
  Ids add_box(float x, float y, float half_x, float half_y, float speed = 0.0f) {
    BodyDef<2> flat;
    flat.position = {{x, y}};
    flat.velocity = {{speed, 0.0f}};
    BodyDef<3> deep;
    deep.position = {{x, y, 0.0f}};
    deep.velocity = {{speed, 0.0f, 0.0f}};
    return {add(plane, flat, box(half_x, half_y)),
            add(space, deep, box_def({{half_x, half_y, 0.5f}}))};
  }
  /// The largest difference of any position, m, of those bodies.
  float difference(const std::vector<Ids>& ids) const {
    float worst = 0.0f;
    for (const Ids& id : ids) {
      const Vec<2> flat = view(plane, id.plane).position;
      const Vec<3> deep = view(space, id.space).position;
      worst = std::max(
          {worst, std::abs(flat[0] - deep[0]), std::abs(flat[1] - deep[1]), std::abs(deep[2])});
    }
    return worst;
  }
};

TEST(PlaneInSpace, ASlidingBoxAgreesWithinAMillimetre) {
  Twin twin({0.4f, 0.0f, 0.0f});
  const std::vector<Twin::Ids> ids = {twin.add_box(10.0f, 0.25f, 0.5f, 0.25f, 4.0f)};
  for (int tick = 0; tick < 180; ++tick) {
    step(twin.plane, 1);
    step(twin.space, 1);
    ASSERT_LT(twin.difference(ids), 1e-3f) << tick;
  }
}

// Four soft rows give way less than two, and one after the other they rock a falling box by other
// millimetres.
TEST(PlaneInSpace, AFallenStackAgreesWithinThreeCentimetres) {
  Twin twin({0.4f, 0.0f, 0.0f});
  std::vector<Twin::Ids> ids;
  for (int i = 0; i < 5; ++i)
    ids.push_back(twin.add_box(0.05f * static_cast<float>(i), 0.6f + 1.1f * static_cast<float>(i),
                               0.5f, 0.5f));
  for (int tick = 0; tick < 12; ++tick) {
    step(twin.plane, 1);
    step(twin.space, 1);
  }
  EXPECT_LT(twin.difference(ids), 1e-3f);  // Falling; the lowest has just met the ground.
  for (int tick = 12; tick < 180; ++tick) {
    step(twin.plane, 1);
    step(twin.space, 1);
    ASSERT_LT(twin.difference(ids), 0.03f) << tick;
  }
}

TEST(PlaneInSpace, AHingedChainAgreesWithPinsWithinAMillimetre) {
  Twin twin({0.4f, 0.0f, 0.0f});
  BodyDef<2> flat;
  flat.kind = BodyKind::kStatic;
  BodyDef<3> deep;
  deep.kind = BodyKind::kStatic;
  Twin::Ids before{twin.plane.create_body(flat, {}).value(),
                   twin.space.create_body(deep, {}).value()};
  std::vector<Twin::Ids> ids;
  for (int i = 0; i < 4; ++i) {
    const Twin::Ids bar = twin.add_box(0.5f + static_cast<float>(i), 6.0f, 0.45f, 0.1f);
    const float from = i == 0 ? 0.0f : 0.5f;
    JointDef<2> pin;
    pin.body_a = before.plane;
    pin.body_b = bar.plane;
    pin.anchor_a = {{from, i == 0 ? 6.0f : 0.0f}};
    pin.anchor_b = {{-0.5f, 0.0f}};
    ASSERT_TRUE(twin.plane.create_joint(pin).ok());
    JointDef<3> hinge;
    hinge.kind = JointKind::kHinge;
    hinge.axis = {{0.0f, 0.0f, 1.0f}};
    hinge.body_a = before.space;
    hinge.body_b = bar.space;
    hinge.anchor_a = {{pin.anchor_a[0], pin.anchor_a[1], 0.0f}};
    hinge.anchor_b = {{-0.5f, 0.0f, 0.0f}};
    ASSERT_TRUE(twin.space.create_joint(hinge).ok());
    ids.push_back(bar);
    before = bar;
  }
  for (int tick = 0; tick < 90; ++tick) {
    step(twin.plane, 1);
    step(twin.space, 1);
    ASSERT_LT(twin.difference(ids), 1e-3f) << tick;
  }
}

}  // namespace cycloid::solver
