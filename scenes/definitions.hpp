#pragma once

#include "scenes/scene.hpp"

namespace cycloid::scenes {

/// The parts of a scene in the terms of the solver. Names are not resolved here: bodies of joints
/// and materials of shapes are left for whoever knows them.

template <int D>
solver::Vec<D> vec(const Triple& from) {
  solver::Vec<D> to;
  for (int i = 0; i < D; ++i) to[i] = from[static_cast<std::size_t>(i)];
  return to;
}

/// Without shapes.
template <int D>
solver::BodyDef<D> body_def(const SceneBody& from);

template <int D>
solver::ShapeDef<D> shape_def(const SceneShape& from);

template <int D>
solver::JointDef<D> joint_def(const SceneJoint& from);

}  // namespace cycloid::scenes
