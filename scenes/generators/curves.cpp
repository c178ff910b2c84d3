#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

using solver::CurveKind;
using solver::JointKind;

static SceneJoint wire(CurveKind curve, const Triple& centre, float first, float second,
                       const std::string& bead) {
  SceneJoint joint = joint_between(JointKind::kCurve, "frame", centre, bead, {});
  joint.curve = curve;
  joint.size = {first, second};
  return joint;
}

/// A body without rotation; beads pass through each other.
static void add_bead(Scene& scene, const std::string& name, const Triple& position) {
  SceneBody bead = body_at(name, position, ball_shape(0.15f));
  bead.kind = solver::BodyKind::kParticle;
  bead.mass = 1.0f;
  bead.shapes[0].filter.group = -1;
  scene.bodies.push_back(bead);
}

/// From every height a bead takes the same time to the bottom: the period is 4 pi sqrt(R / g).
static void add_tautochrone(Scene& scene, const Triple& centre) {
  const float radius = 1.25f;
  const float starts[] = {2.8f, 1.8f, 0.9f};  // t of the curve, rad.
  for (int i = 0; i < 3; ++i) {
    const std::string name = "cycloid-" + std::to_string(i);
    const float t = starts[i];
    float sine = 0.0f;
    float cosine = 0.0f;
    solver::sin_cos(t, sine, cosine);
    add_bead(scene, name,
             {centre[0] - radius * (t + sine), centre[1] - radius * (1.0f + cosine), 0.0f});
    scene.joints.push_back(wire(CurveKind::kCycloid, centre, radius, 0.0f, name));
  }
}

/// A bead on the outline of a body, and a ball in a drum: between two offsets of a circle.
static void add_outline_and_drum(Scene& scene) {
  SceneBody track;
  track.name = "track";
  track.kind = solver::BodyKind::kStatic;
  track.position = {9.0f, 4.0f, 0.0f};
  std::vector<Triple> points;
  for (int i = 0; i < 24; ++i) {
    float sine = 0.0f;
    float cosine = 0.0f;
    solver::sin_cos(2.0f * solver::kPi * static_cast<float>(i) / 24.0f, sine, cosine);
    const float reach = i % 6 < 3 ? 2.0f : 1.7f;
    points.push_back({reach * cosine, reach * sine, 0.0f});
  }
  track.shapes.push_back(chain_shape(points, true));
  scene.bodies.push_back(track);
  add_bead(scene, "outline", {9.0f, 4.0f + points[6][1], 0.0f});
  scene.joints.push_back(joint_between(JointKind::kCurve, "track", {}, "outline", {}));
  scene.joints.back().curve = CurveKind::kPolyline;

  SceneBody ball = body_at("drum", {14.5f, 4.0f, 0.0f}, ball_shape(0.3f));
  scene.bodies.push_back(ball);
  SceneJoint drum = wire(CurveKind::kCircle, {14.0f, 4.0f, 0.0f}, 2.0f, 0.0f, "drum");
  drum.limit_enabled = true;
  drum.lower = 0.3f;
  drum.upper = 2.0f;
  scene.joints.push_back(drum);
}

