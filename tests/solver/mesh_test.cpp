#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "solver/shapes.hpp"
#include "solver/validate.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static ShapeDef<3> mesh(const std::vector<Vec<3>>& points,
                        const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kMesh;
  shape.points = points;
  shape.triangles = triangles;
  return shape;
}

static ShapeDef<3> height_field(std::uint32_t columns, const std::vector<float>& heights) {
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kHeightField;
  shape.columns = columns;
  shape.heights = heights;
  shape.cell = {0.5f, 2.0f};
  return shape;
}

static std::vector<Shape<3>> records(const ShapeDef<3>& def) {
  EXPECT_TRUE(validate(def, BodyKind::kStatic, 1, 0).ok());
  std::vector<Shape<3>> shapes;
  Polyhedra hulls;
  EXPECT_TRUE(append_shapes(def, 0, shapes, hulls).ok());
  EXPECT_TRUE(hulls.records.empty());
  return shapes;
}

static Error error_of(const ShapeDef<3>& def, BodyKind kind = BodyKind::kStatic) {
  World<3> world = make_world<3>();
  BodyDef<3> body;
  body.kind = kind;
  const Result<BodyId> id = world.create_body(body, std::span(&def, 1));
  EXPECT_TRUE(world.state().shapes.empty() || id.ok());
  return id.ok() ? Error{} : id.error();
}

static void expect_at(const Vec<3>& at, float x, float y, float z) {
  EXPECT_EQ(at[0], x);
  EXPECT_EQ(at[1], y);
  EXPECT_EQ(at[2], z);
}

// A square in the ground plane, cut along its diagonal, and a third triangle that folds up.
static const std::vector<Vec<3>> kPoints = {
    {{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 1}}, {{1, 0, 0}}, {{2, 1, 0}}};

TEST(Mesh, GivesEachTriangleItsNormalAndTheCornersAcrossItsEdges) {
  const std::vector<Shape<3>> shapes =
      records(mesh(kPoints, {{{0, 1, 2}}, {{0, 2, 3}}, {{3, 2, 4}}}));
  ASSERT_EQ(shapes.size(), 3u);
  for (const Shape<3>& shape : shapes) {
    EXPECT_EQ(shape.kind, ShapeKind::kTriangle);
    EXPECT_EQ(shape.vertex_count, 3u);
    EXPECT_EQ(length(shape.half), 0.0f);
    EXPECT_NEAR(length(shape.normal), 1.0f, 1e-6f);
  }
  expect_at(shapes[0].normal, 0.0f, 1.0f, 0.0f);
  // Of the first, only its third edge, from 2 to 0, has a neighbour, whose far corner is 3.
  EXPECT_EQ(shapes[0].ghosts, 4u);
  expect_at(shapes[0].vertices[5], 1.0f, 0.0f, 0.0f);
  // Of the second the first edge meets 1, the second, from 2 to 3, meets 4.
  EXPECT_EQ(shapes[1].ghosts, 3u);
  expect_at(shapes[1].vertices[3], 0.0f, 0.0f, 1.0f);
  expect_at(shapes[1].vertices[4], 2.0f, 1.0f, 0.0f);
  EXPECT_EQ(shapes[2].ghosts, 1u);
  expect_at(shapes[2].vertices[3], 0.0f, 0.0f, 0.0f);
  const float half_root = std::sqrt(0.5f);
  EXPECT_NEAR(shapes[2].normal[0], -half_root, 1e-6f);
  EXPECT_NEAR(shapes[2].normal[1], half_root, 1e-6f);
}

