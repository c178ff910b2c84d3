#pragma once

#include "scenes/generators/generators.hpp"

namespace cycloid::worlds {

using scenes::Scene;
using scenes::SceneBody;
using scenes::SceneShape;
using scenes::Triple;

/// A scene of the plane with one material.
Scene plane_scene(const char* summary, float friction, float restitution);
/// A static box. Boxes and not half-planes, because every engine has boxes.
void add_wall(Scene& scene, const Triple& middle, float half_x, float half_y);
/// A floor whose top is y = 0 and two walls, `half` to either side and `height` high.
void add_bin(Scene& scene, float half, float height);
/// A ball, a box and a capsule in turn, 0.7 to 1 across.
SceneShape mixed_shape(int turn);
void add_body(Scene& scene, const Triple& position, SceneShape shape);

}  // namespace cycloid::worlds
