#pragma once

#include <cstdint>
#include <vector>

namespace cycloid::solver {

/// The slot that the next record takes: the last freed, else a new one. Fails at the limit.
template <class Slots>
bool has_room(const Slots& slots, const std::vector<std::uint32_t>& free, std::size_t wanted,
              std::uint32_t limit) {
  return slots.size() - free.size() + wanted <= limit;
}

template <class Record>
std::uint32_t take_slot(std::vector<Record>& slots, std::vector<std::uint32_t>& free) {
  if (free.empty()) {
    // By a quarter: a server holds hundreds of worlds, each with the room that nothing takes.
    const std::size_t more = slots.size() / 4;
    if (slots.size() == slots.capacity()) slots.reserve(slots.size() + (more < 8 ? 8 : more));
    slots.push_back(Record{});
    return static_cast<std::uint32_t>(slots.size() - 1);
  }
  const std::uint32_t index = free.back();
  free.pop_back();
  return index;
}

/// Empties a slot for the next one to take; whoever still names it is refused by its generation.
template <class Record>
void free_slot(std::uint32_t index, std::vector<Record>& slots, std::vector<std::uint32_t>& free) {
  const std::uint32_t generation = slots[index].generation + 1;
  slots[index] = Record{};
  slots[index].generation = generation;
  free.push_back(index);
}

/// Of arrays that are changed by edits.
template <class Slots>
std::uint32_t take_slot(Slots& slots, std::vector<std::uint32_t>& free) {
  return slots.edit([&](auto& own) { return take_slot(own, free); });
}
template <class Slots>
void free_slot(std::uint32_t index, Slots& slots, std::vector<std::uint32_t>& free) {
  slots.edit([&](auto& own) { free_slot(index, own, free); });
}

}  // namespace cycloid::solver
