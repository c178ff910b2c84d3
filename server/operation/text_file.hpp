#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace cycloid::server {

/// No configuration and no secret is larger.
inline constexpr std::size_t kTextFileBytesMax = 16 << 20;

/// The bytes of a file; nothing where it cannot be read, as a folder cannot, or is larger than
/// `kTextFileBytesMax`, as a device without an end is.
std::optional<std::string> read_text_file(const std::string& path);

}  // namespace cycloid::server
