#include <algorithm>
#include <random>
#include <set>

#include "solver/collision/bounds_tree.hpp"
#include "solver/collision/collide.hpp"
#include "solver/shapes.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

template <int D>
Shape<D> record(const ShapeDef<D>& def) {
  std::vector<Shape<D>> shapes;
  EXPECT_TRUE(append_shapes(def, 0, shapes).ok());
  return shapes.front();
}

template <int D>
Pose<D> pose(Vec<D> position) {
  return {position, identity_rotation<D>()};
}

TEST(Collide, FlatBoxesMeetInTwoPointsWithTheNormalFromAToB) {
  const Shape<2> a = record(box(0.5f, 0.5f));
  const Manifold<2> manifold =
      collide(a, pose<2>({{0.0f, 0.0f}}), a, pose<2>({{0.25f, 0.99f}}), 0.02f, {});
  ASSERT_EQ(manifold.point_count, 2u);
  EXPECT_FLOAT_EQ(manifold.normal[0], 0.0f);
  EXPECT_FLOAT_EQ(manifold.normal[1], 1.0f);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(manifold.points[i].separation, -0.01f, 1.0e-6f);
  const float width = std::abs(manifold.points[0].anchor_a[0] - manifold.points[1].anchor_a[0]);
  EXPECT_NEAR(width, 0.75f, 1.0e-6f);
}

// A box that rocks on another one by a thousandth turns the reference edge over to the other shape
// and back. Its points are the same ones, in the same order, or they would lose their impulses.
TEST(Collide, PointsKeepTheirFeaturesWhenTheReferenceEdgeIsTheOthers) {
  const Shape<2> a = record(box(0.5f, 0.5f));
  const auto rocking = [&](float angle, float x) {
    return collide(a, pose<2>({{0.0f, 0.0f}}), a, {{{x, 0.98f}}, turned(angle)}, 0.02f, {});
  };
  for (const float x : {-0.3f, 0.0f, 0.3f}) {
    std::set<float> normals;
    const Manifold<2> flat = rocking(0.0f, x);
    ASSERT_EQ(flat.point_count, 2u);
    for (const float angle : {-2.0e-3f, -1.0e-3f, 1.0e-3f, 2.0e-3f}) {
      const Manifold<2> manifold = rocking(angle, x);
      ASSERT_EQ(manifold.point_count, 2u);
      normals.insert(manifold.normal[0]);
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(manifold.points[i].feature, flat.points[i].feature) << x << ' ' << angle;
        EXPECT_NEAR(manifold.points[i].anchor_a[0], flat.points[i].anchor_a[0], 0.01f);
      }
    }
    EXPECT_TRUE(x == 0.0f || (normals.contains(0.0f) && normals.size() > 1)) << "not turned over";
  }
}

TEST(Collide, SwappingTheShapesMirrorsTheManifold) {
  const Shape<2> a = record(box(0.5f, 0.5f));
  const Shape<2> b = record(capsule(0.4f, 0.2f));
  const Pose<2> pose_a = pose<2>({{0.0f, 0.0f}});
  const Pose<2> pose_b = {{{0.1f, 0.65f}}, turned(0.1f)};
  const Manifold<2> forth = collide(a, pose_a, b, pose_b, 0.1f, {});
  const Manifold<2> back = collide(b, pose_b, a, pose_a, 0.1f, {});
  ASSERT_EQ(forth.point_count, back.point_count);
  ASSERT_GT(forth.point_count, 0u);
  EXPECT_NEAR(forth.normal[0], -back.normal[0], 1.0e-6f);
  EXPECT_NEAR(forth.normal[1], -back.normal[1], 1.0e-6f);
}

TEST(Collide, CapsulesInOneLineMeetAtTheirEnds) {
  const Shape<2> a = record(capsule(1.0f, 0.5f));
  const Manifold<2> manifold =
      collide(a, pose<2>({{0.0f, 0.0f}}), a, pose<2>({{2.95f, 0.0f}}), 0.02f, {});
  ASSERT_EQ(manifold.point_count, 1u);
  EXPECT_NEAR(manifold.normal[0], 1.0f, 1.0e-6f);
  EXPECT_NEAR(manifold.points[0].separation, -0.05f, 1.0e-5f);
}

