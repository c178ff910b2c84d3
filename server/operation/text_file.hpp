#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace cycloid::server {

/// No configuration and no secret is larger.
inline constexpr std::size_t kTextFileBytesMax = 16 << 20;

/// The bytes of a regular file; nothing where it cannot be read or is larger than
/// `kTextFileBytesMax`. What is no regular file, such as a folder, a device without an end or a
/// pipe into which nobody writes, is not read, nor waited for.
std::optional<std::string> read_text_file(const std::string& path);

}  // namespace cycloid::server
