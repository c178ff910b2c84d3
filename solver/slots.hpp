#pragma once

#include <cstdint>
#include <vector>

#include "solver/shared_array.hpp"

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

template <class Record>
void free_slot(std::uint32_t index, SharedArray<Record>& slots, std::vector<std::uint32_t>& free) {
  slots.edit([&](std::vector<Record>& own) { free_slot(index, own, free); });
}

}  // namespace cycloid::solver
