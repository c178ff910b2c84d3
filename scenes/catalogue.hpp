#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene.hpp"

namespace cycloid::scenes {

/// Why a scene cannot be used: where, and what is wrong with it.
struct Mistake {
  std::string path;    ///< "/bodies/3/shapes/0/radius"; "" for the file as a whole.
  std::string reason;  ///< A sentence.
};

/// A scene, or its mistakes (at least one): all of them, up to about kMistakesMax.
struct Loaded {
  std::optional<Scene> scene;
  std::vector<Mistake> mistakes;
};

/// So many mistakes end the search for more: a hostile file is nothing else.
inline constexpr std::size_t kMistakesMax = 1000;

/// What to do with a scene that asks for an accuracy for which this solver has chosen nothing: only
/// what chooses takes it.
enum class Untuned : std::uint32_t { kRefused, kAllowed };

struct CatalogueEntry {
  std::string name;        ///< "half-pipe"
  std::string summary;     ///< One sentence.
  std::string parameters;  ///< "base=20 (1 to 400)", or "".
};

/// Every scene that is built in, in a fixed order.
std::vector<CatalogueEntry> catalogue();

/// A built-in scene by name, with parameters where it has some: "half-pipe", "pyramid:base=100".
Loaded find(std::string_view name);

/// What the rules behind the catalogue make today: the files in catalogue/ are exports of these,
/// and a test holds the two equal.
std::vector<Scene> generated_defaults();

/// A file: JSON by its first character '{', else the binary form.
/// @returns a mistake with an empty path where the file cannot be read.
Loaded load_file(const std::string& file, Untuned untuned = Untuned::kRefused);

/// A built-in name, or a file where `what` names an existing file.
Loaded load(const std::string& what, Untuned untuned = Untuned::kRefused);

Loaded from_json(std::string_view text, Untuned untuned = Untuned::kRefused);
Loaded from_binary(std::span<const std::byte> bytes, Untuned untuned = Untuned::kRefused);
std::string to_json(const Scene& scene);
std::vector<std::byte> to_binary(const Scene& scene);

/// All mistakes of a scene made in memory; empty when it is good.
std::vector<Mistake> check(const Scene& scene, Untuned untuned = Untuned::kRefused);

/// 64 bits over all that a scene means (not over its bytes): the encoding of its world at tick 0
/// and of its controls. Unequal digests cannot stay in lockstep.
std::uint64_t scene_digest(const Scene& scene);

/// What the scene's own script lets a seat say at a tick (the first tick is 1); neutral where it
/// says nothing. So that a catalogue scene moves without a player: `run`, tests and demo clients.
SeatInput scripted_input(const Scene& scene, int seat, std::uint64_t tick);

}  // namespace cycloid::scenes
