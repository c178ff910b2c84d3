#pragma once

#include <string>
#include <vector>

#include "solver/world.hpp"
#include "tests/properties/case.hpp"

namespace cycloid::properties {

/// The meaning of a command's integers. Most definitions are good; some are refused, which both
/// runs must do with the same words.

/// Number of the kind of joint whose rows are the test's own.
inline constexpr std::uint32_t kShelf = 3;

solver::Tuning tuning_of(std::uint32_t choice);

/// What a kTuning command asks of a world that has `now`: a whole other tuning, or, where b is odd,
/// the same with one thing changed, as a cache must notice it whatever else stays.
solver::Tuning tuning_after(const solver::Tuning& now, const Command& command);

template <int D>
solver::WorldDef<D> world_of(const Case& example);

/// A body and its shapes.
template <int D>
struct Piece {
  solver::BodyDef<D> body;
  std::vector<solver::ShapeDef<D>> shapes;
};

/// What lies below; nothing in `shapes` for choice 0.
template <int D>
Piece<D> ground_of(std::uint32_t choice);
template <int D>
Piece<D> piece_of(const Command& command);
/// Boxes and balls in rows, enough of them for workers and lanes to share.
template <int D>
std::vector<Piece<D>> grid_of(const Command& command);
/// A static body and balls that belong on it one after the other by joints at their own centres,
/// mostly with a heavy one at the end: islands that are solved at once.
template <int D>
std::vector<Piece<D>> chain_of(const Command& command);
/// `body_a` and `body_b` are left to the caller.
template <int D>
solver::JointDef<D> joint_of(const Command& command);

/// Elements [first, first + D) of the command's numbers, in m.
template <int D>
solver::Vec<D> vector_of(const Command& command, std::size_t first);
template <int D>
solver::Spin<D> spin_of(const Command& command, std::size_t first);
template <int D>
solver::Rotation<D> rotation_of(int value);
float number_of(const Command& command, std::size_t index);
/// A size from `value`: above 0, of 0.1 m to a few m.
float size_of(int value);

solver::ShapeDef<2> box_of(const solver::Vec<2>& half);
solver::ShapeDef<3> box_of(const solver::Vec<3>& half);
/// Uneven land: a chain from right to left, or a height field.
solver::ShapeDef<2> land(solver::ShapeDef<2> shape);
solver::ShapeDef<3> land(solver::ShapeDef<3> shape);

template <int D>
void register_shelf(solver::World<D>& world);

std::string name_of(solver::JointKind kind);

}  // namespace cycloid::properties
