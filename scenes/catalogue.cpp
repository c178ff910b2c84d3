#include "scenes/catalogue.hpp"

#include <charconv>
#include <fstream>
#include <iterator>

#include "scenes/embedded.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/trials.hpp"

namespace cycloid::scenes {

/// A rule with one parameter, and the built-in scene that is its default.
struct Generator {
  std::string_view name;
  std::string_view scene;
  std::string_view parameter;
  int standard;
  int least;
  int most;
  Scene (*make)(int);
};

static constexpr Generator kGenerators[] = {
    {"pyramid", "pyramid-20", "base", 20, 1, 400, pyramid},
    {"stack", "stack-10", "count", 10, 1, 1000, stack},
    {"card-house", "card-house", "storeys", 5, 1, 20, card_house},
    {"bridge", "bridge", "planks", 40, 2, 1000, bridge},
    {"ball-pit-3d", "ball-pit-3d", "balls", 150, 1, 10000, ball_pit},
    {"room", "room-200", "bodies", 200, 9, 5000, room},
    {"ragdolls", "ragdolls", "count", 6, 1, 100, ragdolls},
    {"chain-and-ball", "chain-and-ball", "links", 40, 1, 400, chain_and_ball},
    {"overlap", "overlap", "base", 4, 1, 100, overlap},
    {"cloth", "cloth", "columns", 16, 3, 100, cloth},
    {"cloth-3d", "cloth-3d", "columns", 16, 3, 100, cloth_3d},
    {"bouncing", "bouncing", "discs", 20, 1, 100, bouncing},
    {"stack-3d", "stack-10-3d", "count", 10, 1, 1000, stack_3d},
    {"pyramid-3d", "pyramid-3d", "layers", 10, 1, 40, pyramid_3d},
    {"wall", "wall", "courses", 12, 1, 100, wall},
    {"arch-3d", "arch-3d", "stones", 13, 5, 101, arch_3d},
    {"cubes", "cubes-901", "side", 30, 1, 100, cubes},
    {"bridge-3d", "bridge-3d", "planks", 24, 2, 1000, bridge_3d},
    {"ragdolls-3d", "ragdolls-3d", "count", 6, 1, 100, ragdolls_3d},
};

static Loaded mistake(std::string reason) {
  Loaded loaded;
  loaded.mistakes.push_back({"", std::move(reason)});
  return loaded;
}

static Loaded checked(Scene scene) {
  Loaded loaded;
  loaded.mistakes = check(scene);
  if (loaded.mistakes.empty()) loaded.scene = std::move(scene);
  return loaded;
}

std::vector<CatalogueEntry> catalogue() {
  std::vector<CatalogueEntry> entries;
  for (const EmbeddedScene& embedded : embedded_scenes()) {
    CatalogueEntry entry;
    entry.name = embedded.name;
    const Loaded loaded = from_json(embedded.json);
    if (loaded.scene) entry.summary = loaded.scene->summary;
    for (const Generator& generator : kGenerators)
      if (generator.scene == embedded.name)
        entry.parameters = std::string(generator.name) + ":" + std::string(generator.parameter) +
                           "=" + std::to_string(generator.standard) + " (" +
                           std::to_string(generator.least) + " to " +
                           std::to_string(generator.most) + ")";
    entries.push_back(std::move(entry));
  }
  return entries;
}

static Loaded generate(const Generator& generator, std::string_view setting) {
  const std::string wanted = std::string(generator.parameter) + "=N with N from " +
                             std::to_string(generator.least) + " to " +
                             std::to_string(generator.most);
  const std::size_t equals = setting.find('=');
  if (equals == std::string_view::npos || setting.substr(0, equals) != generator.parameter)
    return mistake("'" + std::string(setting) + "' is no parameter of " +
                   std::string(generator.name) + "; it takes " + wanted);
  const std::string_view digits = setting.substr(equals + 1);
  int value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole = error == std::errc() && end == digits.data() + digits.size();
  if (!whole || value < generator.least || value > generator.most)
    return mistake("'" + std::string(digits) + "' is out of range; " + std::string(generator.name) +
                   " takes " + wanted);
  return checked(generator.make(value));
}

Loaded find(std::string_view name) {
  const std::size_t colon = name.find(':');
  if (colon != std::string_view::npos) {
    for (const Generator& generator : kGenerators)
      if (generator.name == name.substr(0, colon))
        return generate(generator, name.substr(colon + 1));
    return mistake("'" + std::string(name.substr(0, colon)) + "' takes no parameters");
  }
  for (const EmbeddedScene& embedded : embedded_scenes())
    if (embedded.name == name) return from_json(embedded.json);
  for (const Trial& trial : trials())
    if (trial.name == name) return checked(trial.make());
  std::string known;
  for (const EmbeddedScene& embedded : embedded_scenes())
    known += (known.empty() ? "" : ", ") + std::string(embedded.name);
  return mistake("there is no built-in scene '" + std::string(name) + "'; there are " + known);
}

Loaded load_file(const std::string& file, Untuned untuned) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return mistake("cannot be read");
  stream.seekg(0, std::ios::end);
  const std::streamoff size = stream.tellg();
  if (size < 0) return mistake("cannot be read");
  stream.seekg(0);
  // A directory opens as a file does, and is of any size.
  if (size != 0 && stream.peek() == std::ifstream::traits_type::eof())
    return mistake("is a directory, or cannot be read");
  if (size > (64 << 20)) return mistake("is larger than 64 MiB");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size)))
    return mistake("cannot be read");
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return mistake("is empty");
  if (bytes[first] == '{') return from_json(bytes, untuned);
  return from_binary(std::as_bytes(std::span(bytes)), untuned);
}

Loaded load(const std::string& what, Untuned untuned) {
  if (std::ifstream(what).good()) return load_file(what, untuned);
  return find(what);
}

std::vector<Scene> generated_defaults() {
  std::vector<Scene> scenes = {half_pipe(),
                               newtons_cradle(),
                               ragdoll_motors(),
                               vehicle(),
                               machines(),
                               beads(),
                               rolling(),
                               heavy_on_light(),
                               dzhanibekov(),
                               top(),
                               vehicle_3d(),
                               character_course(),
                               character_course_3d(),
                               within_a_millimetre()};
  for (Scene& scene : method_scenes()) scenes.push_back(std::move(scene));
  for (const Generator& generator : kGenerators)
    scenes.push_back(generator.make(generator.standard));
  return scenes;
}

}  // namespace cycloid::scenes
