#include <array>
#include <bit>
#include <utility>
#include <vector>

#include "tests/solver/method_settings.hpp"

namespace cycloid::solver {

/// What each named setting of the solver promises.

static bool soft_at_60_hertz(const Setting& setting) {
  return setting.tuning.stabilisation == Stabilisation::kSoft && setting.tuning.substeps == 1;
}

/// Upright, at most 35 mm aside (split_impulse leans by 30 mm at the top in its first second and
/// stays there), not deeper than `sag` at the top, and slower than `speed` after 5 s; an edge may
/// rest on the slop, where the method has one.
static void check_stack(const Setting& setting, float sag, float speed = 0.01f) {
  World<2> world = make_world(def_with<2>(setting.tuning));
  add_ground<2>(world, up<2>());
  const std::vector<BodyId> boxes = add_stack(world, 5);
  step(world, 300);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const BodyView<2> now = view(world, boxes[i]);
    const float height = 0.5f + static_cast<float>(i);
    EXPECT_LT(now.position[1], height + 0.001f) << setting.name << " box " << i;
    EXPECT_GT(now.position[1], height - sag) << setting.name << " box " << i;
    EXPECT_NEAR(now.position[0], 0.0f, 0.035f) << setting.name << " box " << i;
    EXPECT_NEAR(now.rotation[1], 0.0f, 0.01f) << setting.name << " box " << i;
    EXPECT_LT(length(now.velocity), speed) << setting.name << " box " << i;
  }
}

TEST(Methods, EachHoldsAStackOfFiveBoxes) {
  for (const Setting& setting : method_settings()) {
    if (setting.tuning.stabilisation == Stabilisation::kXpbd) continue;
    // At one substep a contact's spring is held to 7.5 Hz, and sags under four boxes by 0.06 m.
    check_stack(setting, soft_at_60_hertz(setting) ? 0.15f : 0.035f);
  }
}

// Its velocities are displacements of a substep, so they keep the noise of the projection; with
// fewer substeps, or one position sweep each, the stack drifts apart in a minute, as published.
TEST(Methods, XpbdHoldsAStackOfFiveBoxesInSixteenSubstepsOfFourSweeps) {
  Setting setting = method_settings().back();
  setting.tuning.substeps = 16;
  setting.tuning.position_sweeps = 4;
  check_stack(setting, 0.03f, 0.3f);
}

template <int D>
static void check_chain() {
  for (const Setting& setting : method_settings()) {
    World<D> world = make_world(def_with<D>(setting.tuning));
    BodyDef<D> fixed;
    fixed.kind = BodyKind::kStatic;
    BodyId above = world.create_body(fixed, {}).value();
    std::vector<JointId> joints;
    for (int i = 0; i < 10; ++i) {
      const BodyId link =
          add_at<D>(world, at<D>(0.0f, -0.4f * static_cast<float>(i) - 0.2f), ball<D>(0.15f));
      JointDef<D> def;
      def.body_a = above;
      def.body_b = link;
      def.anchor_a = at<D>(0.0f, i == 0 ? 0.0f : -0.2f);
      def.anchor_b = at<D>(0.0f, 0.2f);
      joints.push_back(world.create_joint(def).value());
      above = link;
    }
    ASSERT_TRUE(world.set_velocity(above, at<D>(0.5f, 0.0f), Spin<D>::zero()).ok());
    for (int i = 0; i < 300; ++i) {
      step(world, 1);
      // From nothing it takes some ticks to find the weight. A soft joint of one substep is held to
      // 15 Hz and hangs 20 mm low under nine links.
      const float late = soft_at_60_hertz(setting) ? 0.025f : 0.005f;
      for (const JointId id : joints)
        ASSERT_LT(world.joint_separation(id).value(), i < 60 ? std::max(late, 0.006f) : late)
            << setting.name << " tick " << i << " joint " << id.index << " in " << D;
    }
    EXPECT_GT(view(world, above).position[1], -3.95f) << setting.name;
  }
}

