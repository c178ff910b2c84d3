#include "bench/worlds/bench_worlds.hpp"

#include "bench/worlds/parts.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::worlds {

static void add_small(std::vector<BenchWorld>& worlds) {
  const auto add = [&](const char* name, Scene (*make)(int), int size) {
    const std::string suffix = size > 1 ? "-" + std::to_string(size) : "";
    worlds.push_back({name + suffix, Group::kSmall, make, size, 180, 60, 100});
  };
  add("one", one_box, 1);
  for (const int movers : {20, 60, 200}) add("movers", moving_room, movers);
  for (const int bodies : {50, 100, 200}) add("heap", heap, bodies);
  for (const int base : {10, 14, 19}) add("pyramid-base", box_pyramid, base);
}

static void add_plane(std::vector<BenchWorld>& worlds) {
  const auto add = [&](const char* name, Scene (*make)(int), int size, int warm, int ticks) {
    worlds.push_back({name, Group::kPlane, make, size, warm, ticks, 1, 5});
  };
  add("large-pyramid", box_pyramid, 100, 60, 120);
  add("many-pyramids", many_pyramids, 20, 30, 40);
  add("joint-grid", joint_grid, 100, 60, 120);
  add("tumbler", tumbler, 45, 240, 120);
  add("spinner", spinner, 3000, 240, 120);
  add("ragdoll-rain", ragdoll_rain, 200, 240, 120);
  add("smash", smash, 120, 40, 120);
  add("compounds", compounds, 3000, 240, 120);
  add("ball-pit", falling_balls, 3000, 240, 120);
}

static void add_space(std::vector<BenchWorld>& worlds) {
  const auto add = [&](const char* name, Scene (*make)(int), int size, int warm) {
    worlds.push_back({name, Group::kSpace, make, size, warm, 240, 1, 9});
  };
  add("pyramid-3d", scenes::pyramid_3d, 10, 60);
  add("wall-3d", scenes::wall, 12, 60);
  add("convex-pile", convex_pile, 512, 240);
  add("ragdolls-3d", scenes::ragdolls_3d, 6, 60);
  add("cubes-901", scenes::cubes, 30, 60);
}

static void add_growth(std::vector<BenchWorld>& worlds) {
  // Between two chunks of ticks all of a world is looked at, which leaves the caches full of those
  // that sleep: so of a world that sleeps but for fifty there are as many ticks as of a small one.
  constexpr int kAwake = 50;
  const auto add = [&](const char* name, Scene (*make)(int), bool sleeps) {
    for (const int bodies : {100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000})
      worlds.push_back({std::string(name) + "-" + std::to_string(bodies), Group::kGrowth, make,
                        bodies, 40, std::max(20, 40000 / (sleeps ? kAwake : bodies)), 1, 3});
  };
  add("grow-pyramids", pyramid_field, false);
  add("grow-movers", moving_room, false);
  add("grow-sleepers", sleeping_field, true);
}

const std::vector<BenchWorld>& bench_worlds() {
  static const std::vector<BenchWorld> kWorlds = [] {
    std::vector<BenchWorld> worlds;
    add_small(worlds);
    add_plane(worlds);
    add_space(worlds);
    add_growth(worlds);
    return worlds;
  }();
  return kWorlds;
}

std::optional<BenchWorld> find_bench_world(std::string_view name) {
  for (const BenchWorld& world : bench_worlds())
    if (world.name == name) return world;
  const scenes::Loaded loaded = scenes::find(name);
  if (!loaded.scene) return std::nullopt;
  const Group group = loaded.scene->dimension == 3 ? Group::kSpace : Group::kPlane;
  return BenchWorld{std::string(name), group, nullptr, 0, 60, 300, 1, 9};
}

Scene make_scene(const BenchWorld& world) {
  Scene scene = world.make != nullptr ? world.make(world.size) : *scenes::find(world.name).scene;
  scene.name = world.name;
  if (world.make != sleeping_field) scene.tuning.sleep_s = 0.0f;
  return scene;
}

}  // namespace cycloid::worlds
