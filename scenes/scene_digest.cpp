#define XXH_INLINE_ALL
#include <xxhash.h>

#include <bit>

#include "scenes/catalogue.hpp"
#include "scenes/fields.hpp"

namespace cycloid::scenes {

/// Writes fields as little-endian bytes, each string and list with its length before it.
struct MeaningWriter {
  std::vector<std::byte>& bytes;

  void number(std::uint64_t value) {
    for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
  }
  void write(float value) { number(std::bit_cast<std::uint32_t>(value == 0.0f ? 0.0f : value)); }
  void write(const std::string& text) {
    number(text.size());
    for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
  }
  template <class Number>
  requires std::is_integral_v<Number> || std::is_enum_v<Number>
  void write(Number value) { number(static_cast<std::uint64_t>(value)); }
  template <class Number, std::size_t N>
  void write(const std::array<Number, N>& values) {
    for (const Number value : values) write(value);
  }
  template <class Element>
  void write(const std::vector<Element>& elements) {
    number(elements.size());
    for (const Element& element : elements) write(element);
  }
  template <HasFields Part>
  void write(const Part& part) {
    Part copy = part;
    fields(copy, [this](const char*, auto& field) { this->write(field); });
  }
};

std::uint64_t scene_digest(const Scene& scene) {
  std::vector<std::byte> bytes;
  const solver::Result<Simulation> start = Simulation::create(scene);
  if (start.ok()) start.value().encode(bytes);
  MeaningWriter writer{bytes};
  // Names are what controls refer to. The script is left out: it is what a player might do, not
  // what the scene means; so is the summary.
  for (const SceneBody& body : scene.bodies) writer.write(body.name);
  for (const SceneJoint& joint : scene.joints) writer.write(joint.name);
  writer.write(scene.prefabs);
  writer.number(scene.seats.size());
  for (const Seat& seat : scene.seats) writer.write(seat.controls);
  return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace cycloid::scenes
