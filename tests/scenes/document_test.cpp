#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "scenes/fields.hpp"
#include "tests/places.hpp"
#include "tests/scenes/said.hpp"

namespace cycloid::scenes {

using Words = std::set<std::string>;

/// What stands in backticks below a heading of docs/scenes.md.
struct Section {
  Words words;
  Words rows;  ///< Of these what stands in the first column of a table.
};
struct Page {
  std::map<std::string, Section> sections;
  std::string example;
};

static void take_words(const std::string& text, Words& words) {
  static const std::regex kWord("`([a-z_]+)`");
  for (std::sregex_iterator at(text.begin(), text.end(), kWord), end; at != end; ++at)
    words.insert((*at)[1]);
}

static Page read_page() {
  static const std::regex kHeading("^#+ (.*)$");
  static const std::regex kRow(R"(^\| (`[^|]*) \|.*)");
  std::ifstream stream(places::source("docs/scenes.md"));
  Page page;
  std::string heading;
  bool in_example = false;
  for (std::string line; std::getline(stream, line);) {
    std::smatch match;
    if (line.starts_with("```")) {
      in_example = line == "```json";
    } else if (in_example) {
      page.example += line + "\n";
    } else if (std::regex_match(line, match, kHeading)) {
      heading = match[1];
    } else {
      take_words(line, page.sections[heading].words);
      if (std::regex_match(line, match, kRow)) take_words(match[1], page.sections[heading].rows);
    }
  }
  return page;
}

template <class... Part>
static Words keys_of() {
  Words keys;
  const auto take = [&](auto part) {
    fields(part, [&](const char* key, auto&) { keys.insert(key); });
  };
  (take(Part{}), ...);
  return keys;
}

template <class Enum>
static Words names_of() {
  Words names;
  for (const auto& [name, value] : Names<Enum>::kAll) names.emplace(name);
  return names;
}

TEST(SceneDocument, ListsEveryKey) {
  const std::map<std::string, Words> known = {{"Scene", keys_of<Scene, SceneAccuracy>()},
                                              {"Materials", keys_of<SceneMaterial>()},
                                              {"Bodies", keys_of<SceneBody>()},
                                              {"Shapes", keys_of<SceneShape, solver::Filter>()},
                                              {"Kinds of shapes", names_of<solver::ShapeKind>()},
                                              {"Joints", keys_of<SceneJoint>()},
                                              {"Kinds of joints", names_of<solver::JointKind>()},
                                              {"Cloths", keys_of<Cloth, ClothPin>()},
                                              {"Characters", keys_of<SceneCharacter>()},
                                              {"Seats", keys_of<Seat>()},
                                              {"Controls", keys_of<Control>()},
                                              {"Effects", names_of<Effect>()},
                                              {"Script", keys_of<ScriptEntry>()},
                                              {"Limits", keys_of<solver::Limits>()},
                                              {"Tuning", keys_of<solver::Tuning>()}};
  Page page = read_page();
  for (const auto& [heading, names] : known) {
    const Section& section = page.sections[heading];
    for (const std::string& name : names)
      EXPECT_TRUE(section.words.contains(name)) << heading << " lacks " << name;
    for (const std::string& name : section.rows)
      EXPECT_TRUE(names.contains(name)) << heading << " has a row for " << name;
  }
}

TEST(SceneDocument, ItsExampleIsGoodAndPlays) {
  const Loaded loaded = from_json(read_page().example);
  ASSERT_EQ(said(loaded.mistakes), "");
  const Scene& scene = *loaded.scene;
  EXPECT_TRUE(!scene.joints.empty() && !scene.cloths.empty() && !scene.characters.empty());
  EXPECT_TRUE(!scene.seats.empty() && !scene.seats[0].controls.empty());
  solver::Result<Simulation> simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation.ok());
  const std::vector<Pose> before = simulation.value().poses();
  for (std::uint64_t tick = 1; tick <= 300; ++tick) {
    const SeatInput input = scripted_input(scene, 0, tick);
    ASSERT_TRUE(simulation.value().step(std::span(&input, 1)).ok()) << tick;
  }
  const std::vector<Pose> after = simulation.value().poses();
  EXPECT_GT(after.size(), before.size()) << "no crate has come";
  EXPECT_NE(after[1].position[1], before[1].position[1]) << "the beam stands still";
}

}  // namespace cycloid::scenes
