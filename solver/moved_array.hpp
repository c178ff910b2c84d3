#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "solver/workers.hpp"

namespace cycloid::solver {

/// An array of records of which a tick moves only a part, `T::Moved`, a base of T; the other,
/// `T::Kept`, changes by edits alone. Reads as a const vector does. What is made of the kept parts,
/// as their digest, is so made once and cannot be stale: there is no other way to write them.
template <class T>
class MovedArray {
 public:
  const T& operator[](std::size_t i) const { return items_[i]; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return items_.data() + items_.size(); }
  const T* data() const { return items_.data(); }
  std::size_t size() const { return items_.size(); }
  std::size_t capacity() const { return items_.capacity(); }
  bool empty() const { return items_.empty(); }

  /// The part of a record that ticks move. Each from one thread at a time.
  typename T::Moved& moved(std::size_t i) { return items_[i]; }

  /// The number that `make` makes of the kept parts, and of nothing else; made once until the
  /// array is edited. Always the same `make` for an array.
  template <class Make>
  std::uint64_t kept_number(Make&& make) const {
    return number_.get(make);
  }

  /// Calls change(std::vector<T>&) with the array and returns what it does. The vector is good
  /// until `change` returns.
  template <class Change>
  decltype(auto) edit(Change&& change) {
    number_.forget();
    return change(items_);
  }

  /// As `edit`, with one of the records.
  template <class Change>
  decltype(auto) edit_one(std::size_t i, Change&& change) {
    return edit([&](std::vector<T>& items) { return change(items[i]); });
  }

 private:
  std::vector<T> items_;
  mutable KeptNumber number_;
};

}  // namespace cycloid::solver
