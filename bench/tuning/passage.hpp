#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/scene.hpp"

namespace cycloid::tuning {

/// A body that moves by itself and is there from the start.
struct MovingBody {
  std::uint32_t index = 0;       ///< Of its slot, which is its place in the scene.
  std::uint32_t generation = 0;  ///< Of its slot.
  double extent_m = 0.0;         ///< Of its farthest point from its centre of mass.
  double thickness_m = 0.0;      ///< Radius of the largest ball in its thinnest shape.
  double weight_n = 0.0;         ///< Size of what gravity pulls it with.
  bool turns = true;             ///< False: its rotation is fixed, or it is a particle.
};

/// @pre the scene has no mistake.
std::vector<MovingBody> moving_bodies(const scenes::Scene& scene);

/// Where a body is.
struct BodyPlace {
  bool there = false;  ///< False: it was taken away.
  std::array<double, 3> position{};
  std::array<double, 4> rotation{};  ///< Quaternion x, y, z, w.
};

/// One run of a scene by its own script, looked at every fifth tick: where the bodies went, and
/// what it cost in counted work. The same on every machine.
struct Passage {
  bool ended = true;  ///< False: the world faulted; what follows ends there.
  std::uint64_t ticks = 0;
  std::vector<MovingBody> bodies;
  std::vector<std::vector<BodyPlace>> looks;  ///< Of every body, look by look; the start first.
  std::size_t late_looks = 0;          ///< How many of them, the last, lie in the last second.
  double rows_per_tick = 0.0;          ///< As accuracy::rows_of_tick counts them.
  double contact_rows_per_tick = 0.0;  ///< Of contacts with an angular part, each counted once.
  double asleep_per_tick = 0.0;        ///< Bodies that were left alone.
  std::uint64_t state_bytes = 0;       ///< Of the state at the end, encoded.
  std::uint64_t digest = 0;
};

/// @pre the scene has no mistake and, if it asks for an accuracy, a choice.
Passage run_passage(const scenes::Scene& scene, std::uint32_t ticks);

/// How far two runs of one scene end apart, m: root mean square over the bodies of the distance
/// between their mean places in the last second. @pre both ended
double distance_at_end_m(const Passage& a, const Passage& b);

/// The largest distance between the same point of a body in the two runs, at any look, m; infinite
/// where a body is there in one of them alone.
double distance_max_m(const Passage& a, const Passage& b);

/// The largest way of any point of the body by turning alone, from the start to any look, m.
double turned_max_m(const Passage& passage, std::size_t body);

}  // namespace cycloid::tuning
