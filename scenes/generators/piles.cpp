#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

static SceneBody box_at(float x, float y) {
  SceneBody body;
  body.position = {x, y, 0.0f};
  body.shapes.push_back(box_shape(0.5f, 0.5f));
  return body;
}

Scene pyramid(int base) {
  Scene scene = planar_scene("pyramid", "Unit boxes in a pyramid; a seat throws balls at it.");
  scene.name += "-" + std::to_string(base);
  scene.bodies.push_back(ground());
  for (int row = 0; row < base; ++row)
    for (int i = 0; i < base - row; ++i) {
      const float x = static_cast<float>(i) - 0.5f * static_cast<float>(base - row - 1);
      scene.bodies.push_back(box_at(1.05f * x, 0.5f + static_cast<float>(row)));
    }
  const float reach = 0.6f * static_cast<float>(base) + 8.0f;
  add_thrower(scene, {-reach, 4.0f, 0.0f}, {14.0f, 4.0f, 0.0f});
  return scene;
}

Scene stack(int count) {
  Scene scene = planar_scene("stack", "Unit boxes one on the other; a seat throws balls at them.");
  scene.name += "-" + std::to_string(count);
  scene.bodies.push_back(ground());
  for (int i = 0; i < count; ++i)
    scene.bodies.push_back(box_at(i % 2 == 0 ? 0.01f : -0.01f, 0.5f + static_cast<float>(i)));
  add_thrower(scene, {-12.0f, 3.0f, 0.0f}, {10.0f, 4.0f, 0.0f});
  return scene;
}

static SceneBody card_at(float x, float y, float angle) {
  SceneBody body;
  body.position = {x, y, 0.0f};
  body.angle = angle;
  body.shapes.push_back(box_shape(0.001f, 0.2f));
  return body;
}

// Cards of 2 x 400 mm that lean by 25 degrees, under flat ones that overlap a little. Source of the
// measures: PEEL's card house (Terdiman), as in Catto's Solver2D.
Scene card_house(int storeys) {
  Scene scene = planar_scene("card-house", "Thin leaning cards; friction alone holds them.");
  if (storeys != 5) scene.name += "-" + std::to_string(storeys);
  scene.materials[0].friction = 0.7f;
  scene.bodies.push_back(ground());
  const float lean = 25.0f * solver::kPi / 180.0f;
  const float step = 0.175f;
  float y = 0.18f;
  float left = -step * static_cast<float>(storeys);
  for (int storey = storeys; storey > 0; --storey) {
    float x = left;
    for (int pair = 0; pair < storey; ++pair) {
      if (pair + 1 < storey)
        scene.bodies.push_back(card_at(x + 0.25f, y + 0.185f, 0.5f * solver::kPi));
      scene.bodies.push_back(card_at(x, y, -lean));
      scene.bodies.push_back(card_at(x + step, y, lean));
      x += 2.0f * step;
    }
    y += 0.37f;
    left += step;
  }
  add_thrower(scene, {-6.0f, 1.0f, 0.0f}, {5.0f, 3.0f, 0.0f});
  scene.prefabs[0].shapes[0].radius = 0.1f;
  scene.prefabs[0].shapes[0].density = 1.0f;
  scene.seats[0].script[0].from = 300;
  return scene;
}

}  // namespace cycloid::scenes