Scene beads() {
  Scene scene =
      planar_scene("beads", "Beads on a circle, an ellipse, a cycloid and an outline; a drum.");
  scene.bodies.push_back(frame());
  add_bead(scene, "circle", {-10.0f, 4.0f, 0.0f});
  scene.joints.push_back(wire(CurveKind::kCircle, {-12.0f, 4.0f, 0.0f}, 2.0f, 0.0f, "circle"));
  add_bead(scene, "ellipse", {-6.0f, 5.5f, 0.0f});
  scene.bodies.back().velocity = {1.0f, 0.0f, 0.0f};
  scene.joints.push_back(wire(CurveKind::kEllipse, {-6.0f, 4.0f, 0.0f}, 3.0f, 1.5f, "ellipse"));
  add_tautochrone(scene, {2.0f, 5.0f, 0.0f});
  add_outline_and_drum(scene);
  Seat seat;
  seat.name = "finger";
  seat.controls.push_back(impulse_control(0, "circle", {2.0f, 0.0f, 0.0f}));
  seat.controls.push_back(impulse_control(1, "ellipse", {-2.0f, 0.0f, 0.0f}));
  seat.controls.push_back(impulse_control(2, "outline", {2.0f, 0.0f, 0.0f}));
  seat.controls.push_back(force_control(0, "drum", {3.0f, 0.0f, 0.0f}));
  seat.script.push_back({30, 0, 120, 60, {1.0f, 0.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({90, 0, 120, 60, {-1.0f, 0.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({200, 0, 200, 5, {}, 7});
  scene.seats.push_back(seat);
  return scene;
}

/// A ramp of 8 m that falls to the right by 0.3 rad, with `body` at its upper end.
static void add_ramp(Scene& scene, float x, float y, SceneBody body, const char* material) {
  const float angle = -0.3f;
  SceneBody ramp = body_at("", {x, y, 0.0f}, box_shape(4.0f, 0.1f));
  ramp.kind = solver::BodyKind::kStatic;
  ramp.angle = angle;
  ramp.shapes[0].material = "ramp";
  scene.bodies.push_back(ramp);
  float sine = 0.0f;
  float cosine = 0.0f;
  solver::sin_cos(angle, sine, cosine);
  const float along = -3.2f;
  const float above = 0.1f + 0.4f;
  body.position = {x + along * cosine - above * sine, y + along * sine + above * cosine, 0.0f};
  body.angle = angle;
  body.shapes[0].material = material;
  scene.bodies.push_back(body);
}

static void add_walls(SceneBody& body, float half_width) {
  for (const float side : {-1.0f, 1.0f}) {
    SceneShape& shape = body.shapes.emplace_back();
    shape.kind = solver::ShapeKind::kHalfSpace;
    shape.normal = {side, 0.0f, 0.0f};
    shape.offset = -half_width;
  }
}

Scene rolling() {
  Scene scene = planar_scene("rolling", "What rolls, slides and stays on ramps of 0.3 rad.");
  scene.materials[0].name = "ramp";
  scene.materials[0].friction = 1.0f;
  scene.materials.push_back({"rubber", 1.0f, 0.0f, 0.0f});
  scene.materials.push_back({"sand", 1.0f, 0.0f, 0.15f});
  scene.materials.push_back({"mud", 1.0f, 0.0f, 0.5f});
  scene.materials.push_back({"ice", 0.0f, 0.0f, 0.0f});
  scene.materials.push_back({"wood", 0.04f, 0.0f, 0.0f});  // Against the ramp 0.2.
  scene.bodies.push_back(ground());
  add_walls(scene.bodies[0], 22.0f);
  const SceneBody ball = body_at("", {}, ball_shape(0.4f));
  SceneBody named = ball;
  named.name = "roller";
  SceneBody box = body_at("", {}, box_shape(0.4f, 0.4f));
  SceneBody slider = box;
  slider.name = "slider";
  SceneBody upright = box;
  upright.name = "upright";
  upright.fixed_rotation = true;
  SceneBody particle = ball;
  particle.kind = solver::BodyKind::kParticle;
  particle.mass = 1.0f;
  // From the top row nothing falls, so that what comes down meets nothing.
  add_ramp(scene, -15.0f, 8.0f, ball, "mud");
  add_ramp(scene, -2.0f, 8.0f, box, "rubber");
  add_ramp(scene, 11.0f, 8.0f, particle, "rubber");
  add_ramp(scene, -15.0f, 5.0f, ball, "sand");
  add_ramp(scene, -2.0f, 5.0f, slider, "wood");
  add_ramp(scene, 11.0f, 5.0f, upright, "wood");
  add_ramp(scene, -15.0f, 2.0f, named, "rubber");
  add_ramp(scene, -2.0f, 2.0f, ball, "ice");
  add_ramp(scene, 11.0f, 2.0f, particle, "wood");
  Seat seat;
  seat.name = "pusher";
  seat.controls.push_back(force_control(0, "roller", {2.0f, 0.0f, 0.0f}));
  Control turn = force_control(1, "roller", {0.3f, 0.0f, 0.0f});
  turn.effect = Effect::kTorque;
  seat.controls.push_back(turn);
  seat.controls.push_back(impulse_control(0, "upright", {-1.0f, 1.0f, 0.0f}));
  seat.controls.push_back(impulse_control(1, "slider", {0.0f, 1.0f, 0.0f}));
  seat.script.push_back({150, 0, 200, 60, {-1.0f, 1.0f, 0.0f, 0.0f}, 3});
  scene.seats.push_back(seat);
  return scene;
}

/// Four boxes around [left, right] x [bottom, top].
static SceneBody closed_box(float left, float right, float bottom, float top) {
  SceneBody body;
  body.name = "box";
  body.kind = solver::BodyKind::kStatic;
  const float thick = 0.5f;
  const float x = 0.5f * (left + right);
  const float y = 0.5f * (bottom + top);
  const float half_x = 0.5f * (right - left) + 2.0f * thick;
  const float half_y = 0.5f * (top - bottom);
  const auto add = [&](float centre_x, float centre_y, float reach_x, float reach_y) {
    SceneShape shape = box_shape(reach_x, reach_y);
    for (Triple& point : shape.points) point = {point[0] + centre_x, point[1] + centre_y, 0.0f};
    body.shapes.push_back(shape);
  };
  add(x, bottom - thick, half_x, thick);
  add(x, top + thick, half_x, thick);
  add(left - thick, y, thick, half_y);
  add(right + thick, y, thick, half_y);
  return body;
}

Scene bouncing(int discs) {
  Scene scene = planar_scene("bouncing", "Elastic balls from five heights, and a gas of discs.");
  if (discs != 20) scene.name += "-" + std::to_string(discs);
  scene.materials[0] = {"elastic", 0.0f, 1.0f};
  scene.tuning.restitution_threshold = 0.05f;
  scene.bodies.push_back(ground());
  for (int i = 0; i < 5; ++i) {
    const float place = static_cast<float>(i);
    scene.bodies.push_back(body_at("ball-" + std::to_string(i),
                                   {2.0f * place - 12.0f, 1.4f + place, 0.0f}, ball_shape(0.4f)));
  }
  scene.bodies.push_back(closed_box(0.0f, 10.0f, 1.0f, 11.0f));
  Random random{31};
  for (int i = 0; i < discs; ++i) {
    SceneBody disc =
        body_at("disc-" + std::to_string(i),
                {0.5f + static_cast<float>(i % 10), 1.5f + static_cast<float>(i / 10), 0.0f},
                ball_shape(0.3f));
    disc.velocity = {random.between(-4.0f, 4.0f), random.between(-4.0f, 4.0f), 0.0f};
    disc.gravity_scale = 0.0f;
    scene.bodies.push_back(disc);
  }
  Seat seat;
  seat.name = "cue";
  seat.controls.push_back(impulse_control(0, "disc-0", {1.0f, 0.5f, 0.0f}));
  seat.controls.push_back(force_control(0, "ball-4", {1.0f, 0.0f, 0.0f}));
  seat.script.push_back({300, 0, 300, 10, {1.0f, 0.0f, 0.0f, 0.0f}, 1});
  scene.seats.push_back(seat);
  return scene;
}

}  // namespace cycloid::scenes
