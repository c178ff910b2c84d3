#pragma once

#include <utility>
#include <vector>

#include "tests/solver/query_3d_fixture.hpp"
#include "tests/solver/query_fixture.hpp"

namespace cycloid::solver {

/// A state with static shapes that no world need know how to make.
inline WorldState<3> state_of(const std::vector<std::pair<Shape<3>, Pose<3>>>& placed,
                              Polyhedra pools = {}) {
  WorldState<3> state;
  state.polyhedra = std::move(pools);
  for (const auto& [shape, pose] : placed) {
    Body<3> body{};
    body.kind = BodyKind::kStatic;
    body.position = pose.position;
    body.rotation = pose.rotation;
    Shape<3> owned = shape;
    owned.body = static_cast<std::uint32_t>(state.bodies.size());
    state.bodies.edit([&](auto& bodies) { bodies.push_back(body); });
    state.shapes.edit([&](auto& shapes) { shapes.push_back(owned); });
  }
  return state;
}
inline WorldState<3> state_of(const Shape<3>& shape, Vec<3> position = Vec<3>::zero(),
                              Rotation<3> rotation = identity_rotation<3>()) {
  return state_of({{shape, {position, rotation}}});
}

inline Probe<3> capsule_probe(Vec<3> from, Vec<3> to, float radius) {
  Probe<3> probe = ball_probe<3>(radius);
  probe.count = 2;
  probe.points[0] = from;
  probe.points[1] = to;
  return probe;
}
inline Probe<3> block_probe(Vec<3> half) {
  Probe<3> probe = ball_probe<3>(0.0f);
  probe.count = 8;
  for (std::uint32_t i = 0; i < 8; ++i)
    for (int k = 0; k < 3; ++k) probe.points[i][k] = (i >> k & 1u) != 0 ? half[k] : -half[k];
  return probe;
}

}  // namespace cycloid::solver
