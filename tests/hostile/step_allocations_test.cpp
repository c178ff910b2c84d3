#include <gtest/gtest.h>

#include "scenes/catalogue.hpp"
#include "scenes/scene.hpp"
#include "scenes/simulation.hpp"
#include "tests/hostile/allocations.hpp"

namespace cycloid::hostile {

constexpr int kPlayedTicks = 200;

/// What a seat says by the script of a scene, but for the buttons that make bodies: those are edits
/// of the world, not steps.
scenes::SeatInput without_spawns(const scenes::Scene& scene, int seat, scenes::SeatInput input) {
  for (const scenes::Control& control : scene.seats[static_cast<std::size_t>(seat)].controls)
    if (control.effect == scenes::Effect::kSpawn)
      input.buttons &= static_cast<std::uint16_t>(~(1u << (control.index & 15u)));
  return input;
}

/// What all seats say in each of the ticks to come.
std::vector<std::vector<scenes::SeatInput>> script_of(const scenes::Scene& scene,
                                                      const scenes::Simulation& simulation) {
  std::vector<std::vector<scenes::SeatInput>> script(kPlayedTicks);
  for (std::size_t i = 0; i < script.size(); ++i)
    for (int seat = 0; seat < simulation.seats(); ++seat)
      script[i].push_back(without_spawns(
          scene, seat, scenes::scripted_input(scene, seat, simulation.tick() + i + 1)));
  return script;
}

/// Ask the world by queries, which return vectors, before each step.
bool has_characters(const scenes::Simulation& simulation) {
  return !simulation.characters().empty();
}

/// Bytes that the ticks of a script take anew; where there are characters, nobody moves them.
std::size_t allocated_bytes(const std::vector<std::vector<scenes::SeatInput>>& script,
                            scenes::Simulation& simulation) {
  const bool steps_bare = has_characters(simulation);
  reset_allocations();
  for (const auto& inputs : script) {
    if (!steps_bare) {
      EXPECT_TRUE(simulation.step(inputs).ok());
    } else if (simulation.planar() != nullptr) {
      EXPECT_TRUE(simulation.planar()->step().ok());
    } else {
      EXPECT_TRUE(simulation.spatial()->step().ok());
    }
  }
  return allocations().total_bytes;
}

/// The second time through the same ticks nothing is larger than it has been: contacts, pairs,
/// islands and colours come and go, and no step asks for memory.
std::size_t allocated_the_second_time(const scenes::Scene& scene, scenes::Simulation& simulation) {
  scenes::Simulation::Saved start;
  simulation.save(start);
  const auto script = script_of(scene, simulation);
  EXPECT_GT(allocated_bytes(script, simulation), 0u) << "the first time memory is taken";
  const std::uint64_t digest = simulation.digest();
  simulation.restore(start);
  const std::size_t bytes = allocated_bytes(script, simulation);
  EXPECT_EQ(simulation.digest(), digest);
  return bytes;
}

TEST(StepAllocations, AreNoneInAnySceneOnceItsMemoryIsThere) {
  for (const scenes::CatalogueEntry& entry : scenes::catalogue()) {
    const scenes::Loaded loaded = scenes::find(entry.name);
    ASSERT_TRUE(loaded.scene) << entry.name;
    auto simulation = scenes::Simulation::create(*loaded.scene);
    ASSERT_TRUE(simulation.ok()) << entry.name;
    EXPECT_EQ(allocated_the_second_time(*loaded.scene, simulation.value()), 0u) << entry.name;
  }
}

TEST(StepAllocations, AreNoneInSmallRoomsThatShareTheirMemory) {
  const scenes::StepMemories memories;
  for (const char* name :
       {"room:bodies=200", "room:bodies=20", "pyramid:base=5", "room:bodies=60"}) {
    const scenes::Loaded loaded = scenes::find(name);
    ASSERT_TRUE(loaded.scene) << name;
    for (const int lanes : {1, 4, 8, 16}) {
      auto simulation = scenes::Simulation::create(*loaded.scene);
      ASSERT_TRUE(simulation.ok()) << name;
      simulation.value().use_step_memory(memories);
      ASSERT_TRUE(simulation.value().set_lanes(lanes).ok());
      simulation.value().set_lot_contacts(static_cast<std::uint32_t>(lanes));
      scenes::Simulation::Saved start;
      simulation.value().save(start);
      const auto script = script_of(*loaded.scene, simulation.value());
      allocated_bytes(script, simulation.value());
      simulation.value().restore(start);
      EXPECT_EQ(allocated_bytes(script, simulation.value()), 0u) << name << ", lanes " << lanes;
    }
  }
}

/// What an idle room holds beside the memory that all share.
TEST(StepAllocations, OfAnIdleRoomOf60BodiesAreAtMost60Kilobytes) {
  const scenes::StepMemories memories;
  const scenes::Loaded loaded = scenes::find("room:bodies=60");
  ASSERT_TRUE(loaded.scene);
  constexpr std::size_t kRooms = 20;
  std::vector<scenes::Simulation> rooms;
  rooms.reserve(kRooms + 1);
  const auto play_one_more = [&] {
    auto simulation = scenes::Simulation::create(*loaded.scene);
    ASSERT_TRUE(simulation.ok());
    simulation.value().use_step_memory(memories);
    for (const auto& inputs : script_of(*loaded.scene, simulation.value()))
      ASSERT_TRUE(simulation.value().step(inputs).ok());
    rooms.push_back(std::move(simulation.value()));
  };
  play_one_more();
  reset_allocations();
  for (std::size_t i = 0; i < kRooms; ++i) play_one_more();
  EXPECT_LE(allocations().live_bytes / kRooms, 60'000u);
}

}  // namespace cycloid::hostile
