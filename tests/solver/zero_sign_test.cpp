#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Balls in a row on the ground, every fifth of a material that resists rolling, so that blocks of
/// some widths hold a rolling contact beside others, and blocks of other widths do not.
template <int D>
std::vector<std::byte> row_of_balls(int lanes) {
  WorldDef<D> def = with_gravity<D>({0.0f, 0.0f, 0.0f, 0.0f});
  def.materials.push_back({0.5f, 0.3f, 0.1f, 0.1f});
  World<D> world = make_world(def);
  EXPECT_TRUE(world.set_lanes(lanes).ok());
  add_ground(world, up<D>());
  for (int i = 0; i < 40; ++i) {
    BodyDef<D> body;
    body.position[0] = 1.5f * static_cast<float>(i);
    body.position[1] = 0.499f;
    body.spin[Dim<D>::kSpin - 1] = static_cast<float>(i % 3 - 1);
    ShapeDef<D> shape = ball<D>(0.5f);
    shape.material = i % 5 == 4 ? 1 : 0;
    add(world, body, shape);
  }
  step(world, 3);
  std::vector<std::byte> bytes;
  world.encode(bytes);
  return bytes;
}

// The digest takes both zeros as one; an encoding has the sign of each, and lanes may not show in
// it: an impulse that nothing acts on was -0 or +0 by what else was in its block.
TEST(ZeroSign, OfImpulsesIsTheSameAtEveryLaneWidth) {
  for (const int lanes : {4, 8, 16}) {
    EXPECT_EQ(row_of_balls<2>(1), row_of_balls<2>(lanes)) << lanes;
    EXPECT_EQ(row_of_balls<3>(1), row_of_balls<3>(lanes)) << lanes;
  }
}

}  // namespace cycloid::solver
