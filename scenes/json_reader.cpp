#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "scenes/accuracy.hpp"
#include "scenes/catalogue.hpp"
#include "scenes/fields.hpp"
#include "scenes/zero_signs.hpp"

namespace cycloid::scenes {

using Json = nlohmann::json;

static constexpr std::size_t kTextBytesMax = 64u << 20;
static constexpr std::size_t kDepthMax = 16;

/// Changes of one letter that lead from a to b.
static std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

/// Reads one JSON object into a part of a scene and collects every mistake below it.
class JsonReader {
 public:
  JsonReader(const Json& object, std::string path, std::vector<Mistake>& mistakes)
      : object_(object), path_(std::move(path)), mistakes_(mistakes) {}

  template <HasFields Part>
  void read_part(Part& part) {
    if (!object_.is_object()) return complain(path_, "has to be an object");
    fields(part, *this);
    for (const auto& [key, value] : object_.items())
      if (std::find(known_.begin(), known_.end(), key) == known_.end()) complain_unknown(key);
  }

  template <class T>
  void operator()(const char* name, T& field) {
    known_.emplace_back(name);
    const auto found = object_.find(name);
    if (found == object_.end()) return;
    if constexpr (std::is_same_v<T, std::array<float, 4>>) {
      if (is_quaternion(name) && found->is_array() && found->size() != 4)
        return complain(path_ + "/" + name, "has to be 4 numbers: the quaternion x, y, z, w");
    }
    read(*found, path_ + "/" + name, field);
  }

 private:
  void complain(const std::string& path, std::string reason) {
    mistakes_.push_back({path, std::move(reason)});
  }

  void complain_unknown(const std::string& key) {
    // The names of fields are short; comparing one of megabytes with all takes minutes.
    constexpr std::size_t kKeyBytesMax = 64;
    if (key.size() > kKeyBytesMax || mistakes_.size() >= kMistakesMax)
      return complain(path_ + "/" + key.substr(0, kKeyBytesMax), "is not a field here");
    const auto nearest =
        std::min_element(known_.begin(), known_.end(), [&](const auto& a, const auto& b) {
          return edit_distance(key, a) < edit_distance(key, b);
        });
    const bool close = edit_distance(key, *nearest) <= 1 + key.size() / 4;
    complain(path_ + "/" + key,
             close ? "is not a field here; is '" + *nearest + "' meant?" : "is not a field here");
  }

  void read(const Json& json, const std::string& path, float& field) {
    if (!json.is_number()) return complain(path, "has to be a number");
    const double value = json.get<double>();
    if (!(std::abs(value) <= double{std::numeric_limits<float>::max()}))
      return complain(path, "has to be finite in 32 bits");
    field = static_cast<float>(value);
  }

  template <class Integer>
  requires std::is_integral_v<Integer> &&
      (!std::is_same_v<Integer, bool>)void read(const Json& json, const std::string& path,
                                                Integer& field) {
    if (!json.is_number_integer()) return complain(path, "has to be a whole number");
    const bool fits = json.is_number_unsigned()
                          ? json.get<std::uint64_t>() <=
                                static_cast<std::uint64_t>(std::numeric_limits<Integer>::max())
                          : std::is_signed_v<Integer> &&
                                json.get<std::int64_t>() >=
                                    static_cast<std::int64_t>(std::numeric_limits<Integer>::min());
    if (!fits) return complain(path, "is out of range");
    field = json.get<Integer>();
  }

  void read(const Json& json, const std::string& path, bool& field) {
    if (!json.is_boolean()) return complain(path, "has to be true or false");
    field = json.get<bool>();
  }

  void read(const Json& json, const std::string& path, std::string& field) {
    if (!json.is_string()) return complain(path, "has to be a string");
    field = json.get<std::string>();
  }

  template <class Enum>
  requires std::is_enum_v<Enum>
  void read(const Json& json, const std::string& path, Enum& field) {
    std::string allowed;
    for (const auto& [name, value] : Names<Enum>::kAll) {
      if (json.is_string() && json.get<std::string>() == name) {
        field = value;
        return;
      }
      allowed += (allowed.empty() ? "" : ", ") + std::string(name);
    }
    complain(path, "has to be one of " + allowed);
  }

  /// Vectors may leave out trailing zeros: two numbers do in the plane. Not quaternions, of which
  /// the last number is hardly ever 0.
  template <std::size_t N>
  void read(const Json& json, const std::string& path, std::array<float, N>& field) {
    if (!json.is_array() || json.empty() || json.size() > N)
      return complain(path, "has to be an array of 1 to " + std::to_string(N) + " numbers");
    field = {};
    for (std::size_t i = 0; i < json.size(); ++i)
      read(json[i], path + "/" + std::to_string(i), field[i]);
  }

