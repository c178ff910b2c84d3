#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/catalogue.hpp"

namespace cycloid::scenes {

/// The parts of one kind by the names that others refer to them with. A part with a mistake of its
/// own keeps its name, so that the mistake is said once and not again of all that refer to it.
template <class Value>
class NameTable {
 public:
  /// @param kind  As in "names no body".
  NameTable(std::string kind, std::vector<Mistake>& mistakes)
      : kind_(std::move(kind)), mistakes_(mistakes) {}

  /// @param path  Of the part. @param value  Nothing: the part has a mistake.
  void add(const std::string& name, const std::string& path, std::optional<Value> value) {
    if (name.empty() || values_.emplace(name, std::move(value)).second) return;
    complain(path + "/name", "is the name of an earlier " + kind_ + ": '" + name + "'");
  }

  /// Null, with a mistake, where no part has the name; null where that part has a mistake.
  const Value* find(const std::string& name, const std::string& path) {
    const auto found = values_.find(name);
    if (found != values_.end()) return found->second ? &*found->second : nullptr;
    complain(path, "names no " + kind_ + ": '" + name + "'");
    return nullptr;
  }

 private:
  void complain(std::string path, std::string reason) {
    mistakes_.push_back({std::move(path), std::move(reason)});
  }

  std::string kind_;
  std::vector<Mistake>& mistakes_;
  std::map<std::string, std::optional<Value>> values_;
};

}  // namespace cycloid::scenes
