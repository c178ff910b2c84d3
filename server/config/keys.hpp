#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/config/config.hpp"

namespace cycloid::server {

/// The value of a key, in the member that its kind says.
struct ConfigValue {
  std::int64_t integer = 0;
  double number = 0.0;
  bool flag = false;
  std::string text;
};

enum class ConfigKind : std::uint8_t { kInteger, kNumber, kFlag, kText, kNeededText };

/// What a file says of a room: its name, and which template it is made of.
struct ConfigRoom {
  std::string name;
  std::string of_template;
};

/// A key of a table whose values go into a `Target`.
template <class Target>
struct ConfigKey {
  const char* name;  ///< Within its table: "port".
  ConfigKind kind;
  double least;  ///< Of an integer or a number.
  double most;
  const char* otherwise;             ///< As text; "" where there is none.
  std::vector<std::string> choices;  ///< Of a text; none: any.
  bool reloads;
  void (*put)(Target&, const ConfigValue&);
};

/// A table of the file, such as [server].
struct ConfigSection {
  const char* name;
  std::vector<ConfigKey<ServerConfig>> keys;
};

const std::vector<ConfigSection>& config_sections();
/// Of [template.NAME].
const std::vector<ConfigKey<RoomTemplate>>& config_template_keys();
/// Of [[room]].
const std::vector<ConfigKey<ConfigRoom>>& config_room_keys();

}  // namespace cycloid::server
