#include "solver/trace.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <set>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {
namespace {

/// A box that slides over the ground, so that there is a contact with friction.
World<2> sliding_box() {
  World<2> world = make_world<2>(with_gravity<2>());
  BodyDef<2> ground;
  ground.kind = BodyKind::kStatic;
  add(world, ground, box(10.0f, 0.5f));
  BodyDef<2> moving;
  moving.position = {{0.0f, 0.99f}};
  moving.velocity = {{3.0f, 0.0f}};
  add(world, moving, box(0.5f, 0.5f));
  return world;
}

TEST(Trace, NamesEveryPhaseOnce) {
  std::set<std::string> names;
  for (std::uint32_t i = 0; i < kPhases; ++i) names.insert(phase_name(Phase(i)));
  EXPECT_EQ(names.size(), kPhases);
  EXPECT_FALSE(names.contains("unknown"));
  EXPECT_STREQ(phase_name(Phase(kPhases)), "unknown");
}

TEST(Trace, HasEverySubstepAndSweepInOrder) {
  World<2> world = sliding_box();
  StepTrace trace;
  ASSERT_TRUE(world.step_traced(trace).ok());
  const Tuning& tuning = world.tuning();
  std::vector<TracePoint> expected;
  for (const Phase phase : {Phase::kForces, Phase::kPairs, Phase::kCollide, Phase::kIslands,
                            Phase::kColors, Phase::kPrepare, Phase::kEvaluate})
    expected.push_back({phase, kNone, kNone});
  for (std::uint32_t substep = 0; substep < tuning.substeps; ++substep) {
    for (const Phase phase : {Phase::kVelocities, Phase::kBounce, Phase::kWarmStart})
      expected.push_back({phase, substep, kNone});
    for (std::uint32_t sweep = 0; sweep < tuning.sweeps; ++sweep)
      expected.push_back({Phase::kSweep, substep, sweep});
    expected.push_back({Phase::kPositions, substep, kNone});
    expected.push_back({Phase::kEvaluate, substep, kNone});
    for (std::uint32_t sweep = 0; sweep < tuning.relax_sweeps; ++sweep)
      expected.push_back({Phase::kRelax, substep, sweep});
  }
  for (const Phase phase : {Phase::kStore, Phase::kStop, Phase::kFinalize, Phase::kRest})
    expected.push_back({phase, kNone, kNone});
  std::vector<TracePoint> found;
  for (const TracedPhase& phase : trace.phases) found.push_back(phase.at);
  EXPECT_EQ(found, expected);
}

TEST(Trace, HoldsObjectsAndFieldsOnlyWhereTheyAreWanted) {
  World<2> world = sliding_box();
  StepTrace plain;
  ASSERT_TRUE(world.step_traced(plain).ok());
  for (const TracedPhase& phase : plain.phases) {
    EXPECT_TRUE(phase.objects.empty());
    EXPECT_TRUE(phase.fields.empty());
  }
  StepTrace trace;
  trace.wants_objects = true;
  trace.wants_fields = "contact 0";
  ASSERT_TRUE(world.step_traced(trace).ok());
  for (const TracedPhase& phase : trace.phases) {
    if (phase.at.phase != Phase::kSweep) continue;
    ASSERT_EQ(phase.objects.size(), 3u);
    EXPECT_EQ(phase.objects[0].name, "contact 0");
    EXPECT_EQ(phase.objects[1].name, "body 0");
    EXPECT_EQ(phase.objects[2].name, "body 1");
    std::set<std::string> names;
    for (const TracedField& field : phase.fields) names.insert(field.name);
    EXPECT_TRUE(names.contains("points[1].tangent_impulse"));
    EXPECT_TRUE(names.contains("points[0].normal_mass"));
    EXPECT_EQ(phase.fields[0].name, "body_a");
    EXPECT_EQ(phase.fields[0].value, "0 (0x00000000)");
  }
}

/// The lowest bit of a velocity shows in the phase that first reads it, and in none before.
TEST(Trace, DigestsSeeTheLowestBit) {
  World<2> one = sliding_box();
  World<2> other = sliding_box();
  WorldState<2> state;
  other.save(state);
  std::uint32_t bits = std::bit_cast<std::uint32_t>(state.bodies[1].velocity[0]);
  state.bodies.moved(1).velocity[0] = std::bit_cast<float>(bits + 1);
  other.restore(state);
  StepTrace a;
  StepTrace b;
  ASSERT_TRUE(one.step_traced(a).ok());
  ASSERT_TRUE(other.step_traced(b).ok());
  for (std::size_t i = 0; i < a.phases.size(); ++i) {
    const Phase phase = a.phases[i].at.phase;
    const bool differs = a.phases[i].digest != b.phases[i].digest;
    if (phase == Phase::kPairs || phase == Phase::kIslands || phase == Phase::kColors) {
      EXPECT_FALSE(differs) << phase_name(phase);
    }
    if (phase == Phase::kForces || phase == Phase::kPrepare || phase == Phase::kFinalize) {
      EXPECT_TRUE(differs) << phase_name(phase);
    }
  }
}

TEST(Trace, OfAStepThatFaultsEndsWhereItFaults) {
  World<2> world = sliding_box();
  const BodyId box_id = world.bodies()[1].id;
  ASSERT_TRUE(world.apply_force(box_id, {{1.0e11f, 0.0f}}).ok());
  StepTrace trace;
  const Error error = world.step_traced(trace);
  EXPECT_EQ(error.code, Code::kFaulted);
  ASSERT_FALSE(trace.phases.empty());
  EXPECT_EQ(trace.phases.back().at.phase, Phase::kStop);
  // And nobody traces the next one.
  const std::size_t phases = trace.phases.size();
  EXPECT_EQ(world.step().code, Code::kFaulted);
  EXPECT_EQ(trace.phases.size(), phases);
}

TEST(Trace, OfAStateNamesItsObjects) {
  const World<2> world = sliding_box();
  StepTrace trace;
  trace.wants_objects = true;
  trace.wants_fields = "body 1";
  world.trace_state(trace);
  ASSERT_EQ(trace.phases.size(), 1u);
  EXPECT_EQ(trace.phases[0].at.phase, Phase::kState);
  EXPECT_EQ(trace.phases[0].objects[0].name, "world 0");
  EXPECT_THAT(trace.phases[0].fields,
              testing::Contains(TracedField{"body 1", "velocity[0]", "3 (0x40400000)"}));
}

}  // namespace
}  // namespace cycloid::solver
