#pragma once

#include <span>
#include <string>
#include <vector>

#include "scenes/build.hpp"

namespace cycloid::scenes {

/// Words of the state of one character: position, velocity, whether it is grounded, the body it
/// stands on (index + 1, generation; 0, 0 for none), and that body's velocity there. Numbers are
/// the bits of finite floats without -0, so that equal states are equal words.
template <int D>
inline constexpr std::uint32_t kCharacterRegisters = 3 * D + 3;

/// What the seats want of a character in one tick.
template <int D>
struct CharacterWish {
  solver::Vec<D> walk = solver::Vec<D>::zero();  ///< World; a length of 1 is full speed.
  bool jump = false;
};

/// The character of a scene in the terms of the solver, without registers yet. Appends a mistake
/// under `path` for each field that is out of range.
template <int D>
Character<D> make_character(const SceneCharacter& from, const std::string& path,
                            std::vector<Mistake>& mistakes);

/// The character's state from the registers. The words may come from outside: whatever they are,
/// the state is finite and bounded. A position or velocity that is not counts as the start, at
/// rest; ground that is not counts as none.
/// @pre i < built.characters.size(), and the registers are as many as the scene made.
template <int D>
solver::MoverState<D> character_state(const Built<D>& built, std::size_t i);

/// Writes a state to the registers; one that is not finite and bounded is refused with false, and
/// nothing has changed. @pre as for character_state.
template <int D>
bool set_character_state(Built<D>& built, std::size_t i, const solver::MoverState<D>& state);

/// Puts every character where the scene has it, at rest and off the ground.
template <int D>
void start_characters(Built<D>& built);

/// Whether the registers hold what set_character_state writes. @pre as for character_state.
template <int D>
bool characters_fit(const Built<D>& built);

/// Moves every character by one tick, in their order, through the world as it is before the step:
/// its velocity goes towards what is wished as fast as its acceleration allows, gravity and a jump
/// are added, solver::move finds the way, and the bodies that it pushes get their impulses, which
/// the next character sees. Where the result would leave the bounded range, the character stays
/// where it is, at rest. @pre a wish for each character.
template <int D>
void move_characters(Built<D>& built, std::span<const CharacterWish<D>> wishes);

}  // namespace cycloid::scenes
