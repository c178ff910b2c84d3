#include "cli/output.hpp"

#include <cerrno>
#include <fstream>
#include <iostream>
#include <iterator>
#include <system_error>
#include <utility>

#include "cli/files.hpp"
#include "cli/visible.hpp"
#include "scenes/golden.hpp"

namespace cycloid::cli {

void print_json(Json object, Exit exit) {
  object["exit"] = static_cast<int>(exit);
  // A name in a scene may hold any bytes; what is not UTF-8 must not end the program.
  std::cout << object.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
}

void print_member(const std::string& name, const Json& value) {
  std::cout << name << ' '
            << (value.is_string() ? visible(value.get_ref<const std::string&>()) : value.dump())
            << '\n';
}

static std::ifstream open_file(const std::string& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    const std::string why = errno == 0 ? "" : ": " + std::generic_category().message(errno);
    throw Failure(kExitIo, file + ": cannot be opened" + why);
  }
  // Only now: of a folder that may not be opened, that is what is wrong.
  if (kind_of(file).is_folder) throw Failure(kExitIo, file + ": is a directory");
  return stream;
}

std::vector<std::byte> read_file(const std::string& file) {
  std::ifstream stream = open_file(file);
  const std::string text((std::istreambuf_iterator<char>(stream)),
                         std::istreambuf_iterator<char>());
  if (stream.bad()) throw Failure(kExitIo, file + ": cannot be read");
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

std::vector<std::byte> read_beginning(const std::string& file, std::size_t bytes_max) {
  std::ifstream stream = open_file(file);
  std::vector<std::byte> bytes(bytes_max);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes_max));
  if (stream.bad()) throw Failure(kExitIo, file + ": cannot be read");
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

scenes::Scene load_scene(const std::string& what, scenes::Untuned untuned) {
  scenes::Loaded loaded = scenes::load(what, untuned);
  if (loaded.scene) return std::move(*loaded.scene);
  const bool is_file = kind_of(what).exists || scenes::is_path(what);
  if (is_file) read_file(what);  // Says so where it cannot be read.
  throw Failure(is_file ? kExitCorrupt : kExitUsage, mistakes_text(what, loaded.mistakes));
}

std::string mistakes_text(const std::string& file, const std::vector<scenes::Mistake>& mistakes) {
  std::string text;
  for (const scenes::Mistake& mistake : mistakes) {
    if (!text.empty()) text += '\n';
    text += visible(file) + ": " + (mistake.path.empty() ? "" : visible(mistake.path) + ": ") +
            visible(mistake.reason);
  }
  return text;
}

}  // namespace cycloid::cli
