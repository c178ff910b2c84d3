#include <charconv>
#include <nlohmann/json.hpp>

#include "scenes/catalogue.hpp"
#include "scenes/fields.hpp"

namespace cycloid::scenes {

/// Keys in the order of the fields.
using Json = nlohmann::ordered_json;

/// The double that is written as the shortest decimal which reads back as this float. By the JSON
/// library, because libc++ 19 has no from_chars of a double, and strtod follows the locale.
static double shortest(float value) {
  char text[32];
  const char* end = std::to_chars(text, text + sizeof text, value).ptr;
  const Json number = Json::parse(static_cast<const char*>(text), end, nullptr, false);
  return number.is_number() ? number.get<double>() : static_cast<double>(value);
}

static Json json_of(float value) {
  return shortest(value);
}
static Json json_of(bool value) {
  return value;
}
static Json json_of(const std::string& value) {
  return value;
}
template <class Integer>
requires std::is_integral_v<Integer>
static Json json_of(Integer value) {
  return value;
}
template <class Enum>
requires std::is_enum_v<Enum>
static Json json_of(Enum value) {
  const std::string_view name = name_of(value);
  return name.empty() ? "unknown" : std::string(name);
}

/// Trailing zeros are left out, down to two numbers: a planar scene shows planar vectors. Those of
/// a quaternion are put back.
template <std::size_t N>
static Json json_of(const std::array<float, N>& values) {
  std::size_t count = N;
  while (count > 2 && values[count - 1] == 0.0f) --count;
  Json array = Json::array();
  for (std::size_t i = 0; i < count; ++i) array.push_back(shortest(values[i]));
  return array;
}

template <std::size_t N>
static Json json_of(const std::array<std::uint32_t, N>& values) {
  return Json(values);
}

template <HasFields Part>
static Json json_of(const Part& part);

template <class Element>
static Json json_of(const std::vector<Element>& elements) {
  Json array = Json::array();
  for (const Element& element : elements) array.push_back(json_of(element));
  return array;
}

/// Fields that hold their default are left out.
template <HasFields Part>
static Json json_of(const Part& part) {
  Part copy = part;
  Part defaults;
  std::vector<Json> default_values;
  fields(defaults, [&](const char*, auto& field) { default_values.push_back(json_of(field)); });
  Json object = Json::object();
  std::size_t i = 0;
  fields(copy, [&](const char* name, auto& field) {
    Json value = json_of(field);
    if (is_quaternion(name) && value != default_values[i])
      while (value.size() < 4) value.push_back(0.0);
    if (value != default_values[i++]) object[name] = std::move(value);
  });
  return object;
}

std::string to_json(const Scene& scene) {
  // A line per body, joint, seat and so on: a file that a person can read and that diffs well.
  const Json json = json_of(scene);
  std::string text = "{";
  for (const auto& [key, value] : json.items()) {
    text += (text.size() == 1 ? "\n  " : ",\n  ") + Json(key).dump() + ": ";
    const bool list = value.is_array() && !value.empty() && value[0].is_object();
    if (!list) {
      text += value.dump();
      continue;
    }
    text += "[";
    for (std::size_t i = 0; i < value.size(); ++i)
      text += (i == 0 ? "\n    " : ",\n    ") + value[i].dump();
    text += "\n  ]";
  }
  return text + "\n}\n";
}

}  // namespace cycloid::scenes
