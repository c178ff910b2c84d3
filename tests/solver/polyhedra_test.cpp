#include "solver/solids/polyhedra.hpp"

#include <gtest/gtest.h>

#include "solver/bytes.hpp"
#include "solver/solids/validate_polyhedra.hpp"
#include "solver/validate.hpp"
#include "solver/visit.hpp"
#include "tests/solver/hull_fixture.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static std::vector<std::byte> encoded(const World<3>& world) {
  std::vector<std::byte> bytes;
  world.encode(bytes);
  return bytes;
}

static void expect_equal_views(const PolyhedronView& a, const PolyhedronView& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  ASSERT_EQ(a.faces.size(), b.faces.size());
  ASSERT_EQ(a.edges.size(), b.edges.size());
  for (std::size_t i = 0; i < a.vertices.size(); ++i)
    EXPECT_EQ(length(a.vertices[i].position - b.vertices[i].position), 0.0f);
  for (std::size_t i = 0; i < a.faces.size(); ++i)
    EXPECT_EQ(length(a.faces[i].normal - b.faces[i].normal), 0.0f);
  for (std::size_t i = 0; i < a.edges.size(); ++i) EXPECT_EQ(a.edges[i].next, b.edges[i].next);
}

TEST(Polyhedra, EqualHullsShareARecordAndReleaseMovesTheOthersDown) {
  PolyhedronData box, octahedron, prism;
  ASSERT_TRUE(build_polyhedron(box_points(1, 2, 3), box).ok());
  ASSERT_TRUE(build_polyhedron(octahedron_points(1), octahedron).ok());
  ASSERT_TRUE(build_polyhedron(prism_points(6, 1, 1), prism).ok());
  Polyhedra pools;
  EXPECT_EQ(intern(box.view(), pools), 0u);
  EXPECT_EQ(intern(octahedron.view(), pools), 1u);
  EXPECT_EQ(intern(box.view(), pools), 0u);
  EXPECT_EQ(intern(prism.view(), pools), 2u);
  EXPECT_EQ(pools.records[0].references, 2u);
  EXPECT_EQ(pools.vertices.size(), 8u + 6u + 12u);
  EXPECT_EQ(pools.edges.size(), 24u + 24u + 36u);

  release(0, pools);
  EXPECT_EQ(pools.vertices.size(), 26u);
  release(0, pools);
  EXPECT_EQ(pools.vertices.size(), 18u);
  EXPECT_EQ(pools.records[0].references, 0u);
  EXPECT_EQ(pools.records[0].vertex_count, 0u);
  EXPECT_EQ(pools.records[1].first_vertex, 0u);
  expect_equal_views(view_of(pools, 1), octahedron.view());
  expect_equal_views(view_of(pools, 2), prism.view());

  // The lowest free slot, at the end of the pools.
  EXPECT_EQ(intern(box.view(), pools), 0u);
  EXPECT_EQ(pools.records[0].first_vertex, 18u);
  release(1, pools);
  expect_equal_views(view_of(pools, 0), box.view());
  expect_equal_views(view_of(pools, 2), prism.view());
  release(2, pools);
  release(0, pools);
  EXPECT_TRUE(pools.vertices.empty() && pools.faces.empty() && pools.edges.empty());
}

TEST(Polyhedra, AHullIsAboutTheMiddleOfItsBox) {
  World<3> world = make_world<3>();
  Points points = box_points(1.0f, 2.0f, 3.0f);
  for (Vec<3>& p : points) p += Vec<3>{{10.0f, 0.0f, -4.0f}};
  const BodyId id = add(world, BodyDef<3>{}, hull_def(points));
  const Body<3>& body = world.state().bodies[id.index];
  const Shape<3>& shape = world.state().shapes[body.first_shape];
  EXPECT_EQ(shape.vertex_count, 1u);
  EXPECT_NEAR(length(body.local_center - Vec<3>{{10.0f, 0.0f, -4.0f}}), 0.0f, 1e-5f);
  EXPECT_NEAR(length(shape.vertices[0]), 0.0f, 1e-5f);
  EXPECT_EQ(shape.half[2], 3.0f);
  EXPECT_NEAR(body.extent, std::sqrt(14.0f), 1e-5f);
  EXPECT_EQ(body.thickness, 1.0f);
  for (const PolyhedronVertex& vertex : world.state().polyhedra.vertices)
    EXPECT_EQ(std::abs(vertex.position[1]), 2.0f);
}

