#include <gtest/gtest.h>

#include <random>

#include "scenes/build.hpp"
#include "scenes/generators/generators.hpp"

namespace cycloid::scenes {
namespace {

/// Numbers from 0 to 1, the same on every machine.
class Chance {
 public:
  explicit Chance(std::uint32_t seed) : bits_(seed) {}
  double operator()() { return static_cast<double>(bits_()) / 4294967296.0; }

 private:
  std::mt19937 bits_;
};

/// Six people in space, by chance half of them a hundred times as heavy, who fall upon one another.
Scene unequal_people(std::uint32_t seed) {
  constexpr std::size_t kLimbs = 11;
  Chance chance(seed);
  Scene scene = ragdolls_3d(6);
  scene.tuning.sleep_s = 0.0f;
  std::size_t limb = 0;
  float heavier = 1.0f;
  for (SceneBody& body : scene.bodies) {
    if (body.kind != solver::BodyKind::kDynamic) continue;
    if (limb++ % kLimbs == 0) heavier = chance() < 0.5 ? 1.0f : 100.0f;
    for (float& speed : body.velocity) speed += static_cast<float>(0.2 * chance() - 0.1);
    for (auto& shape : body.shapes) shape.density *= heavier;
  }
  return scene;
}

/// The tick in which they fault, or 0.
int faults_in(const Scene& scene) {
  std::vector<Mistake> mistakes;
  const auto built = build<3>(scene, mistakes);
  EXPECT_NE(built, nullptr);
  if (built == nullptr) return -1;
  for (int tick = 1; tick <= 200; ++tick)
    if (!built->world.step().ok()) return tick;
  return 0;
}

// Up to version 34 somebody was thrown out in 7 of 200.
TEST(HeavyPeople, WhoFallUponLightOnesThrowNobodyOut) {
  for (std::uint32_t seed = 1; seed <= 200; ++seed)
    EXPECT_EQ(faults_in(unequal_people(seed)), 0) << seed;
}

}  // namespace
}  // namespace cycloid::scenes