TEST(Methods, EachHoldsAHangingChainOfTen) {
  check_chain<2>();
  check_chain<3>();
}

// Baumgarte's bias leaves as speed, beta (d - slop) / h; pseudo-velocities and NGS leave none.
TEST(Methods, OverlapLeavesWithBaumgartesSpeedOrWithNone) {
  for (const Setting& setting : method_settings()) {
    World<2> world = make_world(def_with<2>(setting.tuning));
    ASSERT_TRUE(world.set_gravity({{0.0f, 0.0f}}).ok());
    add_ground<2>(world, up<2>());
    const BodyId id = add_at<2>(world, {{0.0f, 0.45f}}, box(0.5f, 0.5f));
    step(world, 120);
    const Stabilisation how = setting.tuning.stabilisation;
    const BodyView<2> now = view(world, id);
    if (how == Stabilisation::kBaumgarte) {
      const float expected = 0.2f * (0.05f - 0.005f) / kTick;
      EXPECT_NEAR(now.velocity[1], expected, 0.01f * expected) << setting.name;
    }
    if (how == Stabilisation::kSplitImpulse || how == Stabilisation::kNgs) {
      EXPECT_NEAR(now.velocity[1], 0.0f, 1.0e-6f) << setting.name;
      EXPECT_NEAR(now.position[1], 0.495f, 0.001f) << setting.name;
    }
    EXPECT_GT(now.position[1], 0.49f) << setting.name;
  }
}

/// Two balls of one mass, one on the other: between them a spring of 30 Hz on half the mass, under
/// them one of 60 Hz on the mass.
template <int D>
static void check_springs() {
  Tuning tuning = Tuning::soft_step();
  tuning.sleep_s = 0.0f;
  World<D> world = make_world(def_with<D>(tuning));
  add_ground<D>(world, up<D>());
  const BodyId lower = add_at<D>(world, at<D>(0.0f, 0.5f), ball<D>(0.5f));
  const BodyId upper = add_at<D>(world, at<D>(0.0f, 1.5f), ball<D>(0.5f));
  step(world, 600);
  constexpr float kOmega = 6.2831853f * 30.0f;
  const float under = 0.5f - view(world, lower).position[1];
  const float between = 1.5f - view(world, upper).position[1] - under;
  EXPECT_NEAR(under, 2.0f * 10.0f / (4.0f * kOmega * kOmega), 1.0e-5f);
  EXPECT_NEAR(between, 10.0f / (0.5f * kOmega * kOmega), 3.0e-5f);
}

// No slop comes on top: what a spring holds is in touch because it is loaded.
TEST(SoftStep, LetsContactsOverlapByTheirLoadAlone) {
  check_springs<2>();
  check_springs<3>();
}

TEST(Ngs, ChangesNoBitOfASatisfiedState) {
  for (const Setting& setting : method_settings()) {
    if (setting.tuning.stabilisation != Stabilisation::kNgs) continue;
    World<2> world = make_world(def_with<2>(setting.tuning));
    ASSERT_TRUE(world.set_gravity({{0.0f, 0.0f}}).ok());
    add_ground<2>(world, up<2>());
    // Overlaps by less than the slop.
    const BodyId rests = add_at<2>(world, {{0.1f, 0.497f}}, box(0.5f, 0.5f));
    const BodyId hangs = add_at<2>(world, {{0.1f, 1.997f}}, box(0.5f, 0.5f));
    JointDef<2> def;
    def.body_a = rests;
    def.body_b = hangs;
    def.anchor_a = {{0.0f, 0.75f}};
    def.anchor_b = {{0.0f, -0.75f}};
    def.limit_enabled = true;
    def.lower = -0.5f;
    def.upper = 0.5f;
    ASSERT_TRUE(world.create_joint(def).ok());
    const std::vector<BodyView<2>> before = world.bodies();
    step(world, 10);
    EXPECT_EQ(world.statistics().contacts, 1u);
    const std::vector<BodyView<2>> after = world.bodies();
    for (std::size_t i = 0; i < before.size(); ++i) {
      for (int k = 0; k < 2; ++k) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(after[i].position[k]),
                  std::bit_cast<std::uint32_t>(before[i].position[k]))
            << setting.name << " body " << i;
        EXPECT_EQ(after[i].rotation[k], before[i].rotation[k]) << setting.name;
      }
    }
  }
}

