#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scenes/scene.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::client {

/// What is tested: a world with a number of places for its state. A game that keeps state of its
/// own beside the world overrides what saves and restores it, and is tested whole.
class Rewindable {
 public:
  virtual ~Rewindable() = default;

  virtual std::uint64_t tick() const = 0;
  /// Makes the tick `tick() + 1`, each time by the same inputs. @returns why it cannot, or "".
  virtual std::string step() = 0;
  virtual void save(std::size_t place) = 0;
  virtual void restore(std::size_t place) = 0;
  virtual std::uint64_t digest() const = 0;
  /// The first field in which the state in `place` (first) differs from the state now; "" where
  /// nothing that can be named does.
  virtual std::string difference(std::size_t place) = 0;
};

struct SyncTestOptions {
  /// How many ticks to go back after each tick, 1 to kSyncDistanceMax; 0: 1, 2, ... in turn.
  std::uint32_t distance = 0;
};
inline constexpr std::uint32_t kSyncDistanceMax = 8;

/// Two runs of the same tick from the same saved state that were not the same.
struct SyncFailure {
  std::uint64_t tick = 0;       ///< The first that came out different.
  std::uint64_t from_tick = 0;  ///< Whose saved state the second run began with.
  std::uint64_t digest = 0;     ///< The first time.
  std::uint64_t digest_again = 0;
  std::string difference;  ///< "body 3 velocity.x: 0.5 and 0.25", or "".
  std::string error;       ///< Why the world did not step; "" where it did.
};

/// Plays rollback without a network: step, go back, step again, and the state has to be the same.
/// Whatever a save forgets shows as soon as it matters to a digest.
class SyncTest {
 public:
  /// @pre `world` outlives this.
  SyncTest(Rewindable& world, SyncTestOptions options);

  /// One tick more, and so many again. After a failure the world is left as it came out.
  std::optional<SyncFailure> advance();
  /// Ticks stepped in all, and how often the state went back.
  std::uint64_t steps() const { return steps_; }
  std::uint64_t restores() const { return restores_; }

 private:
  std::optional<SyncFailure> step(std::uint64_t from_tick);
  std::size_t place(std::uint64_t tick) const { return tick % (kSyncDistanceMax + 1); }

  Rewindable& world_;
  SyncTestOptions options_;
  std::uint64_t first_tick_;
  std::vector<std::uint64_t> digests_;  ///< After tick t, at place(t).
  std::uint64_t steps_ = 0;
  std::uint64_t restores_ = 0;
};

/// A scene as the sync test takes it, with the inputs of its script or of a source.
class RewindableScene : public Rewindable {
 public:
  using Inputs = std::function<scenes::SeatInput(int seat, std::uint64_t tick)>;

  /// @pre `check` finds no mistake in the scene, which outlives this.
  explicit RewindableScene(const scenes::Scene& scene, Inputs inputs = {});

  std::uint64_t tick() const override { return simulation_.tick(); }
  std::string step() override;
  void save(std::size_t place) override;
  void restore(std::size_t place) override;
  std::uint64_t digest() const override { return simulation_.digest(); }
  std::string difference(std::size_t place) override;
  scenes::Simulation& simulation() { return simulation_; }

 private:
  const scenes::Scene& scene_;
  Inputs inputs_;
  scenes::Simulation simulation_;
  std::vector<scenes::Simulation::Saved> saved_;
  std::vector<scenes::SeatInput> coming_;
};

}  // namespace cycloid::client