TEST(Mesh, EdgesOfThreeTrianglesOrOfTwoThatRunTheSameWayHaveNoGhosts) {
  const std::vector<Vec<3>> points = {
      {{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 0}}, {{-1, 0, 0}}, {{0, 1, 0}}};
  // All three have the edge between 0 and 1.
  for (const Shape<3>& shape : records(mesh(points, {{{0, 1, 2}}, {{1, 0, 3}}, {{1, 0, 4}}})))
    EXPECT_EQ(shape.ghosts, 0u);
  // Two sheets that face opposite ways.
  for (const Shape<3>& shape : records(mesh(points, {{{0, 1, 2}}, {{0, 1, 3}}})))
    EXPECT_EQ(shape.ghosts, 0u);
  for (const Shape<3>& shape : records(mesh(points, {{{0, 1, 2}}, {{1, 0, 3}}})))
    EXPECT_EQ(shape.ghosts, 1u);
}

TEST(Mesh, OfAClosedSurfaceHasAGhostAcrossEveryEdge) {
  const std::vector<Vec<3>> points = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
  const std::vector<Shape<3>> shapes =
      records(mesh(points, {{{0, 2, 1}}, {{0, 1, 3}}, {{0, 3, 2}}, {{1, 2, 3}}}));
  const Vec<3> inside = {{0.1f, 0.1f, 0.1f}};
  for (const Shape<3>& shape : shapes) {
    EXPECT_EQ(shape.ghosts, 7u);
    EXPECT_LT(dot(shape.normal, inside - shape.vertices[0]), 0.0f);
    // A convex body: every far corner lies behind.
    for (std::size_t k = 3; k < 6; ++k)
      EXPECT_LT(dot(shape.normal, shape.vertices[k] - shape.vertices[0]), 0.0f);
  }
}

TEST(Mesh, RefusesWhatHasNoAreaOrPointsElsewhere) {
  EXPECT_STREQ(error_of(mesh(kPoints, {})).field, "triangles");
  EXPECT_STREQ(error_of(mesh(kPoints, {{{0, 1, 5}}})).field, "triangles");
  EXPECT_STREQ(error_of(mesh(kPoints, {{{0, 1, 0xffffffffu}}})).field, "triangles");
  EXPECT_STREQ(error_of(mesh(kPoints, {{{0, 1, 2}}, {{0, 1, 1}}})).field, "triangles");
  std::vector<Vec<3>> thin = kPoints;
  thin[1] = {{0.5f, 0.0f, 0.00005f}};
  EXPECT_STREQ(error_of(mesh(thin, {{{0, 1, 3}}})).field, "triangles");
  thin[1] = {{0.5f, 0.0f, 0.0002f}};
  EXPECT_TRUE(error_of(mesh(thin, {{{0, 1, 3}}})).ok());
  EXPECT_STREQ(error_of(mesh({kPoints[0], kPoints[1]}, {{{0, 1, 0}}})).field, "points");
  EXPECT_STREQ(error_of(mesh(kPoints, {{{0, 1, 2}}}), BodyKind::kDynamic).field, "kind");
  ShapeDef<3> round = mesh(kPoints, {{{0, 1, 2}}});
  round.radius = 0.1f;
  EXPECT_STREQ(error_of(round).field, "radius");
}

TEST(Mesh, CountsAsOneShapePerTriangle) {
  WorldDef<3> def;
  def.limits.shapes = 2;
  World<3> world = make_world(def);
  BodyDef<3> body;
  body.kind = BodyKind::kStatic;
  const ShapeDef<3> three = mesh(kPoints, {{{0, 1, 2}}, {{0, 2, 3}}, {{3, 2, 4}}});
  const Error error = world.create_body(body, std::span(&three, 1)).error();
  EXPECT_EQ(error.code, Code::kCapacity);
  EXPECT_STREQ(error.field, "limits.shapes");
  const BodyId id = add(world, body, mesh(kPoints, {{{0, 1, 2}}, {{0, 2, 3}}}));
  EXPECT_EQ(world.state().shapes.size(), 2u);
  EXPECT_TRUE(validate(world.state()).ok());
  EXPECT_TRUE(world.destroy_body(id).ok());
  EXPECT_EQ(world.state().free_shapes.size(), 2u);
}