/// A pile of boxes and balls on a chain, with pinned and sprung pairs.
static std::uint64_t digest_of_pile(const Tuning& tuning, int workers, int lanes) {
  World<2> world = make_world(def_with<2>(tuning, {0.5f, 0.2f, 0.05f}));
  EXPECT_TRUE(world.set_workers(workers).ok());
  EXPECT_TRUE(world.set_lanes(lanes).ok());
  add_ground<2>(world, up<2>());
  std::vector<BodyId> ids;
  for (int i = 0; i < 40; ++i) {
    const Vec<2> p = {{0.9f * static_cast<float>(i % 8) + 0.03f * static_cast<float>(i / 8),
                       0.6f + 1.05f * static_cast<float>(i / 8)}};
    ids.push_back(add_at<2>(world, p, i % 3 == 0 ? ball<2>(0.4f) : box(0.4f, 0.35f)));
  }
  for (std::size_t i = 0; i + 8 < ids.size(); i += 5) {
    JointDef<2> def;
    def.kind = i % 2 == 0 ? JointKind::kRevolute : JointKind::kDistance;
    def.body_a = ids[i];
    def.body_b = ids[i + 8];
    def.anchor_a = {{0.0f, 0.5f}};
    def.anchor_b = {{-0.03f, -0.55f}};
    def.length = 0.5f;
    def.hertz = i % 2 == 0 ? 0.0f : 3.0f;
    EXPECT_TRUE(world.create_joint(def).ok());
  }
  step(world, 90);
  return world.digest();
}

static void check_bits(const Setting& setting) {
  const std::uint64_t expected = digest_of_pile(setting.tuning, 1, 1);
  for (const auto& [workers, lanes] :
       {std::pair{1, 4}, {1, 8}, {1, 16}, {2, 4}, {3, 8}, {3, 1}, {2, 16}})
    EXPECT_EQ(digest_of_pile(setting.tuning, workers, lanes), expected)
        << setting.name << " order " << static_cast<int>(setting.tuning.order) << " workers "
        << workers << " lanes " << lanes;
}

static bool pairs_normals(const Setting& setting) {
  return setting.tuning.contact_block == ContactBlockRows::kNormals;
}

TEST(Methods, EachGivesTheSameBitsOverWorkersAndLanes) {
  for (const Setting& setting : method_settings())
    if (!pairs_normals(setting)) check_bits(setting);
}

TEST(Methods, EachGivesTheSameBitsInEveryOrderOverWorkersAndLanes) {
  for (Setting setting : method_settings()) {
    if (pairs_normals(setting)) continue;
    std::vector<std::uint64_t> digests;
    for (const Order order : {Order::kId, Order::kReverse}) {
      setting.tuning.order = order;
      check_bits(setting);
      digests.push_back(digest_of_pile(setting.tuning, 1, 1));
    }
    EXPECT_NE(digests[0], digests[1]) << setting.name;
  }
}

TEST(BlockSolver, GivesTheSameBitsOverWorkersAndLanesWithFrictionToo) {
  for (Setting setting : method_settings()) {
    setting.tuning.contact_block = ContactBlockRows::kNormalFriction;
    if (setting.tuning.stabilisation == Stabilisation::kXpbd) continue;  // Has no such rows.
    for (const Order order : {Order::kColor, Order::kId, Order::kReverse}) {
      setting.tuning.order = order;
      check_bits(setting);
    }
  }
}

