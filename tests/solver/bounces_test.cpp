#include <gtest/gtest.h>

#include <vector>

#include "solver/constraints/contact_kernels.hpp"
#include "solver/constraints/single_lanes.hpp"
#include "tests/solver/space_fixture.hpp"

namespace cycloid::solver {

/// A block whose lane 0 has a body, slot 0, that falls at 2 m/s towards slot 1, which has no mass.
/// It has room for two points; the gap of one that is not there is 0.
struct FallingBody {
  ContactBlock<2, 4> block{};
  ContactExtra<2, 4> extra{};
  std::vector<Motion<2>> motions = std::vector<Motion<2>>(2);

  FallingBody() {
    block.extra = &extra;
    for (int lane = 0; lane < 4; ++lane) block.body_a[lane] = block.body_b[lane] = 1;
    block.body_b[0] = 0;
    block.moves_b = 1;
    block.placed = 1;
    block.point_count = 2;
    block.bounces = true;
    set_lane(block.normal, 0, Vec<2>{{0.0f, 1.0f}});
    set_lane(block.mass_b.inverse_mass, 0, 1.0f);
    set_lane(extra.restitution, 0, 0.5f);
    motions[0].velocity = {{0.0f, -2.0f}};
  }

  void add_point(int point, float gap) {
    set_lane(block.points[point].gap, 0, gap);
    set_lane(block.points[point].normal_mass, 0, 1.0f);
  }

  void bounce() {
    const StepContext<2> context = make_step_context<2>(1.0f / 60.0f, {{0.0f, 0.0f}}, Tuning{});
    ContactKernels<2, 4>::bounce(context, {&block, &block + 1, motions.data(), 1, false});
  }
};

TEST(Bounces, ThrowBackWhatArrives) {
  FallingBody falling;
  falling.add_point(0, 0.0f);
  falling.bounce();
  EXPECT_TRUE(falling.block.bounced);
  EXPECT_NEAR(falling.motions[0].velocity[1], 1.0f, 1.0e-6f);
}

TEST(Bounces, AskOfWhatIsStillFarNothing) {
  FallingBody falling;
  falling.add_point(0, 0.1f);
  falling.add_point(1, 0.1f);
  falling.bounce();
  EXPECT_FALSE(falling.block.bounced);
  EXPECT_EQ(falling.motions[0].velocity[1], -2.0f);
}

// Else the block would be swept again, and again nothing would come of it.
TEST(Bounces, AreOfNoPointThatALaneDoesNotHave) {
  FallingBody falling;
  falling.add_point(0, 0.1f);
  falling.bounce();
  EXPECT_FALSE(falling.block.bounced);
  EXPECT_EQ(falling.motions[0].velocity[1], -2.0f);
}

static ShapeDef<2> box_of(Dim<2>) {
  return box(0.5f, 0.25f);
}
static ShapeDef<3> box_of(Dim<3>) {
  return box_def({{0.5f, 0.25f, 0.5f}});
}

/// Boxes that fall flat from many heights; at the ground they have 6 to 9 m/s.
template <int D>
static void expect_to_bounce_flat(float restitution) {
  for (int height = 0; height < 40; ++height) {
    SCOPED_TRACE(height);
    const float fall_m = 1.8f + 0.057f * static_cast<float>(height);
    World<D> world = make_world(with_gravity<D>({.friction = 0.5f, .restitution = restitution}));
    add_ground(world, up<D>());
    const BodyId id = add_at(world, at<D>(0.3f, 0.25f + fall_m), box_of(Dim<D>{}));
    float highest_m = 0.0f;
    bool has_bounced = false;
    for (int tick = 0; tick < 150; ++tick) {
      step(world, 1);
      const BodyView<D> body = view(world, id);
      ASSERT_LT(length(body.spin), 0.05f) << "tick " << tick;
      has_bounced = has_bounced || body.velocity[1] > 1.0f;
      if (has_bounced) highest_m = std::max(highest_m, body.position[1] - 0.25f);
      if (has_bounced && body.velocity[1] < 0.0f) break;
    }
    EXPECT_NEAR(highest_m, restitution * restitution * fall_m, 0.02f * fall_m);
  }
}

TEST(Bounces, OfBoxesThatLandFlatTurnThemNotAndReachTheirHeight) {
  for (const float restitution : {0.5f, 0.8f, 1.0f}) {
    SCOPED_TRACE(restitution);
    expect_to_bounce_flat<2>(restitution);
    expect_to_bounce_flat<3>(restitution);
  }
}

// A box that lands on its edge turns, and what it turns with is not made of nothing.
TEST(Bounces, OfTiltedBoxesMakeNoEnergy) {
  for (int tilt = 1; tilt < 30; ++tilt) {
    SCOPED_TRACE(tilt);
    World<2> world = make_world(with_gravity<2>({.friction = 0.0f, .restitution = 1.0f}));
    add_ground(world, up<2>());
    BodyDef<2> def;
    def.position = {{0.0f, 3.0f}};
    def.rotation = rotation_by(Spin<2>{{0.002f * static_cast<float>(tilt * tilt)}});
    const BodyId id = add(world, def, box(0.5f, 0.25f));
    const auto energy = [&] {
      const Body<2>& body = world.state().bodies[id.index];
      return body.mass * (0.5f * dot(body.velocity, body.velocity) + 10.0f * body.position[1]) +
             0.5f * body.inertia.m[0] * body.spin[0] * body.spin[0];
    };
    const float before = energy();
    for (int tick = 0; tick < 600; ++tick) {
      step(world, 1);
      ASSERT_LT(energy(), 1.05f * before) << "tick " << tick;
    }
  }
}

// Whose gap a substep closes to nothing, to the bit or by rounding, it has not arrived yet.
TEST(Bounces, AreNotLostWhereASubstepEndsAtTheSurface) {
  for (int offset = -20; offset <= 20; ++offset) {
    SCOPED_TRACE(offset);
    WorldDef<2> def = with_gravity<2>({.friction = 0.0f, .restitution = 1.0f});
    def.gravity = {{0.0f, 0.0f}};
    def.tick_s = 1.0f / 64.0f;
    World<2> world = make_world(def);
    add_ground(world, up<2>());
    BodyDef<2> falls;
    falls.position = {{0.0f, 0.75f + 3.0e-8f * static_cast<float>(offset)}};
    falls.velocity = {{0.0f, -2.0f}};
    const BodyId id = add(world, falls, ball<2>(0.5f));
    step(world, 30);
    EXPECT_NEAR(view(world, id).velocity[1], 2.0f, 1.0e-3f);
  }
}

}  // namespace cycloid::solver
