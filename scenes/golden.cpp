#include "scenes/golden.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <utility>

#include "scenes/catalogue.hpp"

namespace cycloid::scenes {

bool is_path(std::string_view name) {
  return name.find_first_of("/.") != std::string_view::npos;
}

std::uint64_t fold(std::uint64_t chain, std::uint64_t word) {
  std::array<unsigned char, 16> bytes{};
  for (std::size_t i = 0; i < 8; ++i) {
    bytes[i] = static_cast<unsigned char>(chain >> (8 * i));
    bytes[i + 8] = static_cast<unsigned char>(word >> (8 * i));
  }
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t inputs_digest(const Scene& scene, std::uint64_t ticks) {
  std::uint64_t digest = fold(kChainStart, scene.seats.size());
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    for (std::size_t seat = 0; seat < scene.seats.size(); ++seat) {
      const SeatInput input = scripted_input(scene, static_cast<int>(seat), tick);
      std::uint64_t axes = 0;
      for (const std::int16_t axis : input.axes)
        axes = axes << 16 | static_cast<std::uint16_t>(axis);
      digest = fold(fold(digest, axes), input.buttons);
    }
  }
  return digest;
}

GoldenWalk::GoldenWalk(const Scene& scene, Simulation simulation)
    : scene_(scene), simulation_(std::move(simulation)) {}

solver::Result<GoldenRow> GoldenWalk::walk_to(std::uint64_t tick) {
  std::vector<SeatInput> inputs;
  while (simulation_.tick() < tick) {
    inputs.clear();
    for (int seat = 0; seat < simulation_.seats(); ++seat)
      inputs.push_back(scripted_input(scene_, seat, simulation_.tick() + 1));
    if (const solver::Error error = simulation_.step(inputs); !error.ok()) return error;
    chain_ = fold(chain_, simulation_.digest());
  }
  std::vector<std::byte> bytes;
  simulation_.encode(bytes);
  GoldenRow row;
  row.tick = simulation_.tick();
  row.digest = simulation_.digest();
  row.encoded_bytes = bytes.size();
  row.chain = chain_;
  return row;
}

std::optional<GoldenMismatch> compare_golden(const GoldenScene& golden, GoldenWalk& walk,
                                             std::uint64_t ticks_max) {
  std::uint64_t good = walk.tick();
  for (const GoldenRow& row : golden.rows) {
    if (row.tick > ticks_max) break;
    const solver::Result<GoldenRow> found = walk.walk_to(row.tick);
    if (!found.ok()) return GoldenMismatch{row, {}, good + 1, walk.tick() + 1, found.error()};
    const GoldenRow& now = found.value();
    if (now.digest != row.digest || now.encoded_bytes != row.encoded_bytes ||
        now.chain != row.chain)
      return GoldenMismatch{row, now, good + 1, row.tick, {}};
    good = row.tick;
  }
  return std::nullopt;
}

}  // namespace cycloid::scenes
