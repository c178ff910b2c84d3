#pragma once

#include "protocol/lockstep.hpp"
#include "tests/determinism/scene_test.hpp"

namespace cycloid::history {

/// What every seat said, tick by tick; the first element is of tick 1.
using Match = std::vector<std::vector<SeatInput>>;

/// The longest way back: as far as a server lets seats speak ahead of each other.
inline constexpr std::uint64_t kRollbackTicks = protocol::kInputWindowTicks;

/// Digests after every tick, the first of the start: by a world that knows all inputs in time.
std::vector<std::uint64_t> digests_of(const Scene& scene, const Match& match);

/// A client that does not wait: where an input has not come it guesses that the seat goes on with
/// what it said last, and goes back to the first wrong guess once the truth comes.
class RollbackClient {
 public:
  explicit RollbackClient(const Scene& scene);

  /// What `seat` says for `tick` has come: at most kRollbackTicks after the tick was guessed.
  void hear(std::uint64_t tick, std::size_t seat, const SeatInput& input);
  /// Mends the past where guesses were wrong, then makes the next tick. @pre it is not more than
  /// kRollbackTicks - 1 ticks ahead of what it heard from every seat.
  void advance();
  /// Mends the past alone.
  void mend();

  /// Digests of the ticks of which every input has come, in order, the first of the start.
  const std::vector<std::uint64_t>& confirmed() const { return confirmed_; }
  std::uint64_t tick() const { return simulation_.tick(); }

  std::uint64_t rollbacks = 0;
  std::uint64_t longest_rollback = 0;  ///< Ticks made again at once.
  std::uint64_t wrong_digests = 0;     ///< Of guessed ticks: the right ones were others.

 private:
  struct Told {
    std::vector<std::optional<SeatInput>> heard;  ///< By seat.
    std::vector<SeatInput> used;                  ///< Empty until the tick is made.
    std::uint64_t digest = 0;
  };
  Told& told(std::uint64_t tick);
  std::vector<SeatInput> guess(std::uint64_t tick);
  void make_tick();
  void confirm();

  Simulation simulation_;
  std::vector<Told> told_;
  std::vector<Simulation::Saved> saved_;  ///< After tick t, at t modulo their number.
  std::vector<std::uint64_t> confirmed_;
};

/// Plays a match in rollback with inputs late by up to kRollbackTicks, at random by `seed`, and
/// holds every confirmed digest to `right`.
void expect_equal_in_rollback(const Match& match, const std::vector<std::uint64_t>& right,
                              std::uint32_t seed, RollbackClient& client);

}  // namespace cycloid::history
