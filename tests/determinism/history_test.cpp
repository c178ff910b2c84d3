#include <random>

#include "solver/queries/query.hpp"
#include "tests/determinism/scene_test.hpp"

namespace cycloid::history {
namespace {

/// What a world went through between two states does not show in the second.
class History : public SceneTest {};

/// Seat inputs that the script never says, so that a run goes another way.
std::vector<SeatInput> wrong_inputs(const Simulation& simulation) {
  return std::vector<SeatInput>(static_cast<std::size_t>(simulation.seats()),
                                SeatInput{{-32767, 20000, -9999, 1}, 0xffff});
}

// Before each restore the two worlds are sent another way, so that what they keep between ticks
// for its memory (trees, lists, scratch) is that of a state which the restored one never had.
TEST_P(History, RestoredAtEveryTickFromMemoryAndFromBytesItGoesOnAsItWas) {
  constexpr int kTicks = 120;
  const Scene scene = this->scene();
  Simulation run = begin(scene);
  Simulation from_memory = begin(scene);
  Simulation from_bytes = begin(scene);
  set_up(from_bytes, 2, 8);
  Simulation::Saved saved;
  std::vector<std::byte> bytes;
  for (int tick = 0; tick < kTicks; ++tick) {
    run.save(saved);
    run.encode(bytes);
    from_memory.restore(saved);
    ASSERT_TRUE(from_bytes.decode(bytes).ok()) << "tick " << tick;
    for (const Simulation* other : {&from_memory, &from_bytes})
      ASSERT_EQ(run.digest(), other->digest())
          << "restored at " << tick << ": " << first_difference(run, *other);
    play(scene, run);
    for (Simulation* other : {&from_memory, &from_bytes}) {
      play(scene, *other);
      ASSERT_EQ(run.digest(), other->digest())
          << "restored at " << tick << ", one tick on: " << first_difference(run, *other);
      if (tick % 3 == 0) {
        ASSERT_TRUE(other->step(wrong_inputs(*other)).ok());
      }
    }
  }
}

// A recording: a keyframe now and then, and any tick found from the nearest one before it.
TEST_P(History, SeeksFromKeyframesToAnyTickInAnyOrder) {
  constexpr std::size_t kTicks = 96;
  constexpr std::size_t kKeyframeTicks = 16;
  const Scene scene = this->scene();
  Simulation run = begin(scene);
  std::vector<std::uint64_t> digests;
  std::vector<std::vector<std::byte>> keyframes;
  for (std::size_t tick = 0; tick <= kTicks; ++tick) {
    if (tick % kKeyframeTicks == 0) run.encode(keyframes.emplace_back());
    digests.push_back(run.digest());
    play(scene, run);
  }
  std::mt19937 random(5);
  Simulation viewer = begin(scene);
  for (int seek = 0; seek < 24; ++seek) {
    const std::size_t tick = random() % (kTicks + 1);
    ASSERT_TRUE(viewer.decode(keyframes[tick / kKeyframeTicks]).ok());
    play(scene, viewer, tick % kKeyframeTicks);
    ASSERT_EQ(viewer.digest(), digests[tick]) << "seek to " << tick;
  }
  // And from each keyframe to the end, at which the errors of all ticks would have added up.
  for (std::size_t i = 0; i < keyframes.size(); i += 2) {
    ASSERT_TRUE(viewer.decode(keyframes[i]).ok());
    play(scene, viewer, kTicks - i * kKeyframeTicks);
    ASSERT_EQ(viewer.digest(), digests[kTicks]) << "from " << i * kKeyframeTicks << " to the end";
  }
}

template <int D>
void query(const solver::World<D>& world) {
  solver::Vec<D> from = solver::Vec<D>::zero();
  solver::Vec<D> to = solver::Vec<D>::zero();
  from[1] = 20.0f;
  to[0] = 1.5f;
  to[1] = -20.0f;
  solver::Probe<D> probe;
  probe.radius = 0.5f;
  const solver::Pose<D> pose{to, solver::identity_rotation<D>()};
  (void)solver::ray_cast(world.state(), from, to, {});
  (void)solver::ray_cast_first(world.state(), from, to, {});
  (void)solver::overlap(world.state(), probe, pose, 10.0f, {});
  (void)solver::shape_cast(world.state(), probe, pose, from - to, {});
  (void)solver::closest_point(world.state(), from, 100.0f, {});
}

/// Every call of a world that says it changes nothing.
template <int D>
void look_into(const solver::World<D>& world) {
  for (const solver::BodyView<D>& body : world.bodies()) (void)world.body(body.id);
  (void)world.body(solver::BodyId{});
  (void)world.contains(solver::BodyId{0, 0});
  (void)world.body_count();
  for (std::uint32_t i = 0; i < world.state().joints.size(); ++i) {
    (void)world.joint_angle({i, world.state().joints[i].generation});
    (void)world.joint_separation({i, world.state().joints[i].generation});
  }
  (void)world.contact_events();
  (void)world.registers();
  (void)world.tuning();
  solver::WorldState<D> saved;
  world.save(saved);
  query(world);
}

/// The same of a simulation, and of its world.
void look(Simulation& simulation) {
  (void)simulation.poses();
  (void)simulation.characters();
  (void)simulation.statistics();
  (void)simulation.fault();
  (void)simulation.differences(simulation, 5);
  std::vector<std::byte> bytes;
  simulation.encode(bytes);
  Simulation::Saved saved;
  simulation.save(saved);
  if (simulation.planar() != nullptr) look_into(*simulation.planar());
  if (simulation.spatial() != nullptr) look_into(*simulation.spatial());
}

// One run is looked at from all sides in every tick, the others are stepped blindly in pieces of
// any length: a replay at 1, 7 and 60 times its speed.
TEST_P(History, LooksAndReplaySpeedAreInvisible) {
  constexpr int kTicks = 120;
  const Scene scene = this->scene();
  Simulation seen = begin(scene);
  std::vector<std::uint64_t> digests = {seen.digest()};
  for (int tick = 0; tick < kTicks; ++tick) {
    look(seen);
    ASSERT_EQ(seen.digest(), digests.back()) << "a look changed tick " << tick;
    play(scene, seen);
    digests.push_back(seen.digest());
  }
  for (const std::uint64_t speed : {7u, 60u, 120u}) {
    Simulation blind = begin(scene);
    while (blind.tick() < kTicks) {
      play(scene, blind, std::min(speed, kTicks - blind.tick()));
      ASSERT_EQ(blind.digest(), digests[blind.tick()])
          << "speed " << speed << " at " << blind.tick();
    }
    EXPECT_EQ(first_difference(seen, blind), "equal to the bit");
  }
}

// The state goes from one simulation to the next, and each is moved before it steps.
TEST_P(History, CarriedThroughOtherSimulationsItGoesOnAsItWas) {
  const Scene scene = this->scene();
  Simulation stays = begin(scene);
  std::vector<Simulation> bearers;
  for (const int lanes : {1, 16, 8}) set_up(bearers.emplace_back(begin(scene)), 1, lanes);
  for (Simulation& bearer : bearers) play(scene, bearer, 7);  // None of them is fresh.
  Simulation::Saved saved;
  begin(scene).save(saved);  // What it was saved from is gone.
  for (std::size_t tick = 0; tick < 90; ++tick) {
    Simulation& bearer = bearers[tick % bearers.size()];
    bearer.restore(saved);
    Simulation moved = std::move(bearer);
    play(scene, moved);
    moved.save(saved);
    bearer = std::move(moved);
    play(scene, stays);
    ASSERT_EQ(stays.statistics().rows, bearer.statistics().rows) << "tick " << stays.tick();
    ASSERT_EQ(stays.digest(), bearer.digest())
        << "tick " << stays.tick() << ": " << first_difference(stays, bearer);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, History, testing::ValuesIn(scene_names()), scene_test_name);

/// The digests of so many ticks of a scene in a new world, which lives on in `alive`.
std::vector<std::uint64_t> digests_in_new_world(const std::string& name,
                                                std::vector<Simulation>& alive) {
  const Scene scene = std::move(*scenes::find(name).scene);
  Simulation simulation = begin(scene);
  std::vector<std::uint64_t> digests = {simulation.digest()};
  for (int tick = 0; tick < 12; ++tick) {
    play(scene, simulation);
    digests.push_back(simulation.digest());
  }
  alive.push_back(std::move(simulation));
  return digests;
}

TEST(ProcessHistory, ScenesRunBeforeAndAliveAreInvisible) {
  const std::vector<std::string> names = scene_names();
  std::vector<std::vector<std::uint64_t>> forward;
  std::vector<Simulation> alive;
  for (const std::string& name : names) forward.push_back(digests_in_new_world(name, alive));
  for (std::size_t i = names.size(); i-- > 0;)
    EXPECT_EQ(digests_in_new_world(names[i], alive), forward[i]) << names[i];
  for (std::size_t i = 0; i < names.size(); ++i)
    EXPECT_EQ(first_difference(alive[i], alive[2 * names.size() - 1 - i]), "equal to the bit")
        << names[i];
}

}  // namespace
}  // namespace cycloid::history
