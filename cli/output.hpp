#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/exit_codes.hpp"
#include "protocol/text.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::cli {

/// Keeps the order of insertion, so that output is stable and reads well.
using Json = nlohmann::ordered_json;

/// Ends the program with a message and an exit code; caught in main alone.
struct Failure : std::runtime_error {
  Failure(Exit exit_code, const std::string& message)
      : std::runtime_error(message), exit(exit_code) {}
  Exit exit;
};

using protocol::hex16;

/// `object` with the exit code as its last member, on one line of stdout.
void print_json(Json object, Exit exit);

/// "name value" on a line of stdout.
void print_member(const std::string& name, const Json& value);

/// The bytes of a file; a Failure with kExitIo naming it where it cannot be read.
std::vector<std::byte> read_file(const std::string& file);
/// Those at its beginning, as many as there are, and a Failure as of the whole.
std::vector<std::byte> read_beginning(const std::string& file, std::size_t bytes_max);

/// A catalogue scene or a scene file. A Failure names each mistake: kExitUsage where there is no
/// such name, kExitIo where there is no such file, kExitCorrupt where the file is no scene.
scenes::Scene load_scene(const std::string& what,
                         scenes::Untuned untuned = scenes::Untuned::kRefused);

/// "FILE: path: reason", one line per mistake, without the last newline.
std::string mistakes_text(const std::string& file, const std::vector<scenes::Mistake>& mistakes);

}  // namespace cycloid::cli
