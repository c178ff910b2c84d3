#pragma once

#include <cstdint>

#include "server/config/keys.hpp"

namespace cycloid::server {

/// The section [limits].
ConfigSection config_limits();

namespace config_keys_of {

using Value = ConfigValue;

inline constexpr double kManySeconds = 86400.0;
inline constexpr double kMany = 1'000'000'000.0;

template <class Number>
Number as(const Value& value) {
  return static_cast<Number>(value.integer);
}

inline ConfigKey<ServerConfig> integer(const char* name, double least, double most,
                                       const char* otherwise, bool reloads,
                                       void (*put)(ServerConfig&, const Value&)) {
  return {name, ConfigKind::kInteger, least, most, otherwise, {}, reloads, put};
}

}  // namespace config_keys_of
}  // namespace cycloid::server
