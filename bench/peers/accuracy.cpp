#include "bench/peers/accuracy.hpp"

#include "solver/collision/bounds_tree.hpp"
#include "solver/collision/collide.hpp"

namespace cycloid::peers {

using solver::Body;
using solver::Joint;
using solver::JointKind;
using solver::Pose;
using solver::Shape;
using solver::ShapeKind;
using solver::WorldState;

static bool may_meet(const WorldState<3>& state, const Shape<3>& a, const Shape<3>& b) {
  if (a.body == b.body || !filters_meet(a.filter, b.filter)) return false;
  if (state.bodies[a.body].inverse_mass == 0.0f && state.bodies[b.body].inverse_mass == 0.0f)
    return false;
  for (const Joint<3>& joint : state.joints)
    if (joint.kind != JointKind::kFree && joint.collide_connected == 0 &&
        ((joint.body_a == a.body && joint.body_b == b.body) ||
         (joint.body_a == b.body && joint.body_b == a.body)))
      return false;
  return true;
}

static float overlap_of(const WorldState<3>& state, const Poses& poses, const Shape<3>& a,
                        const Shape<3>& b) {
  if (!may_meet(state, a, b)) return 0.0f;
  const auto manifold = collide(a, poses(a.body), b, poses(b.body), 0.0f, state.polyhedra);
  float depth = 0.0f;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i)
    depth = std::max(depth, -manifold.points[i].separation);
  return depth;
}

float deepest_overlap(const WorldState<3>& state, const Poses& poses) {
  std::vector<solver::BoundsTree<3>::Leaf> leaves;
  std::vector<std::uint32_t> half_spaces;
  for (std::uint32_t s = 0; s < state.shapes.size(); ++s) {
    const Shape<3>& shape = state.shapes[s];
    if (shape.kind == ShapeKind::kFree) continue;
    if (shape.kind == ShapeKind::kHalfSpace)
      half_spaces.push_back(s);
    else
      leaves.push_back({bounds_of(shape, poses(shape.body), 0.0f), s});
  }
  solver::BoundsTree<3> tree;
  tree.build(leaves);
  float depth = 0.0f;
  for (const auto& leaf : leaves) {
    const Shape<3>& shape = state.shapes[leaf.id];
    for (const std::uint32_t s : half_spaces)
      depth = std::max(depth, overlap_of(state, poses, shape, state.shapes[s]));
    tree.query(leaf.bounds, [&](int rank) {
      const std::uint32_t other = tree.leaf(rank).id;
      if (other > leaf.id)
        depth = std::max(depth, overlap_of(state, poses, shape, state.shapes[other]));
    });
  }
  return depth;
}

static bool holds_points(JointKind kind) {
  return kind == JointKind::kRevolute || kind == JointKind::kWeld || kind == JointKind::kHinge ||
         kind == JointKind::kConeTwist;
}

float widest_gap(const WorldState<3>& state, const Poses& poses) {
  float widest = 0.0f;
  for (const Joint<3>& joint : state.joints) {
    if (!holds_points(joint.kind)) continue;
    const Pose<3> a = poses(joint.body_a);
    const Pose<3> b = poses(joint.body_b);
    const auto gap = (b.position - a.position) +
                     (rotate(b.rotation, joint.anchor_b) - rotate(a.rotation, joint.anchor_a));
    widest = std::max(widest, length(gap));
  }
  return widest;
}

}  // namespace cycloid::peers
