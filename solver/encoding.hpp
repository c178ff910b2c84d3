#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solver/state.hpp"

namespace cycloid::solver {

/// What World::encode, World::digest and World::decode are made of, for states that are not in a
/// world: kept for a rollback, or come from outside.

/// How many bytes `encode_state` writes.
template <int D>
std::size_t encoded_bytes(const WorldState<D>& state);

/// How many bytes a save copies. Shapes and links are not among them: copies of a state share
/// them until one is edited.
template <int D>
std::size_t saved_bytes(const WorldState<D>& state);

/// The exact state as little-endian bytes, in place of what is in `into`.
template <int D>
void encode_state(const WorldState<D>& state, std::vector<std::byte>& into);

/// World::digest of a world with this state.
template <int D>
std::uint64_t digest_state(const WorldState<D>& state);

/// Takes the numbers out of an encoding, whatever they are: an index may name nothing, a float may
/// be no number. False, with `state` half filled, where the bytes are not as many as they say.
/// Holds at most in proportion to the bytes. For comparing; only World::decode makes a world of it.
template <int D>
bool read_state(std::span<const std::byte> bytes, WorldState<D>& state);

/// 2 or 3, as the bytes begin; 0 where they begin as no encoding of this solver.
int encoded_dimension(std::span<const std::byte> bytes);

/// The digest of an encoding, whatever it holds; none where `read_state` would fail.
std::optional<std::uint64_t> digest_encoding(std::span<const std::byte> bytes);

}  // namespace cycloid::solver
