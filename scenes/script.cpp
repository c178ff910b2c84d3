#include "scenes/catalogue.hpp"

namespace cycloid::scenes {

/// Integers alone decide whether an entry speaks.
static bool speaks(const ScriptEntry& entry, std::uint64_t tick) {
  if (tick < entry.from || (entry.until != 0 && tick >= entry.until)) return false;
  return entry.every == 0 || (tick - entry.from) % entry.every < entry.hold;
}

static std::int16_t scaled(float axis) {
  return static_cast<std::int16_t>(axis * 32767.0f + (axis < 0.0f ? -0.5f : 0.5f));
}

SeatInput scripted_input(const Scene& scene, int seat, std::uint64_t tick) {
  SeatInput input;
  if (seat < 0 || static_cast<std::size_t>(seat) >= scene.seats.size()) return input;
  for (const ScriptEntry& entry : scene.seats[static_cast<std::size_t>(seat)].script) {
    if (!speaks(entry, tick)) continue;
    for (std::size_t i = 0; i < input.axes.size(); ++i) input.axes[i] = scaled(entry.axes[i]);
    input.buttons = static_cast<std::uint16_t>(entry.buttons);
  }
  return input;
}

}  // namespace cycloid::scenes
