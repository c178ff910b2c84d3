#include "server/room/outbox.hpp"

#include <algorithm>

namespace cycloid::server {

bool Outbox::push(Item item) {
  const std::size_t bytes = item.bytes->size();
  if (bytes_ + bytes > bytes_max_) return false;
  append(std::move(item));
  return true;
}

void Outbox::append(Item item) {
  bytes_ += item.bytes->size();
  queue_.push_back(std::move(item));
}

void Outbox::push_last(Shared bytes) {
  if (snapshot_) append({std::exchange(snapshot_, nullptr), 0, false});
  append({std::move(bytes), 0, false});
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
  if (!state_) return !queue_.empty() || snapshot_ != nullptr;
  return parts_max > 0 || (next_part_ > 0 ? !queue_.empty() : before_state_ > 0);
}

void Outbox::take_items(std::size_t count, std::vector<Shared>& output) {
  for (; count > 0; --count) {
    bytes_ -= queue_.front().bytes->size();
    output.push_back(std::move(queue_.front().bytes));
    queue_.pop_front();
  }
}

std::vector<Shared> Outbox::take(std::uint32_t& parts_max) {
  std::vector<Shared> output;
  take_items(std::exchange(before_state_, 0), output);
  // What follows a state makes no sense to who has nothing of it yet.
  if (state_ && next_part_ == 0 && parts_max == 0) return output;
  while (state_ && parts_max > 0) {
    --parts_max;
    output.push_back(state_->part(next_part_));
    if (++next_part_ < state_->parts()) continue;
    state_.reset();
    next_part_ = 0;
  }
  take_items(queue_.size(), output);
  // A snapshot may differ from the state, so it comes after the whole of it.
  if (snapshot_ && !state_) output.push_back(std::exchange(snapshot_, nullptr));
  return output;
}

}  // namespace cycloid::server
