#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/log_format.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::protocol {
namespace {

constexpr std::uint64_t kTicksAnHour = 216000;
constexpr std::size_t kPlayers = 8;

/// Bytes that an hour of ticks takes at 60 Hz, keyframes not counted.
template <class Play>
double megabytes_an_hour(const char* what, Play&& play) {
  Bytes bytes;
  LogEncoder encoder({}, bytes);
  std::uint64_t total = bytes.size();
  std::mt19937_64 random(7);
  LogTick tick;
  tick.frame.seats.assign(kPlayers, {Origin::kGiven, {}});
  for (tick.frame.tick = 1; tick.frame.tick <= kTicksAnHour; ++tick.frame.tick) {
    for (std::size_t seat = 0; seat < kPlayers; ++seat) play(seat, tick.frame, random);
    tick.digest = random();
    bytes.clear();
    encoder.tick(tick, bytes);
    total += bytes.size();
  }
  std::printf("%-44s %6.2f MB/h, %5.1f bytes a tick\n", what, double(total) * 1e-6,
              double(total) / double(kTicksAnHour));
  return double(total) * 1e-6;
}

bool chance(std::mt19937_64& random, unsigned in_1000) {
  return random() % 1000 < in_1000;
}

/// A direction changes every third of a second, a button twice a second.
void keyboard(std::size_t seat, InputFrame& frame, std::mt19937_64& random) {
  scenes::SeatInput& input = frame.seats[seat].input;
  if (chance(random, 50))
    input.axes[random() % 2] = static_cast<std::int16_t>((int(random() % 3) - 1) * 32767);
  if (chance(random, 33))
    input.buttons = static_cast<std::uint16_t>(input.buttons ^ 1u << random() % 4);
}

/// A stick of 8 bits that is on its way for a sixth of the time, and rests or is held for the rest.
void stick(std::size_t seat, InputFrame& frame, std::mt19937_64& random) {
  scenes::SeatInput& input = frame.seats[seat].input;
  if (frame.tick / 12 % 6 == seat % 6) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const int step = static_cast<int>(random() % 41) - 20;
      const int to = std::clamp(input.axes[axis] / 256 + step, -127, 127);
      input.axes[axis] = static_cast<std::int16_t>(to * 256);
    }
  }
  if (chance(random, 33))
    input.buttons = static_cast<std::uint16_t>(input.buttons ^ 1u << random() % 4);
}

TEST(LogSize, AnHourOfEightPlayersStaysBelowFiveMegabytes) {
  const double held = megabytes_an_hour("8 players who hold", [](auto&&...) {});
  EXPECT_LT(held, kTicksAnHour * 14.1e-6);
  EXPECT_LE(megabytes_an_hour("8 keyboards", keyboard), 5.0);
  EXPECT_LE(megabytes_an_hour("8 sticks, on their way a sixth of the time", stick), 5.0);
  EXPECT_LE(megabytes_an_hour("4 of each",
                              [](std::size_t seat, InputFrame& frame, std::mt19937_64& random) {
                                seat % 2 == 0 ? keyboard(seat, frame, random)
                                              : stick(seat, frame, random);
                              }),
            5.0);
  // What nobody does; for the record.
  (void)megabytes_an_hour("8 who change every axis in every tick",
                          [](std::size_t seat, InputFrame& frame, std::mt19937_64& random) {
                            for (std::int16_t& axis : frame.seats[seat].input.axes)
                              axis = static_cast<std::int16_t>(random());
                          });
}

/// The catalogue's own scripts, as `cycloid run` logs them, with their real digests' eight bytes.
TEST(LogSize, OfTheScriptsOfTheCatalogue) {
  for (const scenes::CatalogueEntry& entry : scenes::catalogue()) {
    const scenes::Scene scene = *scenes::find(entry.name).scene;
    if (scene.seats.empty()) continue;
    const double size = megabytes_an_hour(
        entry.name.c_str(), [&](std::size_t seat, InputFrame& frame, std::mt19937_64&) {
          frame.seats[seat].input = scenes::scripted_input(
              scene, static_cast<int>(seat % scene.seats.size()), frame.tick);
        });
    EXPECT_LE(size, 5.0) << entry.name;
  }
}

}  // namespace
}  // namespace cycloid::protocol