  /// Indices are given in full.
  template <std::size_t N>
  void read(const Json& json, const std::string& path, std::array<std::uint32_t, N>& field) {
    if (!json.is_array() || json.size() != N)
      return complain(path, "has to be an array of " + std::to_string(N) + " whole numbers");
    for (std::size_t i = 0; i < N; ++i) read(json[i], path + "/" + std::to_string(i), field[i]);
  }

  template <class Element>
  void read(const Json& json, const std::string& path, std::vector<Element>& field) {
    if (!json.is_array()) return complain(path, "has to be an array");
    field.clear();
    for (std::size_t i = 0; i < json.size() && mistakes_.size() < kMistakesMax; ++i)
      read(json[i], path + "/" + std::to_string(i), field.emplace_back());
  }

  template <HasFields Part>
  void read(const Json& json, const std::string& path, Part& part) {
    JsonReader inner(json, path, mistakes_);
    inner.read_part(part);
  }

  const Json& object_;
  std::string path_;
  std::vector<Mistake>& mistakes_;
  std::vector<std::string> known_;
};

/// Watches the parser for what the library lets pass: keys given twice, and depth.
class ParseGuard : public nlohmann::json_sax<Json> {
 public:
  explicit ParseGuard(std::vector<Mistake>& mistakes) : mistakes_(mistakes) {}

  bool null() override { return take_value(); }
  bool boolean(bool) override { return take_value(); }
  bool number_integer(std::int64_t) override { return take_value(); }
  bool number_unsigned(std::uint64_t) override { return take_value(); }
  bool number_float(double, const std::string&) override { return take_value(); }
  bool string(std::string&) override { return take_value(); }
  bool binary(Json::binary_t&) override { return take_value(); }

  bool start_object(std::size_t) override { return begin_level(false); }
  bool start_array(std::size_t) override { return begin_level(true); }
  bool end_object() override { return end_level(); }
  bool end_array() override { return end_level(); }

  bool key(std::string& key) override {
    if (!is_within_depth()) return false;
    levels_.back().key = key;
    if (!levels_.back().keys.insert(key).second && mistakes_.size() < kMistakesMax)
      mistakes_.push_back({path(), "is given twice in one object"});
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const Json::exception& error) override {
    // The library numbers what is out of range from 401 on, and nothing else.
    if (error.id / 100 == 4) {
      mistakes_.push_back({path(), "is out of range"});
      return false;
    }
    // The library's sentence holds line and column; its "[json.exception...]" tag says nothing.
    const std::string what = error.what();
    const std::size_t tag = what.find("] ");
    mistakes_.push_back({"", tag == std::string::npos ? what : what.substr(tag + 2)});
    return false;
  }

 private:
  /// An array or object that is not at its end.
  struct Level {
    bool is_array = false;
    std::size_t index = 0;
    std::string key;
    std::set<std::string> keys;
  };

  /// Of what is being read.
  std::string path() const {
    std::string path;
    for (const Level& level : levels_)
      path += "/" + (level.is_array ? std::to_string(level.index) : level.key);
    return path;
  }

  bool is_within_depth() {
    if (levels_.size() <= kDepthMax) return true;
    mistakes_.push_back({"", "is nested deeper than a scene can be"});
    return false;
  }

  bool take_value() {
    go_on();
    return is_within_depth();
  }

  bool begin_level(bool is_array) {
    if (!is_within_depth()) return false;
    levels_.push_back({is_array, 0, "", {}});
    return true;
  }

  bool end_level() {
    levels_.pop_back();
    go_on();
    return true;
  }

  void go_on() {
    if (!levels_.empty()) ++levels_.back().index;
  }

  std::vector<Mistake>& mistakes_;
  std::vector<Level> levels_;
};

Loaded from_json(std::string_view text, Untuned untuned) {
  Loaded loaded;
  if (text.size() > kTextBytesMax) {
    loaded.mistakes.push_back({"", "is larger than 64 MiB"});
    return loaded;
  }
  ParseGuard guard(loaded.mistakes);
  Json::sax_parse(text, &guard);
  if (!loaded.mistakes.empty()) return loaded;
  const Json json = Json::parse(text);
  Scene scene;
  JsonReader reader(json, "", loaded.mistakes);
  reader.read_part(scene);
  if (loaded.mistakes.empty() && json.contains("accuracy") && !states_accuracy(scene))
    loaded.mistakes.push_back({"/accuracy", "has to state error_m or error_percent"});
  drop_zero_signs(scene);
  if (loaded.mistakes.empty()) loaded.mistakes = check(scene, untuned);
  if (loaded.mistakes.empty()) loaded.scene = std::move(scene);
  return loaded;
}

}  // namespace cycloid::scenes
