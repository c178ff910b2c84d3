#include "server/config/config.hpp"

// What toml++ 3.3 takes for granted does not hold of a header such as "[=": where NDEBUG is defined
// anything may happen then, and where it is not the program ends. Asked neither to assume nor to
// assert, it reads on and says what is wrong.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(expression) static_assert(true)
#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "server/config/checks.hpp"
#include "server/config/keys.hpp"
#include "server/operation/text_file.hpp"

namespace cycloid::server {
namespace {

/// Numbers count in thousandths: what is less would be taken for 0.
constexpr double kNumberStep = 0.001;

std::uint32_t line_of(const toml::node& node) {
  return static_cast<std::uint32_t>(node.source().begin.line);
}

std::string number_text(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

const char* type_text(toml::node_type type) {
  switch (type) {
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::table:
      return "a table";
    default:
      return "a date or time";
  }
}

template <class Target>
std::string range_text(const ConfigKey<Target>& key) {
  switch (key.kind) {
    case ConfigKind::kInteger:
    case ConfigKind::kNumber:
      return number_text(key.least) + " to " + number_text(key.most);
    case ConfigKind::kFlag:
      return "true, false";
    case ConfigKind::kText:
    case ConfigKind::kNeededText:
      break;
  }
  std::string text;
  for (const std::string& choice : key.choices) text += (text.empty() ? "" : ", ") + choice;
  return text.empty() ? "text" : text;
}

/// Reads one file, and collects what is wrong with it.
class Reader {
 public:
  explicit Reader(const SceneLoader& load_scene) : load_scene_(load_scene) {}

  ConfigResult read(std::string_view text) {
    if (!check_ascii(text)) return finish();
    toml::parse_result parsed = toml::parse(text);
    if (!parsed) {
      const toml::parse_error& error = parsed.error();
      complain(static_cast<std::uint32_t>(error.source().begin.line), "",
               "not TOML: " + std::string(error.description()));
      return finish();
    }
    const toml::table& root = parsed.table();
    for (const ConfigSection& section : config_sections()) {
      read_table(root.get(section.name), section.name, section.keys, config_);
    }
    read_templates(root.get("template"));
    read_rooms(root.get("room"));
    refuse_unknown_tables(root);
    check_whole();
    return finish();
  }

 private:
  /// toml++ 3.3 runs into undefined behaviour where it asks whether U+00E9 is a space.
  bool check_ascii(std::string_view text) {
    const auto other = std::ranges::find_if(text, [](char c) { return (c & 0x80) != 0; });
    if (other == text.end()) return true;
    const auto line = 1 + std::count(text.begin(), other, '\n');
    complain(static_cast<std::uint32_t>(line), "",
             "a character that is not ASCII; within quotes, write it as \\u00e9");
    return false;
  }

  void complain(std::uint32_t line, std::string key, std::string reason) {
    mistakes_.emplace(line, ConfigMistake{line, std::move(key), std::move(reason)});
  }

  ConfigResult finish() {
    ConfigResult result;
    for (auto& [line, mistake] : mistakes_) result.mistakes.push_back(std::move(mistake));
    if (mistakes_.empty()) result.config = std::move(config_);
    return result;
  }

  template <class Target>
  bool read_value(const toml::node& node, const ConfigKey<Target>& key, const std::string& name,
                  ConfigValue& value) {
    const auto wrong_type = [&](const char* wanted) {
      complain(line_of(node), name,
               std::string("it is ") + type_text(node.type()) + ", and must be " + wanted);
      return false;
    };
    switch (key.kind) {
      case ConfigKind::kInteger:
        if (!node.is_integer()) return wrong_type("an integer");
        value.integer = node.as_integer()->get();
        value.number = static_cast<double>(value.integer);
        break;
      case ConfigKind::kNumber:
        if (!node.is_number()) return wrong_type("a number");
        value.number = *node.value<double>();
        if (value.number <= 0 || value.number >= kNumberStep) break;
        complain(line_of(node), name, "it is not 0 and less than " + number_text(kNumberStep));
        return false;
      case ConfigKind::kFlag:
        if (!node.is_boolean()) return wrong_type("true or false");
        value.flag = node.as_boolean()->get();
        return true;
      case ConfigKind::kText:
      case ConfigKind::kNeededText:
        if (!node.is_string()) return wrong_type("a string");
        value.text = node.as_string()->get();
        return check_text(node, key, name, value.text);
    }
    if (value.number >= key.least && value.number <= key.most) return true;  // A NaN is not.
    complain(line_of(node), name,
             "it is " + number_text(value.number) + ", and must be " + range_text(key));
    return false;
  }

  template <class Target>
  bool check_text(const toml::node& node, const ConfigKey<Target>& key, const std::string& name,
                  const std::string& text) {
    if (text.find('\0') != std::string::npos) {
      complain(line_of(node), name, "it holds a zero byte");
      return false;
    }
    if (key.kind == ConfigKind::kNeededText && text.empty()) {
      complain(line_of(node), name, "it is empty");
      return false;
    }
    if (key.choices.empty() || std::ranges::count(key.choices, text) > 0) return true;
    complain(line_of(node), name, "it is \"" + text + "\", and must be one of " + range_text(key));
    return false;
  }

  /// What a key is where the file does not say.
  template <class Target>
  static ConfigValue value_otherwise(const ConfigKey<Target>& key) {
    ConfigValue value;
    value.text = key.otherwise;
    value.flag = value.text == "true";
    if (key.kind == ConfigKind::kInteger) value.integer = std::stoll(value.text);
    if (key.kind == ConfigKind::kNumber) value.number = std::stod(value.text);
    return value;
  }

  template <class Target>
  static std::string text_of(const ConfigKey<Target>& key, const ConfigValue& value) {
    switch (key.kind) {
      case ConfigKind::kInteger:
        return std::to_string(value.integer);
      case ConfigKind::kNumber:
        return number_text(value.number);
      case ConfigKind::kFlag:
        return value.flag ? "true" : "false";
      case ConfigKind::kText:
      case ConfigKind::kNeededText:
        break;
    }
    return value.text;
  }

  template <class Target>
  void read_table(const toml::node* node, const std::string& path,
                  const std::vector<ConfigKey<Target>>& keys, Target& target) {
    const toml::table* table = node == nullptr ? nullptr : node->as_table();
    if (node != nullptr && table == nullptr) {
      return complain(line_of(*node), path,
                      std::string("it is ") + type_text(node->type()) + ", and must be a table");
    }
    for (const ConfigKey<Target>& key : keys) {
      const std::string name = path + "." + key.name;
      const toml::node* found = table == nullptr ? nullptr : table->get(key.name);
      ConfigValue value = value_otherwise(key);
      if (found == nullptr && key.kind == ConfigKind::kNeededText) {
        complain(node == nullptr ? 0 : line_of(*node), name, "it is missing");
        continue;
      }
      if (found != nullptr && !read_value(*found, key, name, value)) continue;
      key.put(target, value);
      config_.values[name] = text_of(key, value);
      if (found != nullptr) lines_[name] = line_of(*found);
    }
    if (table != nullptr) refuse_unknown_keys(*table, path, keys);
  }

  template <class Target>
  void refuse_unknown_keys(const toml::table& table, const std::string& path,
                           const std::vector<ConfigKey<Target>>& keys) {
    for (const auto& [name, value] : table) {
      const std::string_view word = name.str();
      const auto is_it = [word](const ConfigKey<Target>& key) { return key.name == word; };
      if (std::ranges::none_of(keys, is_it)) {
        complain(line_of(value), path + "." + std::string(word), "there is no such key");
      }
    }
  }

  void refuse_unknown_tables(const toml::table& root) {
    std::set<std::string_view> known = {"template", "room"};
    for (const ConfigSection& section : config_sections()) known.insert(section.name);
    for (const auto& [name, value] : root) {
      if (known.contains(name.str())) continue;
      complain(line_of(value), std::string(name.str()), "there is no such key or table");
    }
  }

  void read_templates(const toml::node* node) {
    if (node == nullptr) return;
    const toml::table* tables = node->as_table();
    if (tables == nullptr) {
      return complain(line_of(*node), "template", "it must be tables: [template.NAME]");
    }
    for (const auto& [key, value] : *tables) {
      const std::string name(key.str());
      const std::string path = "template." + name;
      std::string why = room_name_mistake(name);
      if (name.find(':') != std::string::npos) why = "the name of a template has no colon";
      if (!why.empty()) complain(line_of(value), path, why);
      RoomTemplate made;
      read_table(&value, path, config_template_keys(), made);
      load_scene(made, path, line_of(value));
      const std::string& directory = made.settings.log_directory;
      std::error_code unknown;  // A name that is too long is no directory either.
      if (!directory.empty() && !std::filesystem::is_directory(directory, unknown)) {
        complain(lines_[path + ".log_directory"], path + ".log_directory",
                 directory + " is no directory");
      }
      config_.host.templates.emplace(name, std::move(made));
    }
  }

  void load_scene(RoomTemplate& made, const std::string& path, std::uint32_t line) {
    const std::string& name = made.settings.scene_name;
    if (name.empty()) return;  // Said already.
    scenes::Loaded loaded = load_scene_(name);
    if (loaded.scene) {
      made.settings.scene = std::move(*loaded.scene);
      made.settings.scene_name = made.settings.scene.name;
      return;
    }
    const auto at = lines_.find(path + ".scene");
    for (const scenes::Mistake& mistake : loaded.mistakes) {
      complain(at == lines_.end() ? line : at->second, path + ".scene",
               "\"" + name + "\": " + (mistake.path.empty() ? "" : mistake.path + ": ") +
                   mistake.reason);
    }
  }

  void read_rooms(const toml::node* node) {
    if (node == nullptr) return;
    const toml::array* rooms = node->as_array();
    if (rooms == nullptr) {
      return complain(line_of(*node), "room", "it must be tables in an array: [[room]]");
    }
    std::set<std::string> names;
    for (std::size_t i = 0; i < rooms->size(); ++i) {
      const toml::node& value = *rooms->get(i);
      const std::string path = "room." + std::to_string(i);
      ConfigRoom room;
      read_table(&value, path, config_room_keys(), room);
      if (room.name.empty() || room.of_template.empty()) continue;  // Said already.
      const std::string why = room_name_mistake(room.name);
      if (!why.empty()) complain(lines_[path + ".name"], path + ".name", why);
      if (!names.insert(room.name).second) {
        complain(lines_[path + ".name"], path + ".name", "two rooms are called " + room.name);
      }
      const auto found = config_.host.templates.find(room.of_template);
      if (found == config_.host.templates.end()) {
        complain(lines_[path + ".template"], path + ".template",
                 "there is no [template." + room.of_template + "]");
        continue;
      }
      config_.host.rooms.push_back({room.name, found->second.settings});
    }
  }

  void check_whole() {
    const auto complain_of = [this](const std::string& key, std::string reason) {
      const auto at = lines_.find(key);
      complain(at == lines_.end() ? 0 : at->second, key, std::move(reason));
    };
    check_config(config_, complain_of);
  }

  const SceneLoader& load_scene_;
  ServerConfig config_;
  std::multimap<std::uint32_t, ConfigMistake> mistakes_;  ///< By line, then as they were found.
  std::map<std::string, std::uint32_t> lines_;
};

template <class Target>
void add_texts(const std::string& path, const std::vector<ConfigKey<Target>>& keys,
               std::vector<ConfigKeyText>& texts) {
  for (const ConfigKey<Target>& key : keys) {
    const bool needed = key.kind == ConfigKind::kNeededText;
    texts.push_back(
        {path + "." + key.name, range_text(key), needed ? "needed" : key.otherwise, key.reloads});
  }
}

}  // namespace

ConfigResult read_config(std::string_view text, const SceneLoader& load_scene) {
  return Reader(load_scene).read(text);
}

ConfigResult read_config_file(const std::string& path, const SceneLoader& load_scene) {
  if (const auto text = read_text_file(path)) return read_config(*text, load_scene);
  ConfigResult result;
  result.mistakes.push_back({0, "", "the file cannot be read"});
  return result;
}

std::vector<ConfigKeyText> config_keys() {
  std::vector<ConfigKeyText> texts;
  for (const ConfigSection& section : config_sections()) {
    add_texts(section.name, section.keys, texts);
  }
  add_texts("template.NAME", config_template_keys(), texts);
  add_texts("room", config_room_keys(), texts);
  return texts;
}

}  // namespace cycloid::server
