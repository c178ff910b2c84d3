#pragma once

#include "solver/definitions.hpp"
#include "solver/result.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// Greatest magnitudes of a bounded world. Beyond them float32 has no useful precision left, and
/// products of such values stay finite, so that the fault is found in the tick that makes it.
inline constexpr float kPositionMax = 1.0e7f;  ///< m
inline constexpr float kSpeedMax = 1.0e5f;     ///< m/s
inline constexpr float kSpinMax = 1.0e5f;      ///< rad/s
inline constexpr float kForceMax = 1.0e12f;    ///< N, N s, N m, N m s
inline constexpr float kMassMax = 1.0e12f;     ///< kg
inline constexpr float kMassMin = 1.0e-9f;     ///< kg
inline constexpr float kSizeMin = 1.0e-4f;     ///< m: radii and edges
inline constexpr float kSizeMax = 1.0e6f;      ///< m

/// Sweeps of a tick, of all substeps together: with the limits it bounds what a tick can take.
inline constexpr std::uint32_t kSweepsMax = 8192;

inline constexpr float kSteeringMax = 1.6f;  ///< rad

/// The refusal of a field, of element `index` where it has several.
constexpr Error invalid(const char* field, int index = -1) {
  return {Code::kInvalid, field, index};
}

/// False for NaN too.
inline bool within(float value, float lower, float upper) {
  return value >= lower && value <= upper;
}

template <int N>
bool within(const Vec<N>& vector, float bound) {
  for (float value : vector.v)
    if (!within(value, -bound, bound)) return false;
  return true;
}

template <int N>
bool is_unit(const Vec<N>& vector) {
  return within(dot(vector, vector), 0.998f, 1.002f);
}

/// Which kinds there are; `spin` is Dim<D>::kSpin.
bool exists(JointKind kind, int spin);
bool needs_axis(JointKind kind);
/// Whether this axle goes with this axis: none in the plane, in space a unit vector across it.
bool fits_wheel(const Vec<2>& axis, const Vec<2>& axle);
bool fits_wheel(const Vec<3>& axis, const Vec<3>& axle);
/// Which kinds have a coordinate that motors drive and which take limits; `spin` is Dim<D>::kSpin.
bool has_coordinate(JointKind kind, int spin);
bool has_limits(JointKind kind, int spin);
/// Largest magnitude of a limit, rad or m: an angle stays within half a turn.
float limit_max(JointKind kind);

Error validate(const Tuning& tuning);
Error validate(const Limits& limits);
Error validate(const Material& material, int index);
template <int D>
Error validate(const WorldDef<D>& def);
template <int D>
Error validate(const BodyDef<D>& def);
/// Range checks alone; convexity is found out when the shape is made (shapes.hpp).
template <int D>
Error validate(const ShapeDef<D>& def, BodyKind body, std::size_t materials, int index);
template <int D>
Error validate(const JointDef<D>& def);

/// Whether a joint in use has settings that World's calls could have given it, and anchors that a
/// body could have. @pre joint.kind != kFree.
template <int D>
bool is_reachable(const Joint<D>& joint);
/// Kinds whose solid has no end, or only one side: those of static bodies.
bool is_of_static_bodies(ShapeKind kind);

/// A whole state that came from outside: every index, list, number and enumerator, so that stepping
/// it reads and writes nothing out of bounds. kCorrupt with the name of the array.
template <int D>
Error validate(const WorldState<D>& state);

}  // namespace cycloid::solver
