#include <functional>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// A ball falls towards a shelf; what is done to the shelf must be seen.
struct Shelf {
  World<2> world = make_world(with_gravity<2>());
  BodyId shelf;
  BodyId faller;

  Shelf() {
    shelf = add_shelf({{0.0f, 0.0f}});
    faller = add_at<2>(world, {{0.0f, 2.0f}}, ball<2>(0.5f));
    step(world, 20);
  }
  BodyId add_shelf(const Vec<2>& position) {
    BodyDef<2> def;
    def.kind = BodyKind::kStatic;
    def.position = position;
    return add(world, def, box(1.0f, 0.1f));
  }
  float height() const { return view(world, faller).position[1]; }
};

// The tree of static shapes is kept from tick to tick. A world that decodes the same state has
// none, so both go the same way only if every change of a static body is noticed.
TEST(StaticShapes, ThatComeGoAndMoveAreSeenAsByAWorldWithoutHistory) {
  struct Case {
    const char* name;
    std::function<void(Shelf&)> change;
    float rests_at;  ///< m; below -5: it falls past.
  };
  const Case cases[] = {
      {"nothing", [](Shelf&) {}, 0.6f},
      {"set_pose away",
       [](Shelf& s) {
         ASSERT_TRUE(s.world.set_pose(s.shelf, {{5.0f, 0.0f}}, identity_rotation<2>()).ok());
       },
       -10.0f},
      {"set_pose down",
       [](Shelf& s) {
         ASSERT_TRUE(s.world.set_pose(s.shelf, {{0.0f, -3.0f}}, identity_rotation<2>()).ok());
       },
       -2.4f},
      {"destroy_body", [](Shelf& s) { ASSERT_TRUE(s.world.destroy_body(s.shelf).ok()); }, -10.0f},
      {"create_body",
       [](Shelf& s) {
         s.add_shelf({{0.0f, 0.5f}});
       },
       1.1f},
      {"restore",
       [](Shelf& s) {
         Shelf other;
         ASSERT_TRUE(
             other.world.set_pose(other.shelf, {{0.0f, -2.0f}}, identity_rotation<2>()).ok());
         s.world.restore(other.world.state());
       },
       -1.4f},
  };
  for (const Case& test : cases) {
    Shelf shelf;
    test.change(shelf);
    std::vector<std::byte> bytes;
    shelf.world.encode(bytes);
    World<2> fresh = make_world(WorldDef<2>{});
    ASSERT_TRUE(fresh.decode(bytes).ok()) << test.name;
    for (int tick = 0; tick < 120; ++tick) {
      step(shelf.world, 1);
      step(fresh, 1);
      ASSERT_EQ(shelf.world.digest(), fresh.digest()) << test.name << " at " << tick;
    }
    if (test.rests_at > -5.0f)
      EXPECT_NEAR(shelf.height(), test.rests_at, 0.02f) << test.name;
    else
      EXPECT_LT(shelf.height(), -5.0f) << test.name;
  }
}

}  // namespace cycloid::solver
