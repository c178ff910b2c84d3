#pragma once

#include <algorithm>

#include "solver/fetch_ahead.hpp"
#include "solver/step_scratch.hpp"

namespace cycloid::solver {

template <int D>
std::uint64_t key_of(const Contact<D>& contact) {
  return ShapePair{contact.shape_a, contact.shape_b}.key();
}

/// The contacts of the state of which a body takes part by itself, in their order. Of the others,
/// which rest, nothing can have moved: nobody looks for their pairs, and they stay as they are.
template <int D>
class OldContacts {
 public:
  OldContacts(const WorldState<D>& state, const ActiveContacts& active)
      : contacts_(state.contacts.data()),
        places_(active.are_all ? nullptr : active.places.data()),
        size_(static_cast<std::uint32_t>(active.are_all ? state.contacts.size()
                                                        : active.places.size())) {}
  std::uint32_t size() const { return size_; }
  /// Its place among all contacts of the state.
  std::uint32_t place(std::uint32_t i) const { return places_ == nullptr ? i : places_[i]; }
  const Contact<D>& operator[](std::uint32_t i) const { return contacts_[place(i)]; }
  std::uint64_t key(std::uint32_t i) const { return key_of((*this)[i]); }
  /// Those from i on, so many at most, are read soon.
  void fetch(std::uint32_t i, std::uint32_t count) const {
    for (const std::uint32_t end = i + std::min(count, size_ - i); i < end; ++i)
      fetch_ahead((*this)[i]);
  }
  /// The first whose key is not below.
  std::uint32_t lower_bound(std::uint64_t key) const;

 private:
  const Contact<D>* contacts_;
  const std::uint32_t* places_;  ///< Null where they are all.
  std::uint32_t size_;
};

/// Finds out which contacts rest, where that is not known. @pre find_pairs.
template <int D>
void list_active_contacts(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch);

/// How many contacts the world has in this tick, with those that rest. @pre collide_pairs.
template <int D>
std::size_t contact_count(const WorldState<D>& state, const StepScratch<D>& scratch);

/// Puts those that rest beside the others of the tick, in the order of their keys. What names a
/// contact of the tick by its place names it by its new one.
template <int D>
void take_in_resting(const WorldState<D>& state, StepScratch<D>& scratch);

/// The contacts of the tick become those of the state: only those that do not rest are written,
/// unless some came or ended.
template <int D>
void take_contacts(Workers& workers, StepScratch<D>& scratch, WorldState<D>& state);

}  // namespace cycloid::solver
