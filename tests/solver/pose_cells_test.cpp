#include "solver/collision/pose_cells.hpp"

#include "tests/solver/manifold_3d_fixture.hpp"

namespace cycloid::solver {

static PlacedPair<3> pair_of(const Pose<3>& a, const Pose<3>& b) {
  return {a, b, 0, 1, 0.02f};
}

static Pose<3> any_pose_near(std::mt19937& random, float reach) {
  std::uniform_real_distribution<float> place(-reach, reach);
  std::normal_distribution<float> normal;
  const Rotation<3> any{{normal(random), normal(random), normal(random), normal(random)}};
  return {{{place(random), place(random), place(random)}},
          normalized_or(any, identity_rotation<3>())};
}

TEST(PoseCells, MoveNoPointFartherThanTheySay) {
  std::mt19937 random(1);
  for (const float extent : {0.004f, 0.3f, 1.0f, 20.0f}) {
    const CellGrid grid = grid_of(30.0f, extent);
    EXPECT_FALSE(grid.b_carries);
    EXPECT_LE(grid.step, 1.0f / 512.0f);
    EXPECT_LE(grid.step, extent / 256.0f);
    EXPECT_LE(moved_by_rounding(grid, extent), 1.9f * grid.step);
    for (int i = 0; i < 2000; ++i) {
      const Pose<3> relative =
          relative_pose(grid, pair_of(any_pose_near(random, 5.0f), any_pose_near(random, 5.0f)));
      const Pose<3> cell = rounded(grid, relative);
      const Rotation<3> there = normalized_or(cell.rotation, identity_rotation<3>());
      Vec<3> point = any_pose_near(random, 1.0f).position;
      point = (extent / length(point)) * point;
      const Vec<3> moved = relative.position + rotate(relative.rotation, point) - cell.position -
                           rotate(there, point);
      EXPECT_LE(length(moved), moved_by_rounding(grid, extent) + 1.0e-6f * (10.0f + extent));
    }
  }
}

TEST(PoseCells, HaveTheFrameOfWhatReachesFarther) {
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const Pose<3> a = any_pose_near(random, 2.0f);
    const Pose<3> b = any_pose_near(random, 2.0f);
    const CellGrid of_a = grid_of(2.0f, 1.0f);
    const CellGrid of_b = grid_of(1.0f, 2.0f);
    EXPECT_TRUE(of_b.b_carries);
    EXPECT_EQ(of_a.step, of_b.step);
    const Pose<3> b_in_a = relative_pose(of_a, pair_of(a, b));
    const Pose<3> same = relative_pose(of_b, pair_of(b, a));
    for (int k = 0; k < 3; ++k) EXPECT_EQ(b_in_a.position[k], same.position[k]);
    const Vec<3> back = a.position + rotate(a.rotation, b_in_a.position);
    EXPECT_LT(length(back - b.position), 1.0e-5f);
  }
}

TEST(PoseCells, RoundMarginsToFewThatReachAsFarAsTheyNeedTo) {
  constexpr float kSpeculative = 0.02f;
  std::set<float> margins;
  for (int i = 0; i < 1000; ++i) {
    const float flight = 1.0e-3f * static_cast<float>(i);
    const float margin = rounded_margin(kSpeculative + flight, kSpeculative);
    EXPECT_GE(margin, flight);
    EXPECT_LE(margin, 1.5f * (kSpeculative + flight));
    EXPECT_TRUE(margins.empty() || margin >= *margins.rbegin());
    margins.insert(margin);
  }
  EXPECT_EQ(*margins.begin(), kSpeculative);
  EXPECT_LT(margins.size(), 15u);
  EXPECT_EQ(rounded_margin(0.3f, 0.0f), 0.3f);
}

// Where both find the same points, those lie where the collision itself puts them, whichever of the
// two carries the frame and has the face.
TEST(PoseCells, ManifoldsAreMovedToWhereTheBodiesAre) {
  std::mt19937 random(3);
  const TestHull stone = ball_hull(14, 0.5f, 4);
  const Shape<3> box = solid_box(0.6f, 0.6f, 0.6f);
  int compared = 0;
  int of_face_of_b = 0;
  for (int i = 0; i < 4000; ++i) {
    const bool turned_round = i % 2 != 0;
    const Shape<3>& a = turned_round ? stone.shape : box;
    const Shape<3>& b = turned_round ? box : stone.shape;
    const PlacedPair<3> pair = pair_of(any_pose_near(random, 0.6f), any_pose_near(random, 0.6f));
    const CellGrid grid = i % 4 < 2 ? grid_of(0.9f, 0.8f) : grid_of(0.8f, 0.9f);
    const Pose<3> relative = relative_pose(grid, pair);
    const Pose<3> cell = rounded(grid, relative);
    Manifold<3> found;
    move_from_cell(collide_in_cell(a, b, stone.pool, grid, cell, pair.margin), grid, cell, relative,
                   pair, found);
    const Manifold<3> exact = collide(a, pair.pose_a, b, pair.pose_b, pair.margin, stone.pool);
    if (found.point_count == 0 || found.point_count != exact.point_count) continue;
    bool same_features = true;
    for (std::uint32_t k = 0; k < found.point_count; ++k)
      same_features = same_features && found.points[k].feature == exact.points[k].feature;
    if (!same_features || exact.points[0].separation < -0.1f) continue;
    ++compared;
    if ((found.points[0].feature & kReferenceOnB) != 0) ++of_face_of_b;
    const bool of_face = (found.points[0].feature & kOfNoFace) == 0;
    // A face keeps its normal and the heights of corners; what two edges have turns with them.
    EXPECT_LT(length(found.normal - exact.normal), of_face ? 1.0e-5f : 1.0e-2f) << i;
    EXPECT_NEAR(length(found.normal), 1.0f, 1.0e-5f);
    for (std::uint32_t k = 0; k < found.point_count; ++k) {
      const ManifoldPoint<3>& point = found.points[k];
      EXPECT_LT(length(point.anchor_a - exact.points[k].anchor_a), 1.0e-2f) << i;
      const bool of_corner = of_face && (point.feature & kCorner) == kCorner;
      const float off = abs(point.separation - exact.points[k].separation);
      // What is cut from an edge at the border of a face is another point of the edge.
      const float off_max = of_corner ? 1.0e-5f : of_face ? 1.0e-2f : 1.0e-3f;
      EXPECT_LT(off, off_max) << i;
    }
  }
  EXPECT_GT(compared, 100);
  EXPECT_GT(of_face_of_b, 20);
  EXPECT_LT(of_face_of_b, compared - 20);
}

}  // namespace cycloid::solver