TEST(HeightField, HasTwoTrianglesPerCellFreeAbove) {
  ShapeDef<3> def = height_field(3, {0, 1, 2, 3, 4, 5});
  def.points = {{{10, 20, 30}}};
  const std::vector<Shape<3>> shapes = records(def);
  ASSERT_EQ(shapes.size(), 4u);
  // Cell (0, 0): the triangle towards the next row, then the one towards the next column.
  expect_at(shapes[0].vertices[0], 10.0f, 20.0f, 30.0f);
  expect_at(shapes[0].vertices[1], 10.0f, 23.0f, 32.0f);
  expect_at(shapes[0].vertices[2], 10.5f, 24.0f, 32.0f);
  expect_at(shapes[1].vertices[0], 10.0f, 20.0f, 30.0f);
  expect_at(shapes[1].vertices[1], 10.5f, 24.0f, 32.0f);
  expect_at(shapes[1].vertices[2], 10.5f, 21.0f, 30.0f);
  // The plane y = 2 x + 1.5 z: all normals are equal, all ghosts lie in it.
  for (const Shape<3>& shape : shapes) {
    EXPECT_GT(shape.normal[1], 0.0f);
    EXPECT_NEAR(shape.normal[0] / shape.normal[1], -2.0f, 1e-5f);
    EXPECT_NEAR(shape.normal[2] / shape.normal[1], -1.5f, 1e-5f);
    EXPECT_NE(shape.ghosts, 0u);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec<3> far_corner = shape.vertices[(shape.ghosts >> k & 1u) != 0 ? 3 + k : k];
      EXPECT_NEAR(dot(shape.normal, far_corner - shape.vertices[0]), 0.0f, 1e-5f);
    }
  }
  // The diagonal of a cell, and the side that both cells have.
  EXPECT_EQ(shapes[0].ghosts, 4u);
  EXPECT_EQ(shapes[1].ghosts, 3u);
  EXPECT_EQ(shapes[2].ghosts, 5u);
  EXPECT_EQ(shapes[3].ghosts, 1u);
}

TEST(HeightField, LeavesOutGhostsAtItsRimAlone) {
  const std::vector<Shape<3>> shapes = records(height_field(40, std::vector<float>(40 * 30, 1.0f)));
  ASSERT_EQ(shapes.size(), 2u * 39u * 29u);
  std::map<unsigned, int> counts;
  for (const Shape<3>& shape : shapes)
    for (unsigned k = 0; k < 3; ++k) counts[shape.ghosts >> k & 1u] += 1;
  EXPECT_EQ(counts[0], 2 * 39 + 2 * 29);
}

TEST(HeightField, NamesTheFieldThatIsWrong) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_STREQ(error_of(height_field(1, {0, 0, 0, 0})).field, "columns");
  EXPECT_STREQ(error_of(height_field(0, {0, 0, 0, 0})).field, "columns");
  EXPECT_STREQ(error_of(height_field(2, {0, 0})).field, "heights");
  EXPECT_STREQ(error_of(height_field(2, {0, 0, 0, 0, 0})).field, "heights");
  EXPECT_STREQ(error_of(height_field(2, {0, 0, nan, 0})).field, "heights");
  EXPECT_STREQ(error_of(height_field(2, {0, 0, 2.0e6f, 0})).field, "heights");
  for (const float bad : {0.0f, -1.0f, nan, 2.0e6f}) {
    ShapeDef<3> def = height_field(2, {0, 0, 0, 0});
    def.cell[1] = bad;
    EXPECT_STREQ(error_of(def).field, "cell");
  }
  ShapeDef<3> def = height_field(2, {0, 0, 0, 0});
  def.points = {{{0, 0, 0}}, {{1, 0, 0}}};
  EXPECT_STREQ(error_of(def).field, "points");
  EXPECT_STREQ(error_of(height_field(2, {0, 0, 0, 0}), BodyKind::kKinematic).field, "kind");
  EXPECT_TRUE(error_of(height_field(2, {0, 0, 0, 0})).ok());
}

}  // namespace cycloid::solver
