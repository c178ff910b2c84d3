#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "server/room/exact_states.hpp"

namespace cycloid::server {

/// What waits to be sent to one client: bounded, whatever the client does.
///
/// Frames and control messages queue up to a bound of bytes; frames may be dropped all together,
/// where an exact state is to take their place. That state is handed out in parts, between which
/// frames of later ticks go on. Of the snapshots of a snapshot client only the latest waits.
class Outbox {
 public:
  explicit Outbox(std::size_t bytes_max) : bytes_max_(bytes_max) {}

  /// False, and nothing has changed, where it would be over the bound.
  [[nodiscard]] bool push_frame(Shared bytes, std::int64_t now_ns) {
    return push({std::move(bytes), now_ns, true});
  }
  [[nodiscard]] bool push_control(Shared bytes, std::int64_t now_ns) {
    return push({std::move(bytes), now_ns, false});
  }
  /// The last word, which has room whatever waits, and comes after all of it.
  void push_last(Shared bytes);
  void replace_snapshot(Shared snapshot) { snapshot_ = std::move(snapshot); }

  /// Frames of ticks up to the state's are dropped: it takes their place.
  void begin_state(std::shared_ptr<const ExactState> state);
  bool state_waits() const { return state_ != nullptr; }
  void drop_frames_and_state();
  void clear();

  std::size_t bytes() const { return bytes_; }
  std::optional<std::int64_t> oldest_frame_ns() const;
  /// Whether `take` with such a number of parts would give anything.
  bool has_output(std::uint32_t parts_max) const;
  /// All that waits, in order, and of the state the next parts, whose number is taken off. What
  /// came after a state waits for its first part.
  std::vector<Shared> take(std::uint32_t& parts_max);

 private:
  struct Item {
    Shared bytes;
    std::int64_t queued_ns = 0;
    bool is_frame = false;
  };
  bool push(Item item);
  void append(Item item);
  void take_items(std::size_t count, std::vector<Shared>& output);

  std::size_t bytes_max_;
  std::size_t bytes_ = 0;
  std::deque<Item> queue_;
  std::size_t before_state_ = 0;  ///< Of the queue: was said before the state was begun.
  std::shared_ptr<const ExactState> state_;
  std::size_t next_part_ = 0;
  Shared snapshot_;
};

}  // namespace cycloid::server
