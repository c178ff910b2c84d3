#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "protocol/codec.hpp"

namespace cycloid::server {

/// Encoded once, sent to many.
using Shared = std::shared_ptr<const protocol::Bytes>;

/// What waits to be sent to one client: bounded, whatever the client does.
///
/// Frames and answers queue up to a bound. Exact snapshots (of a join or after a desync) are not
/// counted, for one may be larger than the bound; `exact_waits` lets the room queue one at a time.
/// Of the snapshots of a snapshot client only the latest waits.
class Outbox {
 public:
  explicit Outbox(std::size_t bytes_max) : bytes_max_(bytes_max) {}

  /// False, and nothing has changed, where it would be over the bound.
  [[nodiscard]] bool push(Shared bytes) {
    if (bytes_ + bytes->size() > bytes_max_) return false;
    bytes_ += bytes->size();
    queue_.push_back(std::move(bytes));
    return true;
  }
  void push_exact(Shared snapshot) {
    queue_.push_back(std::move(snapshot));
    exact_waits_ = true;
  }
  /// The last word, which has room whatever waits, and comes after all of it.
  void push_last(Shared bytes) {
    if (snapshot_) queue_.push_back(std::exchange(snapshot_, nullptr));
    queue_.push_back(std::move(bytes));
  }
  void replace_snapshot(Shared snapshot) { snapshot_ = std::move(snapshot); }

  bool exact_waits() const { return exact_waits_; }
  bool empty() const { return queue_.empty() && !snapshot_; }
  void clear() { (void)take(); }

  /// All that waits, in order.
  std::vector<Shared> take() {
    if (snapshot_) queue_.push_back(std::move(snapshot_));
    snapshot_.reset();
    bytes_ = 0;
    exact_waits_ = false;
    return std::exchange(queue_, {});
  }

 private:
  std::size_t bytes_max_;
  std::size_t bytes_ = 0;
  std::vector<Shared> queue_;
  Shared snapshot_;
  bool exact_waits_ = false;
};

}  // namespace cycloid::server