TEST(Collide, CornersOfSeparatedBoxesMeetAlongTheLineBetweenThem) {
  const Shape<2> a = record(box(0.5f, 0.5f));
  const Manifold<2> manifold =
      collide(a, pose<2>({{0.0f, 0.0f}}), a, pose<2>({{1.03f, 1.04f}}), 0.1f, {});
  ASSERT_EQ(manifold.point_count, 1u);
  EXPECT_NEAR(manifold.points[0].separation, 0.05f, 1.0e-5f);
  EXPECT_NEAR(manifold.normal[0], 0.6f, 1.0e-3f);
  EXPECT_NEAR(manifold.normal[1], 0.8f, 1.0e-3f);
}

// A ball rolled along a chain of many edges feels no edge: the chain is one surface.
TEST(Collide, BallDoesNotTripOverTheJointsOfAChain) {
  World<2> world = make_world(with_gravity<2>({0.0f, 0.0f}));
  BodyDef<2> def;
  def.kind = BodyKind::kStatic;
  ShapeDef<2> chain;
  chain.kind = ShapeKind::kChain;
  for (int i = 0; i <= 40; ++i) chain.points.push_back({{static_cast<float>(i) * 0.5f, 0.0f}});
  add(world, def, chain);
  BodyDef<2> rider;
  rider.position = {{1.0f, 0.5f}};
  rider.velocity = {{5.0f, 0.0f}};
  const BodyId id = add(world, rider, ball<2>(0.5f));
  step(world, 180);
  EXPECT_NEAR(view(world, id).velocity[0], 5.0f, 1.0e-4f);
  EXPECT_NEAR(view(world, id).velocity[1], 0.0f, 1.0e-3f);
}

TEST(Collide, BoxSlidesAlongAChainWithoutTripping) {
  World<2> world = make_world(with_gravity<2>({0.0f, 0.0f}));
  BodyDef<2> def;
  def.kind = BodyKind::kStatic;
  ShapeDef<2> chain;
  chain.kind = ShapeKind::kChain;
  for (int i = 0; i <= 40; ++i) chain.points.push_back({{static_cast<float>(i) * 0.5f, 0.0f}});
  add(world, def, chain);
  BodyDef<2> rider;
  rider.position = {{1.0f, 0.5f}};
  rider.velocity = {{5.0f, 0.0f}};
  const BodyId id = add(world, rider, box(0.4f, 0.5f));
  step(world, 180);
  EXPECT_NEAR(view(world, id).velocity[0], 5.0f, 1.0e-3f);
  EXPECT_NEAR(view(world, id).position[1], 0.5f, 0.01f);
}

TEST(Collide, ChainIsOneSided) {
  ShapeDef<2> def;
  def.kind = ShapeKind::kChain;
  def.points = {{{-1.0f, 0.0f}}, {{1.0f, 0.0f}}};  // Runs to +x: solid to its right, below.
  const Shape<2> segment = record(def);
  const Shape<2> round = record(ball<2>(0.5f));
  const Pose<2> origin = pose<2>({{0.0f, 0.0f}});
  EXPECT_EQ(collide(segment, origin, round, pose<2>({{0.0f, 0.45f}}), 0.02f, {}).point_count, 1u);
  EXPECT_EQ(collide(segment, origin, round, pose<2>({{0.0f, -0.45f}}), 0.02f, {}).point_count, 0u);
}

