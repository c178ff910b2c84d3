#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "scenes/catalogue.hpp"

namespace cycloid::scenes {

/// All that is said of a scene, a line each.
static std::string said(const std::vector<Mistake>& mistakes) {
  std::string text;
  for (const Mistake& mistake : mistakes) text += mistake.path + ": " + mistake.reason + "\n";
  return text;
}
static std::string said(std::string_view json) {
  return said(from_json(json).mistakes);
}

TEST(Mistakes, OfAPartIsNotSaidAgainOfAllThatNameIt) {
  EXPECT_EQ(said(R"({"bodies": [
      {"name": "a", "shapes": [{"radius": 0}]},
      {"name": "b", "shapes": [{"radius": 1}]}],
    "joints": [{"name": "j", "body_a": "a", "body_b": "b", "motor": "speed"}],
    "cloths": [{"across": [1], "pins": [{"body": "a"}]}],
    "prefabs": [{"name": "p", "shapes": [{"radius": -1}]}],
    "seats": [{"controls": [
      {"target": "a", "value": [1]},
      {"effect": "motor_speed", "target": "j", "value": [1]},
      {"source": "button", "effect": "spawn", "target": "p"}]}]})"),
            "/bodies/0/shapes/0/radius: has to be positive and finite\n"
            "/prefabs/0/shapes/0/radius: has to be positive and finite\n");
  EXPECT_EQ(said(R"({"bodies": [{"name": "a"}, {"name": "a", "kind": "static"}],
                     "joints": [{"body_a": "a", "body_b": "c"}]})"),
            "/bodies/0/mass: has to be positive, or the shapes have to give it\n"
            "/bodies/1/name: is the name of an earlier body: 'a'\n"
            "/joints/0/body_b: names no body: 'c'\n");
}

}  // namespace cycloid::scenes
