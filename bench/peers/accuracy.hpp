#pragma once

#include <functional>
#include <vector>

#include "solver/collision/manifold.hpp"
#include "solver/world.hpp"

namespace cycloid::peers {

/// Where every body of a state is, by slot: centre of mass, world.
template <int D>
using Poses = std::function<solver::Pose<D>(std::uint32_t body)>;

/// One ruler for every engine: our manifolds and what our joints hold, at given poses.
struct Accuracy {
  float overlap_m = 0.0f;  ///< The deepest of any two shapes that may collide.
  float gap_m = 0.0f;      ///< The widest of `gaps_of`; 0 without such joints.
  /// Whether every body is somewhere: an engine may lose one to infinity.
  bool finite = true;
};

/// Every pair of shapes whose boxes meet is tried: O(n log n).
/// @param state  the scene at tick 0, whoever has made the poses.
template <int D>
Accuracy measure_accuracy(const solver::WorldState<D>& state, const Poses<D>& poses);

/// Whether every body of the state is somewhere.
template <int D>
bool are_finite(const solver::WorldState<D>& state, const Poses<D>& poses);

/// The depth [m] of every pair of shapes that may collide and overlaps, in no particular order.
/// @pre every pose is finite; otherwise as `measure_accuracy`.
template <int D>
std::vector<float> overlaps_of(const solver::WorldState<D>& state, const Poses<D>& poses);

/// How far [m] every rigid joint is from where it belongs, by slot: revolute, weld, hinge and
/// cone-twist by the distance of their anchors, distance joint and pulley by what their length is
/// off, prismatic and wheel by the way across their axis, a curve's joint by the distance from the
/// curve. Where a joint has limits in m (a rope, a slider), by what it is beyond them too.
///
/// Left out is what gives way by design: a weld with `hertz`, a distance joint on a spring or a
/// motor alone, motor and target joints. So are gears and joints of the user, and angles of all,
/// for they have no size in m here. The distance from an ellipse is to first order.
template <int D>
std::vector<float> gaps_of(const solver::WorldState<D>& state, const Poses<D>& poses);

}  // namespace cycloid::peers
