#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

namespace cycloid::server {

/// Reads the fields of a JSON object, and remembers the first mistake. A field that nobody asked
/// for is one too.
class AdminFields {
 public:
  /// @param body  "" is an object without fields.
  explicit AdminFields(const std::string& body);

  std::string text(const char* name);  ///< Must be there.
  std::string text_or(const char* name, const char* otherwise);
  std::uint64_t number(const char* name, std::uint64_t most);  ///< Must be there; from 0.
  std::uint64_t number_or(const char* name, std::uint64_t otherwise, std::uint64_t most);
  void complain(const std::string& mistake);
  /// "", or the first mistake as a sentence that begins with the field's name.
  std::string mistake();

  const nlohmann::json& all() const { return fields_; }

 private:
  const nlohmann::json* find(const char* name, bool needed);
  std::string text_of(const char* name, const nlohmann::json& value);
  std::uint64_t number_of(const char* name, const nlohmann::json& value, std::uint64_t most);

  nlohmann::json fields_ = nlohmann::json::object();
  std::set<std::string> asked_;
  std::string mistake_;
};

}  // namespace cycloid::server