// Distances against an independent dense sampling of both outlines, in double.
TEST(Collide, RandomHullsAgreeWithASampledDistance) {
  std::mt19937 random(7);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967295.0);
  };
  int apart = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const ShapeDef<2> defs[2] = {box(0.5f, 0.3f), capsule(0.4f, 0.25f)};
    const Shape<2> a = record(defs[random() % 2]);
    const Shape<2> b = record(defs[random() % 2]);
    const Pose<2> pose_a = {{{0.0f, 0.0f}}, turned(static_cast<float>(uniform(-3.1, 3.1)))};
    const Pose<2> pose_b = {
        {{static_cast<float>(uniform(-1.5, 1.5)), static_cast<float>(uniform(-1.5, 1.5))}},
        turned(static_cast<float>(uniform(-3.1, 3.1)))};
    const auto outline = [](const Shape<2>& shape, const Pose<2>& at) {
      std::vector<std::array<double, 2>> points;
      const std::uint32_t edges = shape.vertex_count == 2 ? 1 : shape.vertex_count;
      for (std::uint32_t i = 0; i < edges; ++i) {
        const Vec<2> p = at.position + rotate(at.rotation, shape.vertices[i]);
        const Vec<2> q =
            at.position + rotate(at.rotation, shape.vertices[(i + 1) % shape.vertex_count]);
        for (int k = 0; k < 60; ++k) {
          const double s = k / 59.0;
          points.push_back({p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])});
        }
      }
      return points;
    };
    double nearest = 1.0e9;
    for (const auto& p : outline(a, pose_a))
      for (const auto& q : outline(b, pose_b))
        nearest = std::min(nearest, std::hypot(p[0] - q[0], p[1] - q[1]));
    // Disjoint beyond the sampling error, and neither inside the other.
    const auto holds = [](const Shape<2>& shape, const Pose<2>& at, const Vec<2>& point) {
      if (shape.vertex_count == 2) return false;
      const Vec<2> local = rotate_back(at.rotation, point - at.position);
      return std::abs(local[0]) < 0.5f && std::abs(local[1]) < 0.3f;
    };
    const bool nested = holds(a, pose_a, pose_b.position) || holds(b, pose_b, pose_a.position);
    if (nearest < 0.04 || nested) continue;
    ++apart;
    const double expected = nearest - (a.radius + b.radius);
    const Manifold<2> manifold = collide(a, pose_a, b, pose_b, 4.0f, {});
    ASSERT_GT(manifold.point_count, 0u) << "trial " << trial;
    float least = 4.0f;
    for (std::uint32_t i = 0; i < manifold.point_count; ++i)
      least = std::min(least, manifold.points[i].separation);
    EXPECT_NEAR(least, expected, 0.03) << "trial " << trial;
  }
  EXPECT_GT(apart, 500);
}

TEST(Collide, ConcentricBallsHaveADefinedNormal) {
  const Shape<3> round = record(ball<3>(0.5f));
  const Manifold<3> manifold = collide(round, pose<3>({{1.0f, 2.0f, 3.0f}}), round,
                                       pose<3>({{1.0f, 2.0f, 3.0f}}), 0.02f, {});
  ASSERT_EQ(manifold.point_count, 1u);
  EXPECT_EQ(manifold.normal[1], 1.0f);
  EXPECT_EQ(manifold.points[0].separation, -1.0f);
}

// The tree finds exactly the pairs that comparing all with all finds.
TEST(BoundsTree, FindsWhatBruteForceFinds) {
  std::mt19937 random(3);
  std::vector<BoundsTree<3>::Leaf> leaves;
  for (std::uint32_t i = 0; i < 300; ++i) {
    BoundsTree<3>::Leaf leaf;
    leaf.id = i;
    for (int k = 0; k < 3; ++k) {
      leaf.bounds.lower[k] = static_cast<float>(random() % 1000) * 0.01f;
      leaf.bounds.upper[k] = leaf.bounds.lower[k] + static_cast<float>(random() % 100) * 0.02f;
    }
    leaves.push_back(leaf);
  }
  BoundsTree<3> tree;
  TreeRoom<3> room;
  Workers workers(1);
  tree.build(leaves, workers, room);
  for (const auto& leaf : leaves) {
    std::vector<std::uint32_t> found;
    tree.query(leaf.bounds, [&](int rank) { found.push_back(tree.leaf(rank).id); });
    std::sort(found.begin(), found.end());
    std::vector<std::uint32_t> expected;
    for (const auto& other : leaves)
      if (overlaps(leaf.bounds, other.bounds)) expected.push_back(other.id);
    EXPECT_EQ(found, expected);
  }
}

}  // namespace cycloid::solver
