#include "server/operation/text_file.hpp"

#include <fstream>

namespace cycloid::server {

std::optional<std::string> read_text_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string text;
  char part[4096];
  while (stream.read(part, sizeof part) || stream.gcount() > 0) {
    text.append(part, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kTextFileBytesMax) return std::nullopt;
  }
  if (!stream.eof()) return std::nullopt;
  return text;
}

}  // namespace cycloid::server
