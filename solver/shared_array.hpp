#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "solver/workers.hpp"

namespace cycloid::solver {

/// An array that its copies share until one of them is edited: for what seldom changes and is
/// copied in every tick. Reads as a const vector does. Copies may live on different threads.
template <class T>
class SharedArray {
 public:
  SharedArray() = default;
  SharedArray(const SharedArray& other)
      : begin_(other.begin_), end_(other.end_), block_(other.block_) {
    if (block_ != nullptr) block_->owners.take();
  }
  SharedArray(SharedArray&& other) noexcept { swap(other); }
  /// Of the same array: nothing at all, which is what saving and restoring again and again meet.
  SharedArray& operator=(const SharedArray& other) {
    if (block_ != other.block_) SharedArray(other).swap(*this);
    return *this;
  }
  SharedArray& operator=(SharedArray&& other) noexcept {
    SharedArray(std::move(other)).swap(*this);
    return *this;
  }
  ~SharedArray() {
    if (block_ != nullptr && block_->owners.drop()) delete block_;
  }

  const T& operator[](std::size_t i) const { return begin_[i]; }
  const T* begin() const { return begin_; }
  const T* end() const { return end_; }
  const T* data() const { return begin_; }
  std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
  bool empty() const { return begin_ == end_; }

  /// The number that `make` makes of the array, and of nothing else; made once until it is edited,
  /// whichever copies ask. Always the same `make` for an array.
  template <class Make>
  std::uint64_t kept_number(Make&& make) const {
    if (block_ == nullptr) return make();
    return block_->number.get(make);
  }

  /// Whether both are one array, not only equal ones.
  bool is_same_as(const SharedArray& other) const { return block_ == other.block_; }

  /// Gives back what its array has reserved; nothing where copies share it, which would make one
  /// more of it.
  void shrink_to_fit() {
    if (block_ != nullptr && block_->owners.is_one())
      edit([](std::vector<T>& items) { items.shrink_to_fit(); });
  }

  /// Calls change(std::vector<T>&) with the array, which is this copy's own from here on, and
  /// returns what it does. The vector is good until `change` returns.
  template <class Change>
  decltype(auto) edit(Change&& change) {
    own();
    block_->number.forget();
    const Refresh after{*this};
    return change(block_->items);
  }

 private:
  struct Block {
    std::vector<T> items;
    OwnerCount owners;
    KeptNumber number;
  };
  struct Refresh {
    SharedArray& array;
    ~Refresh() {
      array.begin_ = array.block_->items.data();
      array.end_ = array.begin_ + array.block_->items.size();
    }
  };
  void own() {
    if (block_ != nullptr && block_->owners.is_one()) return;
    SharedArray mine;
    mine.block_ = new Block{std::vector<T>(begin_, end_), {}, {}};
    swap(mine);
  }
  void swap(SharedArray& other) noexcept {
    std::swap(begin_, other.begin_);
    std::swap(end_, other.end_);
    std::swap(block_, other.block_);
  }

  const T* begin_ = nullptr;
  const T* end_ = nullptr;
  Block* block_ = nullptr;  ///< Null: never edited, so empty.
};

}  // namespace cycloid::solver
