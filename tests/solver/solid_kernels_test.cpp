#include "solver/collision/solid_kernels.hpp"

#include "tests/solver/every_width.hpp"
#include "tests/solver/manifold_3d_fixture.hpp"

namespace cycloid::solver {

static Vec<3> drawn_on_grid(std::mt19937& random, float most) {
  Vec<3> drawn;
  for (float& value : drawn.v)
    value = most * (static_cast<float>(random() % 4096) / 2048.0f - 1.0f);
  return drawn;
}

static std::uint32_t first_farthest_face(const std::vector<PolyhedronFace>& faces,
                                         const Vec<3>& point) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < faces.size(); ++i)
    if (dot(faces[i].normal, point) - faces[i].offset >
        dot(faces[best].normal, point) - faces[best].offset)
      best = i;
  return best;
}

static float lowest_corner(const std::vector<PolyhedronVertex>& corners, const Vec<3>& direction) {
  float lowest = 0.0f;
  for (const PolyhedronVertex& corner : corners)
    lowest = min(lowest, dot(corner.position, direction));
  return lowest;
}

/// The corner that is tried first shows most faces that they cannot win; face by face.
static FaceAxis best_face_by_face(const Solid& a, const Solid& b, const FaceTolerance& tolerance,
                                  float margin) {
  FaceAxis best{0, 0, -1.0e30f};
  float threshold = best.separation;
  std::uint32_t guess = 0;
  for (std::uint32_t face = 0; face < a.face_count; ++face) {
    const auto height = [&](std::uint32_t corner) {
      return dot(a.normals[face], b.vertices[corner]) - a.offset(face);
    };
    if (!(height(guess) > threshold)) continue;
    std::uint32_t loses = 0;
    float lowest = 3.0e38f;
    for (; loses < b.vertex_count && height(loses) > threshold; ++loses)
      lowest = min(lowest, height(loses));
    if (loses < b.vertex_count) {
      guess = loses;
      continue;
    }
    if (height(guess) != lowest)
      for (guess = 0; height(guess) != lowest;) ++guess;
    best = {face, guess, lowest};
    if (lowest > margin) break;
    threshold = lowest + tolerance.least + tolerance.of_depth * max(-lowest, 0.0f);
  }
  return best;
}

TEST(SolidKernels, FindFacesAndCornersAsOneByOneAtEveryWidth) {
  std::mt19937 random(20261126);
  for (const std::size_t corners : {4u, 7u, 12u, 20u}) {
    const TestHull hull = ball_hull(corners, 0.5f, static_cast<unsigned>(corners));
    const auto& faces = hull.pool.faces;
    const auto& vertices = hull.pool.vertices;
    for (int round = 0; round < 500; ++round) {
      const Vec<3> point = drawn_on_grid(random, 2.0f);
      const std::uint32_t face = first_farthest_face(faces, point);
      const float lowest = lowest_corner(vertices, point);
      for_each_width<4>([&]<int W>() {
        EXPECT_EQ(face, SolidKernels<W>::face_towards(
                            faces.data(), static_cast<std::uint32_t>(faces.size()), point));
        EXPECT_EQ(lowest, SolidKernels<W>::lowest_along(
                              vertices.data(), static_cast<std::uint32_t>(vertices.size()), point));
      });
    }
    ASSERT_FALSE(HasFailure()) << corners;
  }
}

/// Hulls thrown beside each other, and boxes that lie flush, whose corners are equally deep.
static std::vector<Solid> thrown_solids(std::mt19937& random) {
  static const TestHull kHulls[3] = {ball_hull(6, 0.5f, 1), ball_hull(14, 0.5f, 2),
                                     ball_hull(24, 0.5f, 3)};
  std::vector<Solid> solids;
  for (const TestHull& hull : kHulls) {
    const Rotation<3> any =
        turn_about(drawn_on_grid(random, 1.0f), 0.001 * static_cast<double>(random() % 3000));
    solids.push_back(placed(hull.shape, {drawn_on_grid(random, 0.6f), any}, hull.pool));
  }
  const float level = 0.25f * static_cast<float>(random() % 5);
  solids.push_back(placed(solid_box(0.5f, 0.25f, 0.5f), at(0.0f, level, 0.0f)));
  solids.push_back(placed(solid_box(0.25f, 0.25f, 0.5f), at(0.25f, 0.0f, 0.0f)));
  return solids;
}

TEST(SolidKernels, FindTheBestFaceAsFaceByFaceAtEveryWidth) {
  std::mt19937 random(20261127);
  int apart = 0;
  int near = 0;
  for (int round = 0; round < 400; ++round) {
    const std::vector<Solid> solids = thrown_solids(random);
    const FaceTolerance tolerance{round % 2 == 0 ? 0.0f : 5.0e-4f, round % 2 == 0 ? 0.0f : 1.0e-3f};
    for (const Solid& a : solids)
      for (const Solid& b : solids) {
        const FaceAxis expected = best_face_by_face(a, b, tolerance, 0.02f);
        const WidePlanes planes(a);
        ++(expected.separation > 0.02f ? apart : near);
        for_each_width<4>([&]<int W>() {
          FaceAxis best{0, 0, -1.0e30f};
          SolidKernels<W>::best_face(planes, b.vertices.data(), b.vertex_count, tolerance, 0.02f,
                                     best);
          EXPECT_EQ(expected.face, best.face) << "width " << W << ", round " << round;
          EXPECT_EQ(expected.support, best.support) << "width " << W << ", round " << round;
          EXPECT_EQ(expected.separation, best.separation) << "width " << W << ", round " << round;
        });
      }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(apart, 1000);
  EXPECT_GT(near, 1000);
}

}  // namespace cycloid::solver
