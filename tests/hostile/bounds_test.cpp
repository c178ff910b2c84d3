#include <gtest/gtest.h>

#include "tests/hostile/allocations.hpp"
#include "tests/hostile/matches.hpp"
#include "tests/hostile/snapshot_checks.hpp"
#include "tests/hostile/worlds.hpp"

namespace cycloid::hostile {
namespace {

/// The bound that docs/protocol.md states: what lives at once while n bytes are read.
struct Bound {
  std::size_t per_byte;
  std::size_t fixed_bytes;
};

template <class Read>
void expect_within(const Bound& bound, std::size_t bytes, const std::string& what, Read&& read) {
  reset_allocations();
  read();
  const Allocations used = allocations();
  const std::size_t most = bound.per_byte * bytes + bound.fixed_bytes;
  std::printf("%-34s %9zu bytes: peak %10zu, largest %10zu, total %10zu\n", what.c_str(), bytes,
              used.peak_bytes, used.largest_bytes, used.total_bytes);
  EXPECT_LE(used.peak_bytes, most) << what;
  EXPECT_GT(used.total_bytes, 0u) << what;
}

constexpr Bound kOfLogs{16, 4096};
constexpr Bound kOfSnapshots{8, 4096};
constexpr Bound kOfBinaryScenes{512, 1u << 20};
constexpr Bound kOfTextScenes{512, 1u << 20};

TEST(AllocationBounds, OfALog) {
  const Match match = played("vehicle", 50);
  expect_within(kOfLogs, match.log.size(), "a log", [&] { (void)protocol::scan_log(match.log); });
  // The most ticks in the fewest bytes: no seats.
  protocol::Bytes empty;
  protocol::LogEncoder encoder({}, empty);
  for (std::uint64_t tick = 1; tick <= 30000; ++tick) {
    protocol::LogTick record;
    record.frame.tick = tick;
    encoder.tick(record, empty);
  }
  expect_within(kOfLogs, empty.size(), "a log without seats",
                [&] { (void)protocol::scan_log(empty); });
  protocol::Bytes events;
  protocol::LogEncoder other({}, events);
  for (std::uint64_t tick = 1; tick <= 100; ++tick) {
    protocol::LogTick record;
    record.frame.tick = tick;
    record.frame.seats.resize(1);
    record.frame.events.resize(protocol::kFrameEventsMax);
    other.tick(record, events);
  }
  expect_within(kOfLogs, events.size(), "a log of events",
                [&] { (void)protocol::scan_log(events); });
}

/// A few bytes a tick that stand for 256 seats, a long state, the most keyframes in the fewest
/// bytes, and damage that has to be searched.
TEST(AllocationBounds, OfALogThatStandsForMuch) {
  protocol::Bytes seats;
  protocol::LogEncoder encoder({}, seats);
  for (std::uint64_t tick = 1; tick <= 5000; ++tick) {
    protocol::LogTick record;
    record.frame.tick = tick;
    record.frame.seats.resize(256);
    encoder.tick(record, seats);
  }
  expect_within(kOfLogs, seats.size(), "a log of 256 seats",
                [&] { (void)protocol::scan_log(seats); });
  protocol::Bytes states;
  protocol::LogEncoder other({}, states);
  other.first_keyframe({0, 0, {}, protocol::Bytes(1 << 20)}, states);
  for (int i = 0; i < 10000; ++i) other.first_keyframe({0, 0, {}, {}}, states);
  expect_within(kOfLogs, states.size(), "a log of states",
                [&] { (void)protocol::scan_log(states); });
  for (const std::size_t cut : {100, 40000}) {
    protocol::Bytes damaged(seats.begin(), seats.begin() + static_cast<std::ptrdiff_t>(cut));
    damaged.resize(cut + 100000, std::byte{0x41});
    expect_within(kOfLogs, damaged.size(), "a damaged log",
                  [&] { (void)protocol::scan_log(damaged); });
  }
}

template <int D>
void expect_snapshot_bound(const char* what) {
  const Encoded bytes = encoded(small_sample<D>());
  solver::World<D> world = checked(solver::World<D>::create({}));
  expect_within(kOfSnapshots, bytes.size(), what, [&] { checked(world.decode(bytes)); });
  // A count is believed only as far as there are bytes for it.
  const solver::World<D> sample = small_sample<D>();
  for (const std::size_t place : count_places(sample.state())) {
    Encoded damaged = bytes;
    solver::store_little(0xffffffffu, damaged.data() + place);
    reset_allocations();
    ASSERT_FALSE(world.decode(damaged).ok());
    EXPECT_LE(allocations().peak_bytes, kOfSnapshots.per_byte * bytes.size() + 4096) << place;
  }
}

TEST(AllocationBounds, OfASnapshot) {
  expect_snapshot_bound<2>("a snapshot of the plane");
  expect_snapshot_bound<3>("a snapshot of space");
}

TEST(AllocationBounds, OfASnapshotOfASimulation) {
  for (const char* name : {"pyramid-20", "cubes-901", "cloth-3d", "character-course"}) {
    const scenes::Scene scene = catalogue_scene(name);
    scenes::Simulation simulation = std::move(scenes::Simulation::create(scene).value());
    Encoded bytes;
    simulation.encode(bytes);
    expect_within(kOfSnapshots, bytes.size(), name, [&] { (void)simulation.decode(bytes); });
  }
}

TEST(AllocationBounds, OfEveryCatalogueScene) {
  for (const scenes::CatalogueEntry& entry : scenes::catalogue()) {
    const scenes::Scene scene = catalogue_scene(entry.name);
    const std::vector<std::byte> bytes = scenes::to_binary(scene);
    expect_within(kOfBinaryScenes, bytes.size(), entry.name,
                  [&] { (void)scenes::from_binary(bytes); });
    const std::string text = scenes::to_json(scene);
    expect_within(kOfTextScenes, text.size(), entry.name + " as text",
                  [&] { (void)scenes::from_json(text); });
  }
}

/// Text whose every element is as short as it can be, or a mistake.
TEST(AllocationBounds, OfTextThatAsksForMuch) {
  for (const char* element : {"0", "{}", "{\"x\":0}", "[]"})
    for (const char* array : {"bodies", "joints", "seats", "cloths", "characters", "materials"}) {
      std::string text = std::string("{\"dimension\":2,\"") + array + "\":[" + element;
      for (int i = 1; i < 20000; ++i) text += std::string(",") + element;
      text += "]}";
      expect_within(kOfTextScenes, text.size(), std::string(array) + " of " + element,
                    [&] { (void)scenes::from_json(text); });
    }
}

scenes::Scene ground_of_heights(std::uint32_t columns) {
  scenes::Scene scene;
  scene.dimension = 3;
  scenes::SceneBody& body = scene.bodies.emplace_back();
  body.kind = solver::BodyKind::kStatic;
  scenes::SceneShape& shape = body.shapes.emplace_back();
  shape.kind = solver::ShapeKind::kHeightField;
  shape.columns = columns;
  shape.heights.assign(std::size_t{columns} * columns, 0.0f);
  shape.cell = {1.0f, 1.0f};
  return scene;
}

/// What is largest in memory for its bytes in a file: two triangles for each height, and parts of
/// which nothing is said.
TEST(AllocationBounds, OfBinaryScenesThatSayLittle) {
  const std::vector<std::byte> ground = scenes::to_binary(ground_of_heights(150));
  expect_within(kOfBinaryScenes, ground.size(), "heights",
                [&] { EXPECT_TRUE(scenes::from_binary(ground).scene.has_value()); });
  scenes::Scene scene;
  scene.bodies.resize(20000);
  scene.joints.resize(20000);
  scene.cloths.resize(20000);
  scene.characters.resize(20000);
  const std::vector<std::byte> bytes = scenes::to_binary(scene);
  expect_within(kOfBinaryScenes, bytes.size(), "parts of defaults",
                [&] { EXPECT_FALSE(scenes::from_binary(bytes).scene.has_value()); });
}

/// Few bytes that ask for many particles, registers and triangles.
TEST(AllocationBounds, OfScenesThatAskForMuch) {
  scenes::Scene scene;
  scene.limits.particles = 1u << 24;
  scene.limits.links = 1u << 24;
  scenes::Cloth cloth;
  cloth.across = {0.01f, 0, 0};
  cloth.down = {0, 0.01f, 0};
  cloth.columns = 4096;
  cloth.rows = 4096;
  scene.cloths = {cloth};
  const std::vector<std::byte> bytes = scenes::to_binary(scene);
  expect_within({0, 1u << 20}, bytes.size(), "a cloth of 16 million particles",
                [&] { EXPECT_FALSE(scenes::from_binary(bytes).mistakes.empty()); });
}

}  // namespace
}  // namespace cycloid::hostile
