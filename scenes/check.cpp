#include <cmath>

#include "scenes/accuracy.hpp"
#include "scenes/build.hpp"
#include "scenes/catalogue.hpp"
#include "scenes/unused.hpp"
#include "solver/validate.hpp"

namespace cycloid::scenes {

static bool is_within(float value, float lower, float upper) {
  return value >= lower && value <= upper;
}

template <std::size_t N>
static bool are_within(const std::array<float, N>& values, float bound) {
  for (const float value : values)
    if (!is_within(value, -bound, bound)) return false;
  return true;
}

/// Ranges that the solver never sees, because controls act later.
static void check_control(const Control& control, const std::string& path,
                          std::vector<Mistake>& mistakes) {
  const auto complain = [&](const char* field, const char* reason) {
    mistakes.push_back({path + "/" + field, reason});
  };
  const bool axis = control.source == Source::kAxis;
  if (!axis && control.source != Source::kButton) complain("source", "has to be axis or button");
  if (control.index >= (axis ? static_cast<std::uint32_t>(kAxes) : 16u))
    complain("index", axis ? "has to be 0 to 3" : "has to be 0 to 15");
  const bool once = control.effect == Effect::kImpulse || control.effect == Effect::kSpawn ||
                    control.effect == Effect::kJump;
  if (once && axis) complain("source", "has to be a button: this effect happens once per press");
  if (!are_within(control.value, 1.0e9f)) complain("value", "is out of range");
  const bool steers = control.effect == Effect::kSteering;
  if (steers && !is_within(control.value[0], -1.6f, 1.6f))
    complain("value", "has to be an angle within 1.6 rad");
  const bool drives = control.effect == Effect::kMotorSpeed;
  if (drives && !is_within(control.value[0], -solver::kSpinMax, solver::kSpinMax))
    complain("value", "has to be a speed within 1e5 rad/s or m/s");
  if (!are_within(control.position, 1.0e6f)) complain("position", "is out of range");
  if (!are_within(control.velocity, 1.0e4f)) complain("velocity", "is out of range");
  if (control.limit < 1 || control.limit > 256) complain("limit", "has to be 1 to 256");
  if (control.frame != Frame::kWorld && control.frame != Frame::kBody)
    complain("frame", "has to be world or body");
}

static void check_script(const ScriptEntry& entry, const std::string& path,
                         std::vector<Mistake>& mistakes) {
  if (!are_within(entry.axes, 1.0f)) mistakes.push_back({path + "/axes", "has to lie within 1"});
  if (entry.buttons > 0xffffu) mistakes.push_back({path + "/buttons", "has 16 bits at most"});
  if (entry.from < 1) mistakes.push_back({path + "/from", "has to be 1 or later"});
  if (entry.until != 0 && entry.until <= entry.from)
    mistakes.push_back({path + "/until", "has to be later than from, or 0: for ever"});
  if (entry.every != 0 && entry.hold < 1)
    mistakes.push_back(
        {path + "/hold", "has to be 1 or more: the ticks of every that it speaks in"});
}

std::vector<Mistake> check(const Scene& scene, Untuned untuned) {
  std::vector<Mistake> mistakes;
  if (scene.dimension != 2 && scene.dimension != 3) {
    mistakes.push_back({"/dimension", "has to be 2 or 3"});
    return mistakes;
  }
  if (!is_within(scene.tick_hz, 1.0f, 1000.0f)) {
    mistakes.push_back({"/tick_hz", "has to be 1 to 1000"});
    return mistakes;
  }
  check_accuracy(scene, untuned, mistakes);
  check_unused(scene, mistakes);
  if (scene.seats.size() > kSeatsMax) mistakes.push_back({"/seats", "are 256 at most"});
  for (std::size_t s = 0; s < scene.seats.size(); ++s) {
    const std::string path = "/seats/" + std::to_string(s);
    for (std::size_t c = 0; c < scene.seats[s].controls.size() && mistakes.size() < kMistakesMax;
         ++c)
      check_control(scene.seats[s].controls[c], path + "/controls/" + std::to_string(c), mistakes);
    for (std::size_t e = 0; e < scene.seats[s].script.size() && mistakes.size() < kMistakesMax; ++e)
      check_script(scene.seats[s].script[e], path + "/script/" + std::to_string(e), mistakes);
  }
  if (scene.dimension == 2)
    build<2>(scene, mistakes);
  else
    build<3>(scene, mistakes);
  return mistakes;
}

}  // namespace cycloid::scenes
