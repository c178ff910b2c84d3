#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cfenv>
#include <thread>
#include <vector>

#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"
#include "solver/floating_point_mode.hpp"
#include "solver/trace.hpp"
#include "solver/world.hpp"
#include "tests/places.hpp"
#include "tests/refusals/reordering_user.hpp"

namespace cycloid::solver {
namespace {

/// Ends with the thread's mode as it was.
class ModeKept {
 public:
  ModeKept() { std::fegetenv(&mode_); }
  ~ModeKept() { back(); }
  ModeKept(const ModeKept&) = delete;
  ModeKept& operator=(const ModeKept&) = delete;
  void back() const { std::fesetenv(&mode_); }

 private:
  std::fenv_t mode_;
};

/// Loads the library that flushes, whose code does so to the thread that loads it.
void load_flushing_library() {
  void* library = dlopen(places::flushing_library().c_str(), RTLD_NOW);
  ASSERT_NE(library, nullptr) << dlerror();
  ASSERT_FALSE(floating_point_mode_is_ieee()) << "this library does not flush";
  dlclose(library);
}

/// A ball that falls.
World<3> falling() {
  WorldDef<3> def;
  def.gravity[1] = -10.0f;
  Result<World<3>> world = World<3>::create(def);
  EXPECT_TRUE(world.ok());
  ShapeDef<3> ball;
  ball.radius = 0.5f;
  BodyDef<3> body;
  EXPECT_TRUE(world.value().create_body(body, std::span(&ball, 1)).ok());
  return std::move(world.value());
}

TEST(Refusals, LibraryThatFlushesIsSeenWhenAWorldIsMade) {
  const ModeKept mode;
  load_flushing_library();
  EXPECT_STREQ(World<2>::create({}).error().field, "floating_point_mode");
  EXPECT_STREQ(World<3>::create({}).error().field, "floating_point_mode");
  mode.back();
  EXPECT_TRUE(World<2>::create({}).ok());
}

TEST(Refusals, StepOnAThreadThatFlushesOrRoundsOtherwiseChangesNothing) {
  const ModeKept mode;
  World<3> world = falling();
  World<3> undisturbed = falling();
  const auto expect_refused = [&] {
    const std::uint64_t digest = world.digest();
    const Error error = world.step();
    EXPECT_EQ(error.code, Code::kInvalid);
    EXPECT_STREQ(error.field, "floating_point_mode");
    EXPECT_EQ(world.digest(), digest);
    EXPECT_FALSE(world.fault().has_value());
  };
  for (const int rounding : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    std::fesetround(rounding);
    expect_refused();
    mode.back();
    EXPECT_TRUE(world.step().ok());
    EXPECT_TRUE(undisturbed.step().ok());
  }
  load_flushing_library();
  expect_refused();
  mode.back();
  EXPECT_TRUE(world.step().ok());
  EXPECT_TRUE(undisturbed.step().ok());
  EXPECT_EQ(world.tick(), 4u);
  EXPECT_EQ(world.digest(), undisturbed.digest());
}

TEST(Refusals, PoolOfThreadsIsNotMadeWhereItsThreadsWouldInheritTheMode) {
  const ModeKept mode;
  World<3> world = falling();
  load_flushing_library();
  bool inherited = false;
  std::thread([&] { inherited = !floating_point_mode_is_ieee(); }).join();
  EXPECT_TRUE(inherited) << "a new thread has a mode of its own here; set_workers need not ask";
  EXPECT_STREQ(world.set_workers(4).field, "floating_point_mode");
  mode.back();
  EXPECT_TRUE(world.set_workers(4).ok());
}

TEST(Refusals, PoolMadeBeforeGoesOnAsItWasWhenTheThreadIsMended) {
  const ModeKept mode;
  const scenes::Scene scene = *scenes::find("pyramid-20").scene;
  auto pooled = scenes::Simulation::create(scene);
  auto alone = scenes::Simulation::create(scene);
  ASSERT_TRUE(pooled.ok() && alone.ok());
  ASSERT_TRUE(pooled.value().set_workers(4).ok());
  const std::vector<scenes::SeatInput> inputs(static_cast<std::size_t>(alone.value().seats()));
  for (int tick = 0; tick < 20; ++tick) {
    if (tick % 5 == 0) {
      load_flushing_library();
      EXPECT_STREQ(pooled.value().step(inputs).field, "floating_point_mode");
      mode.back();
    }
    ASSERT_TRUE(pooled.value().step(inputs).ok());
    ASSERT_TRUE(alone.value().step(inputs).ok());
    EXPECT_EQ(pooled.value().digest(), alone.value().digest()) << "tick " << tick;
  }
}

TEST(Refusals, StepOfASceneThatIsTracedIsRefusedBeforeItsControls) {
  const ModeKept mode;
  auto created = scenes::Simulation::create(*scenes::find("half-pipe").scene);
  ASSERT_TRUE(created.ok());
  scenes::Simulation& simulation = created.value();
  std::vector<scenes::SeatInput> inputs(static_cast<std::size_t>(simulation.seats()));
  for (scenes::SeatInput& input : inputs) input = {{32767, 32767, 32767, 32767}, 0xffff};
  const std::uint64_t digest = simulation.digest();
  StepTrace trace;
  load_flushing_library();
  EXPECT_STREQ(simulation.step_traced(inputs, trace).field, "floating_point_mode");
  EXPECT_STREQ(simulation.step(inputs).field, "floating_point_mode");
  mode.back();
  EXPECT_EQ(simulation.digest(), digest);
  EXPECT_TRUE(simulation.step_traced(inputs, trace).ok());
  EXPECT_NE(simulation.digest(), digest);
}

TEST(Refusals, CallerWhoseFlagsReorderSumsIsSeenWhenAWorldIsMade) {
  EXPECT_STREQ(field_refused_to_a_reordering_user(), "floating_point_flags");
}

}  // namespace
}  // namespace cycloid::solver
