#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solver/world.hpp"

namespace cycloid::scenes {

struct Scene;

inline constexpr int kAxes = 4;
inline constexpr std::uint32_t kSeatsMax = 256;

/// What one seat says for one tick. Integers, so that NaN cannot be said: an axis of 32767 is 1.0;
/// -32768 counts as -32767. Button b is bit b.
struct SeatInput {
  std::array<std::int16_t, kAxes> axes{};
  std::uint16_t buttons = 0;
  friend bool operator==(const SeatInput&, const SeatInput&) = default;
};

/// A body as a viewer needs it, whichever the dimension. In the plane z is 0 and the rotation is
/// about z.
struct Pose {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;
  std::array<float, 3> position{};
  std::array<float, 4> rotation{};  ///< Quaternion x, y, z, w.
};

/// A character as a viewer needs it; its shape is that of the scene's character of the same place.
struct CharacterPose {
  std::array<float, 3> position{};
  std::array<float, 3> velocity{};  ///< World, m/s: that of the ground stood on included.
  bool grounded = false;
};

/// Memory in which the steps of many simulations work, whichever their dimension; see
/// solver::World::use_step_memory.
struct StepMemories {
  std::shared_ptr<solver::StepMemory<2>> planar = solver::make_step_memory<2>();
  std::shared_ptr<solver::StepMemory<3>> spatial = solver::make_step_memory<3>();
};

/// A running scene: one world of either dimension with the seats' controls. A pure function of the
/// scene and of the inputs given to `step`, to the bit. What the controls remember between ticks
/// lies in the world's registers, so digest, save and encode cover it.
class Simulation {
 public:
  /// Never fails for a scene that `check` found no mistake in; else says what the first one is:
  /// "accuracy" where the scene asks for one and has no choice of this solver.
  static solver::Result<Simulation> create(const Scene& scene);
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  int dimension() const;  ///< 2 or 3.
  int seats() const;
  std::uint64_t tick() const;
  float tick_s() const;
  /// 1 to 64 threads; changes no bit.
  solver::Error set_workers(int workers);
  /// Nanoseconds from some start, never backwards. The host's, because a world knows no clock.
  using Clock = std::uint64_t (*)();
  /// As set_workers, but a step takes one thread alone as long as that is faster (ThreadChoice), by
  /// the host's clock, which is read before and after it; with one worker it is not. Changes no
  /// bit.
  solver::Error set_workers_at_most(int workers, Clock now_ns);
  /// For many simulations that step in turn; changes no bit. @pre no step runs.
  void use_step_memory(const StepMemories& memories);
  /// 1, 4, 8 or 16 contacts an instruction, else kInvalid "lanes"; changes no bit.
  solver::Error set_lanes(int lanes);
  /// Of how many contacts are solved together where islands allow it; changes no bit.
  void set_lot_contacts(std::uint32_t contacts);

  /// Applies the controls of every seat, in seat order, then steps once.
  /// @pre inputs.size() == seats(); otherwise kInvalid "inputs" and nothing has changed. Nor has it
  /// where this thread computes otherwise: kInvalid "floating_point_mode".
  solver::Error step(std::span<const SeatInput> inputs);
  /// `step`, with what every phase has left, and refuses as it does; see solver/trace.hpp. Changes
  /// no bit.
  solver::Error step_traced(std::span<const SeatInput> inputs, solver::StepTrace& trace);
  /// Adds the state as it is now to the phases of the trace.
  void trace_state(solver::StepTrace& trace) const;

  std::uint64_t digest() const;
  std::optional<solver::Fault> fault() const;
  void encode(std::vector<std::byte>& into) const;
  std::size_t encoded_bytes() const;  ///< How many that would be, without making them.
  solver::Error decode(std::span<const std::byte> bytes);
  solver::Statistics statistics() const;
  std::vector<Pose> poses() const;
  std::vector<CharacterPose> characters() const;  ///< In the order of the scene's.
  /// The first `limit` fields that differ; the two must run the same scene.
  std::vector<solver::Difference> differences(const Simulation& other, std::size_t limit) const;

  /// Exactly one is not null. For tests, tools and hosts with their own rules: a call that changes
  /// the world is an input like any other and has to be the same everywhere.
  solver::World<2>* planar();
  solver::World<3>* spatial();
  const solver::World<2>* planar() const;
  const solver::World<3>* spatial() const;

  /// The whole state in memory, for rollback. `restore` brings back every bit.
  class Saved {
   public:
    Saved();
    ~Saved();
    Saved(Saved&&) noexcept;
    Saved& operator=(Saved&&) noexcept;
    /// Of the simulation when it was saved. @pre something was.
    std::uint64_t digest() const;
    void encode(std::vector<std::byte>& into) const;

   private:
    friend class Simulation;
    struct State;
    std::unique_ptr<State> state_;
  };
  void save(Saved& into) const;
  /// @pre `from` was saved from a simulation of the same scene.
  void restore(const Saved& from);

 private:
  struct Running;
  solver::Error step_once(std::span<const SeatInput> inputs);
  explicit Simulation(std::unique_ptr<Running> running);
  std::unique_ptr<Running> running_;
};

}  // namespace cycloid::scenes
