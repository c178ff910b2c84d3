#include <gtest/gtest.h>

#include <string>

#include "tests/scenes/said.hpp"

namespace cycloid::scenes {

TEST(Rotations, AreFourNumbersInJsonWhateverTheyAre) {
  const auto body = [](const std::string& rotation) {
    return R"({"dimension": 3, "bodies": [{"kind": "static", "rotation": )" + rotation + "}]}";
  };
  for (const char* rotation : {"[1]", "[0, 0, 1]", "[0, 0, 0, 1, 0]"})
    EXPECT_EQ(said(body(rotation)),
              "/bodies/0/rotation: has to be 4 numbers: the quaternion x, y, z, w\n");
  const Loaded loaded = from_json(body("[1, 0, 0, 0]"));
  ASSERT_TRUE(loaded.scene);
  EXPECT_NE(to_json(*loaded.scene).find(R"("rotation":[1.0,0.0,0.0,0.0])"), std::string::npos);
  EXPECT_TRUE(from_json(to_json(*loaded.scene)).scene);
}

}  // namespace cycloid::scenes
