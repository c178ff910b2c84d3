#include <gtest/gtest.h>

#include <algorithm>

#include "scenes/catalogue.hpp"

namespace cycloid::scenes {

/// A scene of space with one shape of every kind that only space has.
static constexpr const char* kSolids = R"({
  "name": "solids", "dimension": 3, "gravity": [0, -10],
  "bodies": [
    {"kind": "static", "shapes": [
      {"kind": "height_field", "columns": 3, "heights": [0, 0.5, 0, 0, 0.25, 0], "cell": [1, 2],
       "points": [[-1, 0, -1]]},
      {"kind": "mesh", "points": [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]],
       "triangles": [[0, 1, 2], [0, 2, 3]]}]},
    {"name": "crate", "position": [0, 3], "shapes": [
      {"kind": "box", "half": [0.5, 0.25, 0.125], "rotation": [0, 0.6, 0, 0.8], "points": [[1]]},
      {"kind": "hull", "density": 2,
       "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.125, 0.125, 0.125]]}]}],
  "prefabs": [{"name": "die", "shapes": [{"kind": "box", "half": [0.125, 0.125, 0.125]}]}]
})";

static Scene solids() {
  Loaded loaded = from_json(kSolids);
  for (const Mistake& mistake : loaded.mistakes)
    ADD_FAILURE() << mistake.path << ": " << mistake.reason;
  return loaded.scene.value_or(Scene{});
}

TEST(Solids, AreTheSameAfterJsonAndBinary) {
  const Scene scene = solids();
  const std::string json = to_json(scene);
  for (const char* part :
       {R"("kind":"box")", R"("half":[0.5,0.25,0.125])", R"("rotation":[0.0,0.6,0.0,0.8])",
        R"("kind":"hull")", R"("kind":"mesh")", R"("triangles":[[0,1,2],[0,2,3]])",
        R"("kind":"height_field")", R"("heights":[0.0,0.5,0.0,0.0,0.25,0.0])", R"("columns":3)",
        R"("cell":[1.0,2.0])"})
    EXPECT_NE(json.find(part), std::string::npos) << part << " in\n" << json;
  const Loaded again = from_json(json);
  ASSERT_TRUE(again.scene);
  EXPECT_EQ(to_json(*again.scene), json);
  const std::vector<std::byte> binary = to_binary(scene);
  const Loaded unpacked = from_binary(binary);
  ASSERT_TRUE(unpacked.scene);
  EXPECT_EQ(to_json(*unpacked.scene), json);
  EXPECT_EQ(to_binary(*unpacked.scene), binary);
  EXPECT_EQ(unpacked.scene->bodies[1].shapes[1].points.size(), 5u);
  EXPECT_EQ(scene_digest(*unpacked.scene), scene_digest(scene));
}

TEST(Solids, BecomeTheShapesOfTheWorld) {
  const Scene scene = solids();
  solver::Result<Simulation> simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation.ok());
  const solver::WorldState<3>& state = simulation.value().spatial()->state();
  std::vector<int> counts(16);
  for (const solver::Shape<3>& shape : state.shapes) ++counts[static_cast<std::size_t>(shape.kind)];
  EXPECT_EQ(counts[static_cast<std::size_t>(solver::ShapeKind::kTriangle)], 4 + 2);
  EXPECT_EQ(counts[static_cast<std::size_t>(solver::ShapeKind::kBox)], 1);
  EXPECT_EQ(counts[static_cast<std::size_t>(solver::ShapeKind::kHull)], 1);
  ASSERT_EQ(state.polyhedra.records.size(), 1u);
  EXPECT_EQ(state.polyhedra.vertices.size(), 4u);
  // The box has 8 * 0.5 * 0.25 * 0.125 m^3 of 1 kg/m^3, the corner of a cube 1/6 of 2.
  EXPECT_NEAR(state.bodies[1].mass, 0.125f + 1.0f / 3.0f, 1e-6f);
}

TEST(Solids, EveryFieldIsPartOfWhatTheSceneMeans) {
  const std::uint64_t digest = scene_digest(solids());
  Scene scene = solids();
  scene.bodies[1].shapes[0].half[1] = 0.5f;
  EXPECT_NE(scene_digest(scene), digest);
  scene = solids();
  scene.bodies[1].shapes[0].rotation = {0, 0, 0, 1};
  EXPECT_NE(scene_digest(scene), digest);
  scene = solids();
  std::swap(scene.bodies[0].shapes[1].triangles[0], scene.bodies[0].shapes[1].triangles[1]);
  EXPECT_NE(scene_digest(scene), digest);
  scene = solids();
  scene.bodies[0].shapes[0].heights[1] = 1.0f;
  EXPECT_NE(scene_digest(scene), digest);
  scene = solids();
  scene.bodies[0].shapes[0].cell[1] = 1.0f;
  EXPECT_NE(scene_digest(scene), digest);
  scene = solids();
  scene.bodies[0].shapes[0].columns = 2;
  EXPECT_NE(scene_digest(scene), digest);
  scene = solids();
  scene.prefabs[0].shapes[0].half[0] = 0.25f;
  EXPECT_NE(scene_digest(scene), digest);
}

struct WrongShape {
  const char* shape;
  const char* field;
  const char* reason;
};

TEST(Solids, MistakesNameTheFieldAndWhatItHasToBe) {
  const WrongShape wrongs[] = {
      {R"({"kind": "hull", "points": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]]})", "points",
       "span a volume"},
      {R"({"kind": "hull", "points": [[0,0,0],[1,0,0],[0,1,0]]})", "points", "4 to 256 points"},
      {R"({"kind": "hull", "radius": 0.1, "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]]})", "radius",
       "hull has none"},
      {R"({"kind": "box", "half": [1, 0, 1]})", "half", "positive"},
      {R"({"kind": "box", "half": [1, 1, 1], "rotation": [0, 0, 0, 2]})", "rotation", "length 1"},
      {R"({"kind": "box", "half": [1, 1, 1], "points": [[0], [1]]})", "points", "one finite point"},
      {R"({"kind": "mesh", "points": [[0],[1]], "triangles": [[0, 1, 0]]})", "points",
       "three finite points"},
      {R"({"kind": "mesh", "points": [[0],[1],[0,1]], "triangles": [[0, 1, 3]]})", "triangles",
       "three different points"},
      {R"({"kind": "mesh", "points": [[0],[1],[2]], "triangles": [[0, 1, 2]]})", "triangles",
       "span an area"},
      {R"({"kind": "mesh", "points": [[0],[1],[0,1]], "triangles": [[0, 1]]})", "triangles/0",
       "3 whole numbers"},
      {R"({"kind": "mesh", "points": [[0],[1],[0,1]], "triangles": [[0, 1, -2]]})", "triangles/0/2",
       "out of range"},
      {R"({"kind": "height_field", "columns": 1, "heights": [0, 0], "cell": [1, 1]})", "columns",
       "2 or more"},
      {R"({"kind": "height_field", "columns": 2, "heights": [0, 0, 0], "cell": [1, 1]})", "heights",
       "whole rows"},
      {R"({"kind": "height_field", "columns": 2, "heights": [0, 0, 0, 0]})", "cell", "positive"},
      {R"({"kind": "polygon", "points": [[0],[1],[0,1]]})", "kind", "use box or hull"},
  };
  for (const WrongShape& wrong : wrongs) {
    const Loaded loaded =
        from_json(std::string(R"({"dimension": 3, "bodies": [{"kind": "static", "shapes": [)") +
                  wrong.shape + "]}]}");
    EXPECT_FALSE(loaded.scene) << wrong.shape;
    const std::string path = std::string("/bodies/0/shapes/0/") + wrong.field;
    std::string all;
    bool found = false;
    for (const Mistake& mistake : loaded.mistakes) {
      all += mistake.path + ": " + mistake.reason + "\n";
      found =
          found || (mistake.path == path && mistake.reason.find(wrong.reason) != std::string::npos);
    }
    EXPECT_TRUE(found) << wrong.shape << "\ngave\n" << all;
  }
  const Loaded plane =
      from_json(R"({"bodies": [{"shapes": [{"kind": "box", "half": [1, 1, 1]}]}]})");
  ASSERT_EQ(plane.mistakes.size(), 1u);
  EXPECT_EQ(plane.mistakes[0].path, "/bodies/0/shapes/0/kind");
  EXPECT_EQ(plane.mistakes[0].reason, "box is of dimension 3 only: in dimension 2 use polygon");
}

TEST(Solids, EveryBitFlipOfABinaryFileIsRefusedOrAScene) {
  const std::vector<std::byte> good = to_binary(solids());
  int scenes = 0;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::vector<std::byte> flipped = good;
    flipped[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
    const Loaded loaded = from_binary(flipped);
    EXPECT_NE(loaded.scene.has_value(), !loaded.mistakes.empty()) << bit;
    if (loaded.scene) ++scenes;
  }
  EXPECT_GT(scenes, 1000);
}

}  // namespace cycloid::scenes
