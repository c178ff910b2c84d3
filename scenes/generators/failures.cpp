#include "scenes/generators/generators.hpp"

namespace cycloid::scenes {

using solver::JointKind;
using solver::Tuning;

/// Capsules of 1 m on pins, from `anchor` of the frame to the right, with a little friction.
/// @returns the name of the last link.
static std::string add_chain(Scene& scene, const Triple& anchor, int links, float density) {
  std::string before = "frame";
  Triple pivot = anchor;
  for (int i = 0; i < links; ++i) {
    const std::string name = "link-" + std::to_string(i);
    const Triple position = {anchor[0] + static_cast<float>(i) + 0.5f, anchor[1], 0.0f};
    SceneBody link =
        body_at(name, position, capsule_shape({-0.5f, 0.0f, 0.0f}, {0.5f, 0.0f, 0.0f}, 0.125f));
    link.shapes[0].density = density;
    scene.bodies.push_back(link);
    scene.joints.push_back(
        joint_between(JointKind::kRevolute, before, pivot, name, {-0.5f, 0.0f, 0.0f}));
    before = name;
    pivot = {0.5f, 0.0f, 0.0f};
  }
  return before;
}

// Links of 5.98 kg carry 4021 kg: 672 to 1. Source of the measures: Catto's Solver2D (2024), Ball &
// Chain. Sweeps over the joints leave gaps of metres; the direct solution leaves none.
Scene chain_and_ball(int links) {
  Scene scene =
      planar_scene("chain-and-ball", "A ball of four tonnes on a chain of light links, as a tree.");
  if (links != 40) scene.name += "-" + std::to_string(links);
  scene.tuning.joint_solver = solver::JointSolver::kDirect;
  scene.bodies.push_back(frame());
  const std::string last = add_chain(scene, {0.0f, 20.0f, 0.0f}, links, 20.0f);
  const float radius = 8.0f;
  const float reach = static_cast<float>(links);
  SceneBody ball = body_at("ball", {reach + radius, 20.0f, 0.0f}, ball_shape(radius));
  ball.shapes[0].density = 20.0f;
  scene.bodies.push_back(ball);
  scene.joints.push_back(
      joint_between(JointKind::kRevolute, last, {0.5f, 0.0f, 0.0f}, "ball", {-radius, 0.0f, 0.0f}));
  Seat seat;
  seat.name = "wind";
  seat.controls.push_back(force_control(0, "ball", {20000.0f, 0.0f, 0.0f}));
  seat.controls.push_back(impulse_control(0, "link-0", {0.0f, 20.0f, 0.0f}));
  seat.script.push_back({200, 0, 240, 60, {1.0f, 0.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({320, 0, 240, 60, {-1.0f, 0.0f, 0.0f, 0.0f}, 1});
  scene.seats.push_back(seat);
  return scene;
}

Scene heavy_on_light() {
  Scene scene = planar_scene("heavy-on-light", "Boxes and discs under 10, 100 and 400 times more.");
  scene.bodies.push_back(ground());
  const int ratios[] = {10, 100, 400};
  Seat seat;
  seat.name = "press";
  for (std::uint32_t i = 0; i < 3; ++i) {
    const float ratio = static_cast<float>(ratios[i]);
    const float x = 3.0f * static_cast<float>(i);
    const std::string name = std::to_string(ratios[i]);
    scene.bodies.push_back(body_at("", {x - 9.0f, 0.5f, 0.0f}, box_shape(0.5f, 0.5f)));
    SceneBody box = body_at("box-" + name, {x - 9.0f, 1.5f, 0.0f}, box_shape(0.5f, 0.5f));
    box.shapes[0].density = ratio;
    scene.bodies.push_back(box);
    scene.bodies.push_back(body_at("", {x + 3.0f, 0.5f, 0.0f}, ball_shape(0.5f)));
    SceneBody disc = body_at("disc-" + name, {x + 3.0f, 1.5f, 0.0f}, ball_shape(0.5f));
    disc.shapes[0].density = ratio;
    scene.bodies.push_back(disc);
    seat.controls.push_back(force_control(i, box.name, {0.0f, -5.0f * ratio, 0.0f}));
    seat.controls.push_back(impulse_control(i, disc.name, {0.0f, -0.5f * ratio, 0.0f}));
  }
  seat.script.push_back({200, 0, 200, 40, {1.0f, 1.0f, 1.0f, 0.0f}, 7});
  scene.seats.push_back(seat);
  return scene;
}

/// Six boxes under one of fifty times their density.
static void add_loaded_stack(Scene& scene) {
  for (int i = 0; i < 7; ++i) {
    const Triple at = {0.0f, 0.25f + 0.5f * static_cast<float>(i), 0.0f};
    scene.bodies.push_back(body_at(i < 6 ? "" : "load", at, box_shape(0.25f, 0.25f)));
  }
  scene.bodies.back().shapes[0].density = 50.0f;
}

/// Five links that hang from the frame, and a weight of twenty times their density.
static void add_hanging_weight(Scene& scene) {
  std::string before = "frame";
  Triple pivot = {4.0f, 6.0f, 0.0f};
  for (int i = 0; i < 5; ++i) {
    const std::string name = "link-" + std::to_string(i);
    const Triple at = {4.0f, 5.75f - 0.5f * static_cast<float>(i), 0.0f};
    scene.bodies.push_back(
        body_at(name, at, capsule_shape({0.0f, -0.2f, 0.0f}, {0.0f, 0.2f, 0.0f}, 0.05f)));
    scene.joints.push_back(
        joint_between(JointKind::kRevolute, before, pivot, name, {0.0f, 0.25f, 0.0f}));
    before = name;
    pivot = {0.0f, -0.25f, 0.0f};
  }
  SceneBody weight = body_at("weight", {4.0f, 3.0f, 0.0f}, ball_shape(0.5f));
  weight.shapes[0].density = 20.0f;
  scene.bodies.push_back(weight);
  scene.joints.push_back(
      joint_between(JointKind::kRevolute, before, pivot, "weight", {0.0f, 0.5f, 0.0f}));
}

// States how wrong it may be, and no method: the one that this takes lies in the catalogue's file,
// where `cycloid tune --write` has stored it.
Scene within_a_millimetre() {
  Scene scene = planar_scene(
      "within-a-millimetre",
      "A loaded stack and a weight on a chain, which state how wrong they may be and no method.");
  scene.accuracy.error_m = 1.0e-3f;
  scene.bodies.push_back(ground());
  scene.bodies.push_back(frame());
  add_loaded_stack(scene);
  add_hanging_weight(scene);
  Seat seat;
  seat.name = "pusher";
  seat.controls.push_back(force_control(0, "weight", {40.0f, 0.0f, 0.0f}));
  seat.controls.push_back(force_control(1, "load", {0.0f, -100.0f, 0.0f}));
  seat.script.push_back({60, 0, 240, 30, {1.0f, 1.0f, 0.0f, 0.0f}, 0});
  scene.seats.push_back(seat);
  return scene;
}

// Source of the measures: Catto's Solver2D (2024), Overlap Recovery: neighbours share a quarter of
// their width, and are to part gently instead of being shot out.
Scene overlap(int base) {
  Scene scene = planar_scene("overlap", "A pyramid whose boxes overlap by a quarter at the start.");
  if (base != 4) scene.name += "-" + std::to_string(base);
  scene.bodies.push_back(ground());
  const float step = 0.75f;
  for (int row = 0; row < base; ++row)
    for (int i = 0; i < base - row; ++i) {
      const float x = step * (static_cast<float>(i) - 0.5f * static_cast<float>(base - row - 1));
      const float y = 0.5f + step * static_cast<float>(row);
      scene.bodies.push_back(body_at("", {x, y, 0.0f}, box_shape(0.5f, 0.5f)));
    }
  add_thrower(scene, {-0.5f * static_cast<float>(base) - 8.0f, 3.0f, 0.0f}, {8.0f, 3.0f, 0.0f});
  scene.seats[0].script[0].from = 360;
  return scene;
}

static Scene method_scene(const std::string& method, const Tuning& tuning) {
  Scene scene = planar_scene("method-", "");
  scene.name += method;
  scene.summary = "A stack, a pyramid and a chain under " + method + "; a seat throws balls.";
  scene.tuning = tuning;
  scene.bodies.push_back(ground());
  scene.bodies.push_back(frame());
  for (int i = 0; i < 5; ++i)
    scene.bodies.push_back(
        body_at("", {-5.0f, 0.5f + static_cast<float>(i), 0.0f}, box_shape(0.5f, 0.5f)));
  for (int row = 0; row < 4; ++row)
    for (int i = 0; i < 4 - row; ++i) {
      const float x = 1.05f * (static_cast<float>(i) - 0.5f * static_cast<float>(3 - row));
      const float y = 0.5f + static_cast<float>(row);
      scene.bodies.push_back(body_at("", {x, y, 0.0f}, box_shape(0.5f, 0.5f)));
    }
  add_chain(scene, {4.0f, 9.0f, 0.0f}, 6, 1.0f);
  add_thrower(scene, {-14.0f, 3.0f, 0.0f}, {10.0f, 4.0f, 0.0f});
  scene.seats[0].controls.push_back(impulse_control(1, "link-5", {0.5f, 0.5f, 0.0f}));
  scene.seats[0].script.push_back({200, 0, 200, 5, {}, 2});
  return scene;
}

std::vector<Scene> method_scenes() {
  Tuning coupled = Tuning::soft_step();
  coupled.contact_block = solver::ContactBlockRows::kNormalFriction;
  Tuning islands = Tuning::soft_step();
  islands.contact_block = solver::ContactBlockRows::kIsland;
  const std::pair<const char*, Tuning> methods[] = {
      {"pgs", Tuning::pgs()},
      {"split-impulse", Tuning::split_impulse()},
      {"ngs", Tuning::pgs_ngs()},
      {"ngs-block", Tuning::pgs_ngs_block()},
      {"pgs-soft", Tuning::pgs_soft()},
      {"tgs-ngs", Tuning::tgs_ngs()},
      {"xpbd", Tuning::xpbd().in_substeps(16)},
      {"coupled", coupled},
      {"islands", islands},
  };
  std::vector<Scene> scenes;
  for (const auto& [name, tuning] : methods) scenes.push_back(method_scene(name, tuning));
  // In space for this one alone: the others' rows there are those of scenes of their own.
  scenes.push_back(arch_3d(9));
  scenes.back().name = "method-islands-3d";
  scenes.back().summary = "An arch of nine stones under islands; a seat throws balls.";
  scenes.back().tuning = islands;
  return scenes;
}

}  // namespace cycloid::scenes
