#pragma once

#include <bit>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solver/bytes.hpp"
#include "solver/visit.hpp"
#include "solver/world.hpp"

namespace cycloid::hostile {

/// What a snapshot that nobody vouches for may do: be refused and change nothing, or be a state
/// that steps, or faults, and whose own encoding is again a good snapshot.

using Encoded = std::vector<std::byte>;

template <int D>
Encoded encoded(const solver::World<D>& world) {
  Encoded bytes;
  world.encode(bytes);
  return bytes;
}

struct Verdict {
  bool accepted = false;
  std::uint64_t digest = 0;  ///< After decoding.
  std::string complaint;     ///< "" where all is as it should be.
};

/// Steps a world that came from outside; returns what is wrong with it, "" for nothing.
template <int D>
std::string steps_without_harm(solver::World<D>& world, int ticks) {
  for (int tick = 0; tick < ticks; ++tick) {
    const solver::Error error = world.step();
    if (error.code == solver::Code::kFaulted) break;
    const bool unregistered =
        error.code == solver::Code::kInvalid && std::string(error.field) == "user_kind";
    if (!error.ok() && !unregistered)
      return std::string("a step returns ") + solver::code_name(error.code) + " " + error.field;
  }
  const Encoded bytes = encoded(world);
  solver::World<D> copy = std::move(solver::World<D>::create({}).value());
  const solver::Error error = copy.decode(bytes);
  if (!error.ok())
    return std::string("what it became is refused: ") + error.field + " " +
           std::to_string(error.index);
  return copy.digest() == world.digest() ? "" : "what it became is another state when decoded";
}

/// Decodes into `target`, and steps it where it is taken. `target` is used up by one that is taken.
template <int D>
Verdict try_snapshot(std::span<const std::byte> bytes, int ticks, solver::World<D>& target) {
  Verdict verdict;
  const std::uint64_t before = target.digest();
  const solver::Error error = target.decode(bytes);
  verdict.digest = target.digest();
  if (!error.ok()) {
    if (error.code != solver::Code::kCorrupt) verdict.complaint = "refused, but not as corrupt";
    if (verdict.digest != before) verdict.complaint = "refused, and the world changed";
    return verdict;
  }
  verdict.accepted = true;
  const Encoded again = encoded(target);
  if (!std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()))
    verdict.complaint = "taken, and encoded to other bytes";
  else
    verdict.complaint = steps_without_harm(target, ticks);
  return verdict;
}

/// Calls f(where, value) for every number of a state, by reference.
template <int D, class F>
void for_each_number(solver::WorldState<D>& state, F&& f) {
  solver::visit_words(state.header, [&](auto& value) { f("header", value); });
  solver::visit_arrays(state, [&](const char* name, auto& array) {
    for (auto& element : array) solver::visit_words(element, [&](auto& value) { f(name, value); });
  });
}

/// The numbers that hurt.
inline const std::vector<std::uint32_t>& extremes() {
  using Float = std::numeric_limits<float>;
  static const std::vector<std::uint32_t> kBits = {
      0u,
      1u,  // As a float the least subnormal.
      2u,
      7u,
      0x00ffffffu,
      0x7fffffffu,  // As a float a NaN.
      0x80000000u,
      0xfffffffeu,
      0xffffffffu,
      std::bit_cast<std::uint32_t>(Float::quiet_NaN()),
      std::bit_cast<std::uint32_t>(Float::infinity()),
      std::bit_cast<std::uint32_t>(-Float::infinity()),
      std::bit_cast<std::uint32_t>(Float::max()),
      std::bit_cast<std::uint32_t>(Float::min()),
      std::bit_cast<std::uint32_t>(-1.0f),
      std::bit_cast<std::uint32_t>(1.0f),
      std::bit_cast<std::uint32_t>(1.0e30f),
      std::bit_cast<std::uint32_t>(-1.0e30f),
      std::bit_cast<std::uint32_t>(1.0e7f),
      std::bit_cast<std::uint32_t>(1.0e-12f),
  };
  return kBits;
}

/// Where in an encoding the counts of its arrays lie.
template <int D>
std::vector<std::size_t> count_places(const solver::WorldState<D>& state) {
  std::vector<std::size_t> places;
  std::size_t at = 2 * sizeof(std::uint32_t) + solver::visited_bytes<solver::WorldHeader<D>>();
  solver::visit_arrays(state, [&](const char*, const auto& array) {
    using Element = std::remove_cvref_t<decltype(array[0])>;
    places.push_back(at);
    at += sizeof(std::uint32_t) + array.size() * solver::visited_bytes<Element>();
  });
  return places;
}

}  // namespace cycloid::hostile
