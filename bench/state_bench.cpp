// What a snapshot client is sent: bytes per tick of every profile over 600 ticks of catalogue
// scenes, and what it takes to code them. Every delta is read back and compared.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "protocol/state/exact_delta.hpp"
#include "protocol/state/quantised_delta.hpp"
#include "scenes/catalogue.hpp"

namespace {

namespace protocol = cycloid::protocol;
namespace scenes = cycloid::scenes;
namespace solver = cycloid::solver;

constexpr int kTicks = 600;
constexpr std::size_t kExactBytesMax = 64u << 20;
constexpr std::size_t kStateBodiesMax = 1u << 16;

[[noreturn]] void fail(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::exit(1);
}

/// What happens in a row of the table besides the scene.
enum class Play { kScript, kNobody, kAllKicked };

struct Row {
  const char* scene;
  Play play;
  const char* label;
};

constexpr Row kRows[] = {
    {"cubes-901", Play::kScript, "cubes-901"},
    {"cubes-901", Play::kNobody, "cubes-901, nobody plays"},
    {"cubes-901", Play::kAllKicked, "cubes-901, all kicked"},
    {"half-pipe", Play::kScript, "half-pipe"},
    {"pyramid-20", Play::kScript, "pyramid-20"},
    {"ball-pit-3d", Play::kScript, "ball-pit-3d"},
    {"ragdolls-3d", Play::kScript, "ragdolls-3d"},
    {"room-200", Play::kScript, "room-200"},
    {"character-course-3d", Play::kScript, "character-course-3d"},
    {"cloth-3d", Play::kScript, "cloth-3d"},
};

/// All states of a row, in both profiles.
struct Recorded {
  std::vector<std::vector<std::byte>> exact;
  std::vector<protocol::QuantisedState> quantised;
};

/// An impulse for every dynamic body, each in a direction of its own.
void kick_all(solver::World<3>& world) {
  std::uint32_t number = 1;
  auto any = [&] {
    number = number * 1664525u + 1013904223u;
    return static_cast<float>(number >> 8) / 8388608.0f - 1.0f;
  };
  for (const solver::BodyView<3>& body : world.bodies()) {
    if (body.kind != solver::BodyKind::kDynamic) continue;
    const float impulse = 4.0f * body.mass;
    const solver::Vec<3> push = {{impulse * any(), impulse, impulse * any()}};
    if (!world.apply_impulse(body.id, push).ok()) fail("apply_impulse");
  }
}

Recorded record(const Row& row) {
  const scenes::Loaded loaded = scenes::find(row.scene);
  if (!loaded.scene) fail(std::string("no scene ") + row.scene);
  auto created = scenes::Simulation::create(*loaded.scene);
  if (!created.ok()) fail(created.error().field);
  scenes::Simulation& simulation = created.value();
  Recorded recorded;
  const int settle = row.play == Play::kNobody ? 300 : 0;
  for (int i = -settle; i <= kTicks; ++i) {
    if (i >= 0) {
      simulation.encode(recorded.exact.emplace_back());
      recorded.quantised.push_back(protocol::capture(simulation));
    }
    if (row.play == Play::kAllKicked && i % 60 == 0) kick_all(*simulation.spatial());
    std::vector<scenes::SeatInput> inputs;
    for (int seat = 0; seat < simulation.seats(); ++seat)
      inputs.push_back(row.play == Play::kNobody
                           ? scenes::SeatInput{}
                           : scenes::scripted_input(*loaded.scene, seat, simulation.tick() + 1));
    if (!simulation.step(inputs).ok()) fail("step");
  }
  return recorded;
}

/// Sums over all ticks of a row, with acknowledgements `lag` ticks old.
struct Sums {
  double whole_bytes = 0.0;
  double exact_bytes = 0.0;
  double exact_write_s = 0.0;
  double exact_read_s = 0.0;
  double quantised_bytes = 0.0;
  double quantised_write_s = 0.0;
  double moving = 0.0;
};

/// Of the processor, so that other programs on the machine do not count.
double seconds_since(std::clock_t start) {
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

void add_exact(const std::vector<std::byte>& before, const std::vector<std::byte>& now,
               Sums& sums) {
  std::vector<std::byte> delta;
  std::clock_t start = std::clock();
  if (!protocol::encode_exact_delta(before, now, delta)) fail("encode_exact_delta");
  sums.exact_write_s += seconds_since(start);
  start = std::clock();
  const auto read = protocol::decode_exact_delta(before, delta, kExactBytesMax);
  sums.exact_read_s += seconds_since(start);
  if (!read || *read != now) fail("an exact delta is not the state");
  sums.whole_bytes += static_cast<double>(now.size());
  sums.exact_bytes += static_cast<double>(delta.size());
}

void add_quantised(const protocol::QuantisedState& before, const protocol::QuantisedState& now,
                   Sums& sums) {
  const protocol::HeldState held{before, {}};
  const std::clock_t start = std::clock();
  const protocol::QuantisedDelta delta = protocol::encode_quantised(&held, now, kExactBytesMax);
  sums.quantised_write_s += seconds_since(start);
  const auto read = protocol::decode_quantised(&before, now.tick, delta.bytes, kStateBodiesMax);
  if (!read || *read != now) fail("a quantised delta is not the state");
  sums.quantised_bytes += static_cast<double>(delta.bytes.size());
  for (const protocol::QuantisedBody& body : now.bodies) sums.moving += body.at_rest ? 0.0 : 1.0;
  sums.moving += static_cast<double>(now.particles.size() + now.characters.size());
}

Sums sums_of(const Recorded& recorded, std::size_t lag) {
  Sums sums;
  for (std::size_t tick = lag; tick <= kTicks; ++tick) {
    add_exact(recorded.exact[tick - lag], recorded.exact[tick], sums);
    add_quantised(recorded.quantised[tick - lag], recorded.quantised[tick], sums);
  }
  return sums;
}

void print_row(const Row& row) {
  const Recorded recorded = record(row);
  std::vector<std::byte> first;
  protocol::encode_exact_delta({}, recorded.exact.back(), first);
  const std::size_t first_quantised =
      protocol::encode_quantised(nullptr, recorded.quantised.back(), kExactBytesMax).bytes.size();
  for (const std::size_t lag : {1u, 6u}) {
    const Sums sums = sums_of(recorded, lag);
    const double ticks = static_cast<double>(kTicks - lag + 1);
    const double quantised = sums.quantised_bytes / ticks;
    std::printf(
        "%-24s %3zu %8.0f %7zu %8.0f %5.1f%% %5.0f %5.0f %6zu %7.1f %7.1f %6.1f %5.2f %5.0f\n",
        row.label, lag, sums.whole_bytes / ticks, first.size(), sums.exact_bytes / ticks,
        100.0 * sums.exact_bytes / sums.whole_bytes, sums.whole_bytes / sums.exact_write_s / 1e6,
        sums.whole_bytes / sums.exact_read_s / 1e6, first_quantised, quantised,
        quantised * 8.0 * 60.0 / 1000.0, sums.moving / ticks,
        sums.quantised_bytes / std::max(1.0, sums.moving), sums.quantised_write_s / ticks * 1e6);
  }
  std::fflush(stdout);
}

}  // namespace

int main() {
  std::printf(
      "Bytes per tick over %d ticks, against a baseline `lag` ticks old. whole: World::encode. "
      "first: "
      "from nothing.\nkbit/s at 60 Hz; moving: bodies not at rest, and particles; MB/s of the "
      "whole "
      "state; us to code a quantised delta.\n\n",
      kTicks);
  std::printf("%-24s %3s %8s | %5s %8s %6s %5s %5s | %4s %7s %7s %6s %5s %5s\n", "scene", "lag",
              "whole", "exact", "delta", "", "write", "read", "quant", "delta", "kbit/s", "moving",
              "B/mov", "us");
  for (const Row& row : kRows) print_row(row);
}