TEST(BlockSolver, GivesTheSameBitsOverWorkersAndLanes) {
  for (Setting setting : method_settings()) {
    setting.tuning.contact_block = ContactBlockRows::kNormals;
    if (setting.tuning.stabilisation == Stabilisation::kXpbd) continue;  // Has no such rows.
    for (const Order order : {Order::kColor, Order::kId, Order::kReverse}) {
      setting.tuning.order = order;
      check_bits(setting);
    }
  }
}

/// Where a box on its corner is after a tick, in one block with a box on its side.
static BodyView<2> box_on_its_corner(ContactBlockRows together, int lanes) {
  Tuning tuning = Tuning::pgs_ngs_block();
  tuning.contact_block = together;
  World<2> world = make_world(def_with<2>(tuning));
  EXPECT_TRUE(world.set_lanes(lanes).ok());
  add_ground<2>(world, up<2>());
  add_at<2>(world, {{-3.0f, 0.5f}}, box(0.5f, 0.5f));
  BodyDef<2> def;
  def.position = {{0.0f, 0.67f}};
  def.rotation = turned(0.5f);
  def.velocity = {{0.0f, -1.0f}};
  const BodyId id = add(world, def, box(0.5f, 0.5f));
  step(world, 1);
  EXPECT_EQ(world.state().contacts.size(), 2u);
  EXPECT_EQ(world.state().contacts[1].point_count, 1u);
  return view(world, id);
}

TEST(BlockSolver, APointAloneIsSolvedAloneWhateverSharesItsLanes) {
  for (const ContactBlockRows together :
       {ContactBlockRows::kNone, ContactBlockRows::kNormals, ContactBlockRows::kNormalFriction}) {
    const BodyView<2> alone = box_on_its_corner(together, 1);
    const BodyView<2> beside = box_on_its_corner(together, 4);
    EXPECT_EQ(alone.velocity[1], beside.velocity[1]) << static_cast<int>(together);
    EXPECT_EQ(alone.spin[0], beside.spin[0]) << static_cast<int>(together);
  }
}

TEST(SetTuning, OfOtherSubstepsMovesNoStackAtRest) {
  Tuning tuning = Tuning::soft_step();
  tuning.sleep_s = 0.0f;
  World<2> world = make_world(def_with<2>(tuning));
  add_ground<2>(world, up<2>());
  const std::vector<BodyId> boxes = add_stack(world, 5);
  step(world, 600);
  // From 4 on a contact has its 30 Hz, so the stack has the same place to rest at.
  for (const std::uint32_t substeps : {8u, 4u, 16u, 4u}) {
    ASSERT_TRUE(world.set_tuning(tuning.in_substeps(substeps)).ok());
    for (int i = 0; i < 60; ++i) {
      step(world, 1);
      for (const BodyId id : boxes)
        ASSERT_LT(length(view(world, id).velocity), 0.001f) << substeps << " tick " << i;
    }
  }
}

// Also more than half a turn in a substep, of which a rotation does not tell the rounds.
template <int D>
static void check_free_spin(const Setting& setting, float speed) {
  WorldDef<D> world_def;
  world_def.tuning = setting.tuning;
  World<D> world = make_world(world_def);
  BodyDef<D> def;
  def.spin[Dim<D>::kSpin - 1] = speed;
  const BodyId id = add(world, def, ball<D>(0.2f));
  step(world, 30);
  EXPECT_EQ(length(view(world, id).spin - def.spin), 0.0f)
      << setting.name << " in " << D << "D at " << speed;
}

TEST(Methods, AFreeBallKeepsItsSpinAtAnySpeedUnderEach) {
  for (const Setting& setting : method_settings())
    for (const float speed : {1.0f, 500.0f, 2000.0f, 50000.0f}) {
      check_free_spin<2>(setting, speed);
      check_free_spin<3>(setting, speed);
    }
}

}  // namespace cycloid::solver
