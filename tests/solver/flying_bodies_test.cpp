#include "solver/trace.hpp"
#include "tests/solver/joint_scene.hpp"

namespace cycloid::solver {

/// Balls that fly about between the bodies below, each otherwise: one drifts, one spins, one is
/// slowed down, one is pushed in each tick. Two on a joint, one at rest on the ground, one that
/// moves without mass and one that does and comes to touch another.
template <int D>
struct FreeFlight {
  World<D> world;
  std::vector<BodyId> flying;
  BodyId pushed;
};

template <int D>
static void add_what_is_held(World<D>& world) {
  add_ground<D>(world, up<D>());
  add_at<D>(world, at<D>(-20.0f, 0.5f), ball<D>(0.5f));
  JointDef<D> rod;
  rod.kind = JointKind::kDistance;
  rod.body_a = add_at<D>(world, at<D>(-30.0f, 20.0f), ball<D>(0.5f));
  rod.body_b = add_at<D>(world, at<D>(-28.0f, 20.0f), ball<D>(0.5f));
  rod.length = 2.0f;
  EXPECT_TRUE(world.create_joint(rod).ok());
  BodyDef<D> mover;
  mover.kind = BodyKind::kKinematic;
  mover.position = at<D>(-22.0f, 0.6f);
  mover.velocity[0] = 3.0f;
  add(world, mover, ball<D>(0.5f));  // Comes to touch the one on the ground.
  mover.position[1] = 40.0f;
  mover.spin[0] = 3.0f;
  add(world, mover, ball<D>(0.5f));
}

template <int D>
static FreeFlight<D> make_free_flight(Tuning tuning) {
  tuning.sleep_s = 0.0f;
  FreeFlight<D> flight{make_world(def_with<D>(tuning)), {}, {}};
  add_what_is_held(flight.world);
  for (int i = 0; i < 23; ++i) {
    BodyDef<D> def;
    def.position = at<D>(3.0f * static_cast<float>(i), 3.0f + static_cast<float>(i % 4));
    def.velocity[0] = 0.1f * static_cast<float>(i % 5);
    def.spin[0] = i % 3 == 0 ? 0.0f : 2.0f * static_cast<float>(i);
    def.linear_damping = i % 4 == 0 ? 0.5f : 0.0f;
    def.angular_damping = i % 4 == 1 ? 0.5f : 0.0f;
    def.gravity_scale = i % 7 == 0 ? -1.0f : 1.0f;
    flight.flying.push_back(add(flight.world, def, ball<D>(0.25f + 0.01f * static_cast<float>(i))));
  }
  flight.pushed = flight.flying[4];
  return flight;
}

template <int D>
static void push(FreeFlight<D>& flight) {
  Spin<D> torque = Spin<D>::zero();
  torque[0] = 0.3f;
  EXPECT_TRUE(flight.world.apply_force(flight.pushed, at<D>(1.0f, 9.0f)).ok());
  EXPECT_TRUE(flight.world.apply_torque(flight.pushed, torque).ok());
}

/// Steps it, and one like it that is watched, in which nobody flies. @returns who flew by tick.
template <int D>
static std::vector<std::uint32_t> flown(const Tuning& tuning, int lanes, int workers) {
  FreeFlight<D> flight = make_free_flight<D>(tuning);
  FreeFlight<D> watched = make_free_flight<D>(tuning);
  EXPECT_TRUE(flight.world.set_lanes(lanes).ok());
  EXPECT_TRUE(flight.world.set_workers(workers).ok());
  std::vector<std::uint32_t> flying;
  for (int tick = 0; tick < 100; ++tick) {
    push(flight);
    push(watched);
    StepTrace trace;
    EXPECT_TRUE(flight.world.step().ok());
    EXPECT_TRUE(watched.world.step_traced(trace).ok());
    EXPECT_EQ(watched.world.statistics().flying, 0u);
    EXPECT_EQ(flight.world.digest(), watched.world.digest()) << "tick " << tick;
    flying.push_back(flight.world.statistics().flying);
  }
  return flying;
}

template <int D>
static void expect_to_fly_as_if_held() {
  for (const int workers : {1, 3})
    for (const int lanes : {0, 1, 4, 8, 16}) {
      const std::vector<std::uint32_t> flying = flown<D>(Tuning{}, lanes, workers);
      EXPECT_EQ(flying[0], 25u);  // And both that have no mass.
      EXPECT_EQ(flying[30], 24u);
      EXPECT_LT(flying[60], 24u);  // Some have come down.
      EXPECT_EQ(flying[99], 0u);   // Too many have.
    }
}

TEST(FlyingBodies, MoveAsWhatIsHeldInThePlane) {
  expect_to_fly_as_if_held<2>();
}

TEST(FlyingBodies, MoveAsWhatIsHeldInSpace) {
  expect_to_fly_as_if_held<3>();
}

TEST(FlyingBodies, MoveSoUnderEveryMethod) {
  for (const Method& method : methods()) {
    SCOPED_TRACE(method.name);
    const bool passes_over_all = method.tuning.stabilisation == Stabilisation::kXpbd;
    EXPECT_EQ(flown<2>(method.tuning, 0, 1)[0], passes_over_all ? 0u : 25u);
    EXPECT_EQ(flown<3>(method.tuning, 0, 1)[0], passes_over_all ? 0u : 25u);
  }
  Tuning split = Tuning::pgs();
  split.stabilisation = Stabilisation::kSplitImpulse;
  EXPECT_EQ(flown<2>(split, 0, 1)[0], 0u);
}

}  // namespace cycloid::solver