TEST(Polyhedra, ABodyDestroyedAndMadeAgainLeavesTheSameHulls) {
  World<3> world = make_world<3>();
  add(world, BodyDef<3>{}, hull_def(octahedron_points(1.0f)));
  const BodyId boxes[2] = {add(world, BodyDef<3>{}, hull_def(box_points(1, 2, 3))),
                           add(world, BodyDef<3>{}, hull_def(box_points(1, 2, 3)))};
  EXPECT_EQ(world.state().polyhedra.records.size(), 2u);
  EXPECT_EQ(world.state().polyhedra.records[1].references, 2u);
  const std::vector<std::byte> before = encoded(world);
  const WorldState<3> saved = world.state();

  ASSERT_TRUE(world.destroy_body(boxes[1]).ok());
  EXPECT_EQ(world.state().polyhedra.records[1].references, 1u);
  ASSERT_TRUE(world.destroy_body(boxes[0]).ok());
  EXPECT_EQ(world.state().polyhedra.vertices.size(), 6u);
  EXPECT_TRUE(validate(world.state()).ok());
  add(world, BodyDef<3>{}, hull_def(box_points(1, 2, 3)));
  add(world, BodyDef<3>{}, hull_def(box_points(1, 2, 3)));
  // All but the generations of the two bodies is as before.
  WorldState<3> again = world.state();
  for (const BodyId id : boxes)
    again.bodies.edit_one(id.index, [&](Body<3>& body) { body.generation = id.generation; });
  world.restore(again);
  EXPECT_EQ(encoded(world), before);
  world.restore(saved);
  EXPECT_EQ(encoded(world), before);
}

TEST(Polyhedra, ARefusedBodyLeavesNoHull) {
  WorldDef<3> def;
  def.limits.shapes = 2;
  World<3> world = make_world(def);
  add(world, BodyDef<3>{}, hull_def(box_points(1, 1, 1)));
  const std::vector<std::byte> before = encoded(world);
  const ShapeDef<3> good = hull_def(octahedron_points(1.0f));
  ShapeDef<3> flat = hull_def(box_points(1.0f, 0.0f, 1.0f));
  const std::vector<ShapeDef<3>> bad = {good, flat};
  const Error error = world.create_body(BodyDef<3>{}, bad).error();
  EXPECT_EQ(error.code, Code::kInvalid);
  EXPECT_STREQ(error.field, "points");
  EXPECT_EQ(error.index, 1);
  const std::vector<ShapeDef<3>> many = {good, good};
  EXPECT_EQ(world.create_body(BodyDef<3>{}, many).error().code, Code::kCapacity);
  BodyDef<3> light;
  light.mass = -1.0f;
  EXPECT_FALSE(world.create_body(light, std::span(&good, 1)).ok());
  EXPECT_EQ(encoded(world), before);
}

/// Hulls with a free slot before and between them, in another order than their records.
static World<3> world_with_free_slots() {
  World<3> world = make_world(with_gravity<3>());
  add_ground<3>(world, up<3>());
  std::vector<BodyId> ids;
  for (const Points& points : {box_points(0.5f, 0.5f, 0.5f), octahedron_points(0.5f),
                               prism_points(5, 0.5f, 0.5f), icosahedron_points(0.3f)})
    ids.push_back(
        add_at<3>(world, {{2.0f * static_cast<float>(ids.size()), 0.6f, 0.0f}}, hull_def(points)));
  EXPECT_TRUE(world.destroy_body(ids[0]).ok());
  EXPECT_TRUE(world.destroy_body(ids[2]).ok());
  add_at<3>(world, {{0.0f, 2.0f, 0.0f}}, hull_def(box_points(0.4f, 0.5f, 0.6f)));
  add_at<3>(world, {{0.1f, 0.5f, 0.0f}}, hull_def(box_points(0.4f, 0.5f, 0.6f)));
  return world;
}

