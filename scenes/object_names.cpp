#include "scenes/object_names.hpp"

#include <array>

#include "scenes/characters.hpp"

namespace cycloid::scenes {
namespace {

std::string quoted(const std::string& name) {
  return name.empty() ? "" : " '" + name + "'";
}

/// Word `word` of a character in so many dimensions, in the order of `kCharacterRegisters`.
RegisterUse character_use(std::uint32_t word, std::uint32_t dimension) {
  static constexpr std::array<const char*, 3> kGround = {"grounded", "ground.index + 1",
                                                         "ground.generation"};
  const auto axis = [](const char* name, std::uint32_t i) {
    return std::string(name) + "[" + std::to_string(i) + "]";
  };
  const std::uint32_t ground = 2 * dimension;
  if (word < dimension) return {"", axis("position", word), true};
  if (word < ground) return {"", axis("velocity", word - dimension), true};
  if (word < ground + 3) return {"", kGround[word - ground], false};
  return {"", axis("ground_velocity", word - ground - 3), true};
}

RegisterUse spawn_use(std::uint32_t word) {
  if (word == 0) return {"", "next place", false};
  const std::string place = "place " + std::to_string((word - 1) / 2);
  return {"", place + (word % 2 == 1 ? ": index + 1" : ": generation"), false};
}

}  // namespace

RegisterUse register_use(const Scene& scene, std::uint32_t index) {
  if (index < scene.seats.size()) return {"seat " + std::to_string(index), "buttons", false};
  std::uint32_t first = static_cast<std::uint32_t>(scene.seats.size());
  for (std::size_t seat = 0; seat < scene.seats.size(); ++seat) {
    for (const Control& control : scene.seats[seat].controls) {
      if (control.effect != Effect::kSpawn) continue;
      const std::uint32_t words = 1 + 2 * control.limit;
      if (index - first < words) {
        RegisterUse use = spawn_use(index - first);
        use.owner = "spawn list of seat " + std::to_string(seat) + quoted(control.target);
        return use;
      }
      first += words;
    }
  }
  const std::uint32_t words =
      scene.dimension == 2 ? kCharacterRegisters<2> : kCharacterRegisters<3>;
  const std::uint32_t character = (index - first) / words;
  if (character >= scene.characters.size()) return {};
  RegisterUse use = character_use((index - first) % words, scene.dimension);
  use.owner = "character " + std::to_string(character) + quoted(scene.characters[character].name);
  return use;
}

std::string scene_name_of(const Scene& scene, const std::string& kind, std::uint32_t slot,
                          std::uint32_t generation) {
  if (generation != 0) return "";
  if (kind == "body" && slot < scene.bodies.size()) return scene.bodies[slot].name;
  if (kind == "joint" && slot < scene.joints.size()) return scene.joints[slot].name;
  return "";
}

}  // namespace cycloid::scenes
