#include "server/room/outbox.hpp"

#include <algorithm>

namespace cycloid::server {

bool Outbox::push(Item item) {
  const std::size_t bytes = item.bytes->size();
  if (bytes_ + bytes > bytes_max_) return false;
  bytes_ += bytes;
  queue_.push_back(std::move(item));
  return true;
}

void Outbox::push_last(Shared bytes) {
  if (snapshot_) queue_.push_back({std::exchange(snapshot_, nullptr), 0, false});
  queue_.push_back({std::move(bytes), 0, false});
}

void Outbox::begin_state(std::shared_ptr<const ExactState> state) {
  drop_frames_and_state();
  state_ = std::move(state);
  before_state_ = queue_.size();
}

void Outbox::drop_frames_and_state() {
  std::erase_if(queue_, [&](const Item& item) {
    if (item.is_frame) bytes_ -= item.bytes->size();
    return item.is_frame;
  });
  state_.reset();
  snapshot_.reset();
  next_part_ = 0;
  before_state_ = 0;
}

void Outbox::clear() {
  drop_frames_and_state();
  queue_.clear();
  bytes_ = 0;
}

std::optional<std::int64_t> Outbox::oldest_frame_ns() const {
  const auto found = std::ranges::find_if(queue_, [](const Item& item) { return item.is_frame; });
  return found == queue_.end() ? std::nullopt : std::optional(found->queued_ns);
}

bool Outbox::has_output(std::uint32_t parts_max) const {
  return !queue_.empty() || (state_ ? parts_max > 0 : snapshot_ != nullptr);
}

std::vector<Shared> Outbox::take(std::uint32_t& parts_max) {
  std::vector<Shared> output;
  const auto first = queue_.begin() + static_cast<std::ptrdiff_t>(before_state_);
  for (auto it = queue_.begin(); it != first; ++it) output.push_back(std::move(it->bytes));
  while (state_ && parts_max > 0) {
    --parts_max;
    output.push_back(state_->part(next_part_));
    if (++next_part_ < state_->parts()) continue;
    state_.reset();
    next_part_ = 0;
  }
  for (auto it = first; it != queue_.end(); ++it) output.push_back(std::move(it->bytes));
  queue_.clear();
  bytes_ = 0;
  before_state_ = 0;
  // A snapshot may differ from the state, so it comes after the whole of it.
  if (snapshot_ && !state_) output.push_back(std::exchange(snapshot_, nullptr));
  return output;
}

}  // namespace cycloid::server