TEST(Polyhedra, GoOnBitForBitFromBytes) {
  World<3> world = world_with_free_slots();
  step(world, 5);
  World<3> other = make_world<3>();
  ASSERT_TRUE(other.decode(encoded(world)).ok());
  EXPECT_EQ(encoded(other), encoded(world));
  step(world, 20);
  step(other, 20);
  EXPECT_EQ(other.digest(), world.digest());
  expect_equal_views(view_of(other.state().polyhedra, 1), view_of(world.state().polyhedra, 1));
}

TEST(Polyhedra, EveryFlippedByteIsRefusedOrStepsWithoutHarm) {
  const World<3> world = world_with_free_slots();
  const std::vector<std::byte> good = encoded(world);
  World<3> other = make_world<3>();
  int stepped = 0;
  for (std::size_t i = 0; i < good.size(); ++i)
    for (const unsigned mask : {0x01u, 0x80u, 0xffu}) {
      std::vector<std::byte> flipped = good;
      flipped[i] ^= static_cast<std::byte>(mask);
      if (!other.decode(flipped).ok()) continue;
      ++stepped;
      (void)other.step();
      (void)other.step();
    }
  EXPECT_GT(stepped, 1000);
}

/// What is wrong with the hulls of a state after `change`; "" where nothing is.
template <class Change>
static std::string judged(Change change) {
  WorldState<3> state = world_with_free_slots().state();
  change(state.polyhedra);
  const Error error = validate_polyhedra(state);
  EXPECT_TRUE(error.ok() || error.code == Code::kCorrupt);
  return error.field;
}

TEST(Polyhedra, EveryWrongIndexOfASnapshotIsCorrupt) {
  EXPECT_EQ(judged([](Polyhedra&) {}), "");
  std::size_t words = 0;
  const auto count = [&](auto& value) {
    words += std::is_integral_v<std::decay_t<decltype(value)>>;
  };
  WorldState<3> state = world_with_free_slots().state();
  const auto walk = [](Polyhedra& p, auto&& f) {
    for (Polyhedron& record : p.records) visit_words(record, f);
    for (PolyhedronVertex& vertex : p.vertices) visit_words(vertex, f);
    for (PolyhedronFace& face : p.faces) visit_words(face, f);
    for (PolyhedronEdge& edge : p.edges) visit_words(edge, f);
  };
  walk(state.polyhedra, count);
  ASSERT_GT(words, 400u);
  for (std::size_t target = 0; target < words; ++target)
    for (const std::uint32_t wrong : {1u, 2u, 0x40u, 0x80000000u}) {
      std::size_t at = 0;
      EXPECT_EQ(judged([&](Polyhedra& p) {
                  walk(p, [&](auto& value) {
                    if constexpr (std::is_integral_v<std::decay_t<decltype(value)>>)
                      if (at++ == target) value ^= wrong;
                  });
                }),
                "polyhedron")
          << target << " " << wrong;
    }
}

TEST(Polyhedra, WrongNumbersAndLeftoversOfASnapshotAreCorrupt) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(judged([&](Polyhedra& p) { p.vertices[3].position[1] = nan; }), "polyhedron");
  EXPECT_EQ(judged([&](Polyhedra& p) { p.vertices[3].position[1] += 1.0f; }), "polyhedron");
  EXPECT_EQ(judged([&](Polyhedra& p) { p.faces[3].normal[1] = nan; }), "polyhedron");
  EXPECT_EQ(judged([&](Polyhedra& p) { p.faces[3].normal = Vec<3>::zero(); }), "polyhedron");
  EXPECT_EQ(judged([&](Polyhedra& p) { p.faces[3].offset = nan; }), "polyhedron");
  EXPECT_EQ(judged([&](Polyhedra& p) { p.faces[3].offset -= 0.1f; }), "polyhedron");
  EXPECT_EQ(judged([&](Polyhedra& p) { p.faces.emplace_back(); }), "polyhedron");
  EXPECT_EQ(judged([&](Polyhedra& p) { p.edges.pop_back(); }), "polyhedron");
  EXPECT_EQ(judged([&](Polyhedra& p) { p.records.clear(); }), "polyhedron");
  WorldState<2> plane;
  EXPECT_TRUE(validate_polyhedra(plane).ok());
  plane.polyhedra.records.emplace_back();
  EXPECT_EQ(validate_polyhedra(plane).code, Code::kCorrupt);
}

}  // namespace cycloid::solver
