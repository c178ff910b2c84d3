#include "scenes/catalogue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "scenes/golden.hpp"
#include "scenes/simulation.hpp"
#include "solver/version.hpp"
#include "tests/places.hpp"

namespace cycloid::scenes {

/// Every scene of the catalogue with its own script, by name.
class Catalogue : public testing::TestWithParam<std::string> {
 protected:
  Scene scene() const {
    Loaded loaded = find(GetParam());
    EXPECT_TRUE(loaded.scene.has_value()) << GetParam();
    return std::move(*loaded.scene);
  }
};

Simulation start(const Scene& scene) {
  solver::Result<Simulation> simulation = Simulation::create(scene);
  EXPECT_TRUE(simulation.ok()) << simulation.error().field;
  return std::move(simulation.value());
}

void step(const Scene& scene, Simulation& simulation) {
  std::vector<SeatInput> inputs;
  for (int seat = 0; seat < simulation.seats(); ++seat)
    inputs.push_back(scripted_input(scene, seat, simulation.tick() + 1));
  const solver::Error error = simulation.step(inputs);
  ASSERT_TRUE(error.ok()) << error.field << " at tick " << simulation.tick() + 1;
}

std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const CatalogueEntry& entry : catalogue()) names.push_back(entry.name);
  return names;
}

/// goldens.txt holds on every target; a commit that changes the arithmetic replaces it, raises
/// kSolverVersion and says why.
const GoldenFile& goldens() {
  static const GoldenFile kGoldens = [] {
    std::ifstream stream(places::source("tests/determinism/goldens.txt"), std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    ParsedGolden parsed = parse_golden(text.str());
    EXPECT_TRUE(parsed.file) << parsed.mistake.line << ": " << parsed.mistake.reason;
    return parsed.file.value_or(GoldenFile());
  }();
  return kGoldens;
}

TEST(Goldens, AreOfThisVersionAndOfTheWholeCatalogueAtFourTicks) {
  EXPECT_EQ(goldens().solver_version, solver::kSolverVersion);
  std::vector<std::string> listed;
  for (const GoldenScene& golden : goldens().scenes) {
    listed.push_back(golden.name);
    std::vector<std::uint64_t> ticks;
    for (const GoldenRow& row : golden.rows) ticks.push_back(row.tick);
    EXPECT_THAT(ticks, testing::ElementsAre(1, 10, 100, 600)) << golden.name;
  }
  EXPECT_THAT(listed, testing::ElementsAreArray(names()));
}

TEST_P(Catalogue, DigestsAreTheGoldens) {
  const Scene scene = this->scene();
  const std::vector<GoldenScene>& all = goldens().scenes;
  const auto golden = std::find_if(all.begin(), all.end(), [](const GoldenScene& candidate) {
    return candidate.name == GetParam();
  });
  ASSERT_TRUE(golden != all.end()) << "no golden; ./dev mint";
  EXPECT_EQ(golden->scene_digest, scene_digest(scene));
  EXPECT_EQ(golden->inputs_digest, inputs_digest(scene, golden->ticks));
  GoldenWalk walk(scene, start(scene));
  const auto mismatch = compare_golden(*golden, walk, golden->ticks);
  EXPECT_FALSE(mismatch) << mismatch_text(*mismatch);
  EXPECT_EQ(walk.tick(), golden->ticks);
}

// Two worlds side by side, compared after every tick, so that a failure names the first bad one.
TEST_P(Catalogue, WorkersLanesAndLotsAreInvisible) {
  struct Setting {
    int workers;
    int lanes;
    std::uint32_t lot_contacts;
  };
  const Scene scene = this->scene();
  for (const Setting setting :
       {Setting{2, 4, 8}, Setting{3, 1, 1}, Setting{1, 8, 30}, Setting{8, 16, 0}}) {
    Simulation one = start(scene);
    Simulation other = start(scene);
    ASSERT_TRUE(one.set_lanes(4).ok());
    ASSERT_TRUE(other.set_lanes(setting.lanes).ok());
    ASSERT_TRUE(other.set_workers(setting.workers).ok());
    other.set_lot_contacts(setting.lot_contacts);
    for (int tick = 1; tick <= 60; ++tick) {
      step(scene, one);
      step(scene, other);
      ASSERT_EQ(one.digest(), other.digest())
          << "tick " << tick << ", workers " << setting.workers << ", lanes " << setting.lanes
          << ", contacts of a lot " << setting.lot_contacts;
      // What was solved in vain shows in no digest of this tick, but may in one of another scene.
      ASSERT_EQ(one.statistics().rows, other.statistics().rows)
          << "tick " << tick << ", lanes " << setting.lanes;
    }
  }
}

TEST_P(Catalogue, RestoredAtEveryTenthTickFromMemoryAndFromBytesItGoesOnAsItWas) {
  constexpr int kEnd = 120;
  const Scene scene = this->scene();
  Simulation simulation = start(scene);
  std::vector<std::uint64_t> digests = {simulation.digest()};
  std::vector<Simulation::Saved> saved;
  std::vector<std::vector<std::byte>> encoded;
  for (int tick = 0; tick < kEnd; ++tick) {
    if (tick % 10 == 0) {
      simulation.save(saved.emplace_back());
      simulation.encode(encoded.emplace_back());
    }
    step(scene, simulation);
    digests.push_back(simulation.digest());
  }
  for (std::size_t i = 0; i < saved.size(); ++i) {
    // From memory into the world that has run to its end; from bytes into one that never ran.
    simulation.restore(saved[i]);
    Simulation fresh = start(scene);
    ASSERT_TRUE(fresh.decode(encoded[i]).ok());
    for (std::size_t tick = 10 * i;; ++tick) {
      ASSERT_EQ(simulation.digest(), digests[tick]) << "memory, from " << 10 * i << " at " << tick;
      ASSERT_EQ(fresh.digest(), digests[tick]) << "bytes, from " << 10 * i << " at " << tick;
      if (tick == kEnd) break;
      step(scene, simulation);
      step(scene, fresh);
    }
  }
}

TEST_P(Catalogue, EncodingIsExactAndStable) {
  const Scene scene = this->scene();
  Simulation simulation = start(scene);
  for (int tick = 0; tick < 30; ++tick) step(scene, simulation);
  std::vector<std::byte> bytes;
  simulation.encode(bytes);
  Simulation other = start(scene);
  ASSERT_TRUE(other.decode(bytes).ok());
  std::vector<std::byte> again;
  other.encode(again);
  EXPECT_EQ(bytes, again);
  EXPECT_TRUE(simulation.differences(other, 10).empty());
}

// A world that is moved, and one that lives beside others, is the same world.
TEST_P(Catalogue, OtherWorldsAndMovesAreInvisible) {
  const Scene scene = this->scene();
  Simulation alone = start(scene);
  Simulation beside = start(scene);
  std::vector<Simulation> others;
  for (int tick = 0; tick < 30; ++tick) {
    if (tick % 10 == 0) others.push_back(start(scene));
    for (Simulation& other : others) step(scene, other);
    step(scene, alone);
    Simulation moved = std::move(beside);
    step(scene, moved);
    beside = std::move(moved);
    ASSERT_EQ(alone.digest(), beside.digest()) << "tick " << tick;
  }
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  for (char& c : name)
    if (c == '-' || c == ':' || c == '=') c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Catalogue, testing::ValuesIn(names()), test_name);

}  // namespace cycloid::scenes
