#include "bench/peers/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "solver/collision/bounds_tree.hpp"
#include "solver/collision/collide.hpp"
#include "solver/constraints/joint_row.hpp"

namespace cycloid::peers {

using solver::Joint;
using solver::JointKind;
using solver::Pose;
using solver::Shape;
using solver::ShapeKind;
using solver::WorldState;

/// Bodies whose joint keeps their shapes from colliding; the lower slot first.
using JoinedBodies = std::set<std::pair<std::uint32_t, std::uint32_t>>;

template <int D>
static JoinedBodies joined_bodies(const WorldState<D>& state) {
  JoinedBodies joined;
  for (const Joint<D>& joint : state.joints)
    if (joint.kind != JointKind::kFree && joint.collide_connected == 0)
      joined.insert(std::minmax(joint.body_a, joint.body_b));
  return joined;
}

template <int D>
static bool may_meet(const WorldState<D>& state, const JoinedBodies& joined, const Shape<D>& a,
                     const Shape<D>& b) {
  if (a.body == b.body || !filters_meet(a.filter, b.filter)) return false;
  if (state.bodies[a.body].inverse_mass == 0.0f && state.bodies[b.body].inverse_mass == 0.0f)
    return false;
  return !joined.contains(std::minmax(a.body, b.body));
}

template <int D>
static float overlap_of(const WorldState<D>& state, const Poses<D>& poses, const Shape<D>& a,
                        const Shape<D>& b) {
  const auto manifold = collide(a, poses(a.body), b, poses(b.body), 0.0f, state.polyhedra);
  float depth = 0.0f;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i)
    depth = std::max(depth, -manifold.points[i].separation);
  return depth;
}

template <int D>
std::vector<float> overlaps_of(const WorldState<D>& state, const Poses<D>& poses) {
  std::vector<typename solver::BoundsTree<D>::Leaf> leaves;
  std::vector<std::uint32_t> half_spaces;
  for (std::uint32_t s = 0; s < state.shapes.size(); ++s) {
    const Shape<D>& shape = state.shapes[s];
    if (shape.kind == ShapeKind::kFree) continue;
    if (shape.kind == ShapeKind::kHalfSpace)
      half_spaces.push_back(s);
    else
      leaves.push_back({bounds_of(shape, poses(shape.body), 0.0f), s});
  }
  solver::BoundsTree<D> tree;
  solver::TreeRoom<D> room;
  solver::Workers alone(1);
  tree.build(leaves, alone, room);
  const JoinedBodies joined = joined_bodies(state);
  std::vector<float> depths;
  const auto meet = [&](const Shape<D>& a, const Shape<D>& b) {
    if (!may_meet(state, joined, a, b)) return;
    const float depth = overlap_of(state, poses, a, b);
    if (depth > 0.0f) depths.push_back(depth);
  };
  for (const auto& leaf : leaves) {
    const Shape<D>& shape = state.shapes[leaf.id];
    for (const std::uint32_t s : half_spaces) meet(shape, state.shapes[s]);
    tree.query(leaf.bounds, [&](int rank) {
      const std::uint32_t other = tree.leaf(rank).id;
      if (other > leaf.id) meet(shape, state.shapes[other]);
    });
  }
  return depths;
}

/// How far [m] a coordinate is beyond the limits of its joint.
template <int D>
static float beyond_limits(const Joint<D>& joint, float coordinate) {
  return std::max({joint.lower - coordinate, coordinate - joint.upper, 0.0f});
}

/// How far [m] a joint is from the lengths that it asks for: by its equalities, and beyond the
/// limits of its coordinate. Nothing where it asks for none.
template <int D>
static std::optional<float> off_lengths(const solver::JointFrame<D>& frame) {
  solver::JointRows<D> rows;
  rows.clear();
  solver::rows_of(frame, rows);
  const bool is_limited = rows.has_axis && frame.joint.limit_enabled != 0;
  if (rows.count == 0 && !is_limited) return {};
  const float beyond = is_limited ? beyond_limits(frame.joint, rows.axis.error) : 0.0f;
  float square = beyond * beyond;
  // Where a joint has more rows than these, the others are of its rotation.
  for (int i = 0; i < std::min(rows.count, solver::Dim<D>::kTangents); ++i) {
    const float error = rows.rows[static_cast<std::size_t>(i)].error;
    square += error * error;
  }
  return std::sqrt(square);
}

/// Nothing of a joint that gives way by design, holds no lengths, or whose rows nobody knows here.
template <int D>
static std::optional<float> joint_gap_of(const WorldState<D>& state, const Joint<D>& joint,
                                         const Poses<D>& poses) {
  if (joint.kind == JointKind::kFree || solver::springs_of(joint).first) return {};
  const Pose<D> a = poses(joint.body_a);
  const Pose<D> b = poses(joint.body_b);
  const auto frame = solver::make_frame(state, joint, a.position, b.position - a.position,
                                        a.rotation, b.rotation, 0.0f);
  switch (joint.kind) {
    case JointKind::kRevolute:
    case JointKind::kWeld:
    case JointKind::kHinge:
    case JointKind::kConeTwist:
      return length(frame.offset);
    case JointKind::kDistance:
    case JointKind::kPrismatic:
    case JointKind::kWheel:
    case JointKind::kPulley:
    case JointKind::kCurve:
      return off_lengths(frame);
    case JointKind::kFree:
    case JointKind::kMotor:
    case JointKind::kTarget:
    case JointKind::kGear:
    case JointKind::kUser:
      break;
  }
  return {};
}

template <int D>
std::vector<float> gaps_of(const WorldState<D>& state, const Poses<D>& poses) {
  std::vector<float> gaps;
  for (const Joint<D>& joint : state.joints)
    if (const std::optional<float> gap = joint_gap_of(state, joint, poses)) gaps.push_back(*gap);
  return gaps;
}

static float largest_of(const std::vector<float>& sizes) {
  return sizes.empty() ? 0.0f : *std::max_element(sizes.begin(), sizes.end());
}

template <int D>
bool are_finite(const WorldState<D>& state, const Poses<D>& poses) {
  for (std::uint32_t i = 0; i < state.bodies.size(); ++i)
    for (const float value : poses(i).position.v)
      if (!std::isfinite(value)) return false;
  return true;
}

template <int D>
Accuracy measure_accuracy(const WorldState<D>& state, const Poses<D>& poses) {
  Accuracy accuracy;
  accuracy.finite = are_finite(state, poses);
  if (!accuracy.finite) return accuracy;
  accuracy.overlap_m = largest_of(overlaps_of(state, poses));
  accuracy.gap_m = largest_of(gaps_of(state, poses));
  return accuracy;
}

template bool are_finite(const WorldState<2>&, const Poses<2>&);
template bool are_finite(const WorldState<3>&, const Poses<3>&);
template Accuracy measure_accuracy(const WorldState<2>&, const Poses<2>&);
template Accuracy measure_accuracy(const WorldState<3>&, const Poses<3>&);
template std::vector<float> overlaps_of(const WorldState<2>&, const Poses<2>&);
template std::vector<float> overlaps_of(const WorldState<3>&, const Poses<3>&);
template std::vector<float> gaps_of(const WorldState<2>&, const Poses<2>&);
template std::vector<float> gaps_of(const WorldState<3>&, const Poses<3>&);

}  // namespace cycloid::peers
