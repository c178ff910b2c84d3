#pragma once

#include <memory>
#include <span>
#include <string>

#include "scenes/build.hpp"
#include "solver/collision/manifold.hpp"

namespace cycloid::peers {

/// How engines are run.
struct EngineSettings {
  bool sleep = false;  ///< Whether bodies at rest are put to sleep.
  int lanes = 0;       ///< Of ours; 0: each step takes the width that suits it.
  int workers = 1;     ///< Of ours; the peers here have one.
  /// Of the peers, whose defaults stand where these are 0. Ours are the scene's.
  int substeps = 0;           ///< Whole steps in a tick.
  bool exact_shapes = false;  ///< Shapes as the scene says them, without an engine's skin.
  int iterations = 0;         ///< Sweeps in a step: of velocities where an engine counts those of
                              ///< positions too, which keep to the proportion of its defaults.
};

/// How a body moves: its centre of mass, m/s, and rad/s about it; world.
template <int D>
struct Twist {
  solver::Vec<D> velocity;
  solver::Spin<D> spin;
};

/// One world of some engine, with the bodies, shapes and joints that a built scene has at tick 0.
/// Bodies and joints are named by their slots there.
template <int D>
class Engine {
 public:
  virtual ~Engine() = default;

  /// Applies the controls of every seat, then steps one tick.
  virtual void step(std::span<const scenes::SeatInput> inputs) = 0;

  /// Centre of mass, world.
  virtual solver::Pose<D> pose(std::uint32_t body) const = 0;

  virtual Twist<D> twist(std::uint32_t body) const = 0;

  /// Pairs of shapes that touch after the last step, counted as the engine counts them.
  virtual std::uint32_t contacts() const = 0;

  /// Of the whole state; 0 where the engine has none.
  virtual std::uint64_t digest() const { return 0; }
};

/// What an engine makes a world of.
template <int D>
struct EngineInput {
  const scenes::Scene& scene;
  const scenes::Built<D>& built;  ///< The same, at tick 0.
  EngineSettings settings;
};

/// An engine's name, and how it makes a world.
template <int D>
struct EngineKind {
  const char* name;  ///< "Box2D 2.4.1"
  int iterations;    ///< In a step, by default; 0: the scene says.
  /// Null where the engine cannot hold the scene; `why` then says what it lacks.
  std::unique_ptr<Engine<D>> (*make)(const EngineInput<D>& input, std::string& why);
};

/// Ours first, then those peers that the distribution packages.
template <int D>
std::span<const EngineKind<D>> engines();

}  // namespace cycloid::peers
