#include "solver/collision/solid_apart.hpp"

#include "tests/solver/manifold_3d_fixture.hpp"

namespace cycloid::solver {

constexpr float kMargin = 0.05f;

/// How often two solids are thrown beside each other, and what is found.
struct Throws {
  int apart = 0;   ///< No point is nearer than the margin.
  int parted = 0;  ///< A face told so at once.
};

static Pose<3> any_pose(float reach, std::mt19937& random) {
  std::uniform_real_distribution<float> place(-reach, reach);
  std::normal_distribution<float> normal;
  const Rotation<3> any{{normal(random), normal(random), normal(random), normal(random)}};
  return {{{place(random), place(random), place(random)}},
          normalized_or(any, identity_rotation<3>())};
}

static Throws throw_beside(const Shape<3>& a, const Shape<3>& b, const Polyhedra& pool) {
  std::mt19937 random(5);
  Throws throws;
  for (int i = 0; i < 20000; ++i) {
    const Pose<3> pose_a = any_pose(0.1f, random);
    const Pose<3> pose_b = any_pose(1.2f, random);
    const Vec<3> a_to_b = pose_b.position - pose_a.position;
    const Solid solid_a = placed(a, {Vec<3>::zero(), pose_a.rotation}, pool);
    const Solid solid_b = placed(b, {a_to_b, pose_b.rotation}, pool);
    const Manifold<3> manifold = solid_against_solid(solid_a, solid_b, kMargin);
    const PlacedPair<3> pair{pose_a, pose_b, 0, 0, kMargin};
    const bool parted = gap_beside_a_face(a, b, pair, i % 2 == 0, pool, kMargin).gap > kMargin;
    if (manifold.point_count == 0) ++throws.apart;
    if (parted) ++throws.parted;
    EXPECT_FALSE(parted && manifold.point_count > 0) << "throw " << i;
    EXPECT_EQ(collide(a, pose_a, b, pose_b, kMargin, pool).point_count, manifold.point_count);
  }
  return throws;
}

TEST(SolidsApart, AreToldByAFaceOnlyWhereNoPointIsNear) {
  TestHull stone = ball_hull(16, 0.5f, 3);
  stone.shape.vertices[0] = {{0.1f, -0.2f, 0.05f}};
  stone.shape.rotation = turn_about({{1, 2, 3}}, 0.7);
  TestHull tetrahedron = hull_of({{{0, 0, 0}}, {{0.6f, 0, 0}}, {{0, 0.6f, 0}}, {{0, 0, 0.6f}}});
  Shape<3> box = solid_box(0.5f, 0.1f, 0.3f);
  box.vertices[0] = {{0.0f, 0.1f, 0.0f}};
  for (const TestHull* hull : {&stone, &tetrahedron}) {
    for (const Shape<3>& other : {hull->shape, box}) {
      const Throws throws = throw_beside(hull->shape, other, hull->pool);
      EXPECT_GT(throws.apart, 5000);
      EXPECT_LT(throws.apart, 19000);
      // Or it would not be worth asking.
      EXPECT_GT(throws.parted, throws.apart * 8 / 10);
    }
  }
}

TEST(SolidsApart, AreNotToldWhereAFaceIsNearerThanTheMargin) {
  const Shape<3> cube = solid_box(0.5f, 0.5f, 0.5f);
  const auto parts = [&](float gap) {
    const PlacedPair<3> pair{at(0.0f, 0.0f, 0.0f), at(0.0f, 1.0f + gap, 0.3f), 0, 0, kMargin};
    return gap_beside_a_face(cube, cube, pair, false, {}, kMargin).gap > kMargin;
  };
  EXPECT_FALSE(parts(kMargin));
  EXPECT_FALSE(parts(kMargin + 4.0e-4f));  // A face before it might be taken for the axis.
  EXPECT_TRUE(parts(kMargin + 7.0e-4f));
}

TEST(SolidsApart, TellWhoseFaceIsAndHowFarItParts) {
  const Shape<3> wide = solid_box(2.0f, 0.5f, 2.0f);
  const Shape<3> cube = solid_box(0.5f, 0.5f, 0.5f);
  // The cube stands on an edge over the wide box, of which alone a face parts the two by all of it.
  const Pose<3> above{{{0.3f, 1.5f, 0.0f}}, turn_about({{0, 0, 1}}, M_PI / 4.0)};
  const PlacedPair<3> pair{at(0.0f, 0.0f, 0.0f), above, 0, 0, kMargin};
  for (const bool b_first : {false, true}) {
    const FaceGap found = gap_beside_a_face(wide, cube, pair, b_first, {}, kMargin);
    EXPECT_FALSE(found.of_b);
    EXPECT_NEAR(found.gap, 1.0f - 0.5f * std::sqrt(2.0f), 1.0e-3f);
  }
}

}  // namespace cycloid::solver
