#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

using solver::JointKind;
using solver::MotorKind;

/// One capsule of a body seen from the side, facing right. Its frame lies in the joint to its
/// parent; angles count from the parent, so that the limits are those of the anatomy.
struct Part {
  const char* name;
  int parent;
  float joint;     ///< m from the parent's frame along the parent.
  float length;    ///< m, negative: hangs down.
  float radius;    ///< m
  float angle;     ///< rad, of the pose at the start.
  float lower;     ///< rad
  float upper;     ///< rad
  float friction;  ///< N m
};

static constexpr int kParts = 11;
static constexpr Part kPerson[kParts] = {
    {"hips", -1, 0.0f, 0.1f, 0.12f, 0.0f, 0.0f, 0.0f, 0.0f},
    {"torso", 0, 0.12f, 0.4f, 0.13f, 0.0f, -0.8f, 0.3f, 3.0f},
    {"head", 1, 0.55f, 0.14f, 0.11f, 0.0f, -0.6f, 0.5f, 1.0f},
    {"left-upper-arm", 1, 0.38f, -0.26f, 0.05f, 0.4f, -0.9f, 2.8f, 1.0f},
    {"left-lower-arm", 3, -0.26f, -0.24f, 0.045f, 0.3f, 0.0f, 2.4f, 0.5f},
    {"right-upper-arm", 1, 0.38f, -0.26f, 0.05f, -0.4f, -0.9f, 2.8f, 1.0f},
    {"right-lower-arm", 5, -0.26f, -0.24f, 0.045f, 0.3f, 0.0f, 2.4f, 0.5f},
    {"left-upper-leg", 0, 0.0f, -0.4f, 0.08f, 0.25f, -0.5f, 1.8f, 3.0f},
    {"left-lower-leg", 7, -0.4f, -0.4f, 0.06f, -0.2f, -2.3f, 0.0f, 2.0f},
    {"right-upper-leg", 0, 0.0f, -0.4f, 0.08f, -0.2f, -0.5f, 1.8f, 3.0f},
    {"right-lower-leg", 9, -0.4f, -0.4f, 0.06f, -0.1f, -2.3f, 0.0f, 2.0f},
};

struct Person {
  std::string prefix;
  Triple hips;
  Triple velocity;
  float angle;         ///< rad, of the hips.
  std::int32_t group;  ///< Negative: its parts do not collide with each other.
  bool upright;        ///< Starts with its limbs straight instead of in the pose.
};

static SceneJoint joint_of(const Person& person, const Part& part, float angle) {
  const std::string parent = person.prefix + kPerson[part.parent].name;
  SceneJoint joint = joint_between(JointKind::kRevolute, parent, {0.0f, part.joint, 0.0f},
                                   person.prefix + part.name, {});
  joint.name = joint.body_b;
  joint.limit_enabled = true;
  joint.lower = part.lower - angle;
  joint.upper = part.upper - angle;
  joint.motor = MotorKind::kSpeed;
  joint.motor_max = part.friction;
  return joint;
}

/// Eleven capsules on ten pins with limits and friction, about 60 kg. @returns its first joint.
static std::size_t add_person(Scene& scene, const Person& person) {
  const std::size_t first = scene.joints.size();
  Triple places[kParts];
  float angles[kParts];
  for (int i = 0; i < kParts; ++i) {
    const Part& part = kPerson[i];
    const float angle = person.upright ? 0.0f : part.angle;
    places[i] = person.hips;
    angles[i] = person.angle;
    if (part.parent >= 0) {
      const Triple& parent = places[part.parent];
      float sine = 0.0f;
      float cosine = 0.0f;
      solver::sin_cos(angles[part.parent], sine, cosine);
      places[i] = {parent[0] - part.joint * sine, parent[1] + part.joint * cosine, 0.0f};
      angles[i] = angles[part.parent] + angle;
      scene.joints.push_back(joint_of(person, part, angle));
    }
    SceneBody body = body_at(person.prefix + part.name, places[i],
                             capsule_shape({}, {0.0f, part.length, 0.0f}, part.radius));
    body.angle = angles[i];
    body.velocity = person.velocity;
    body.shapes[0].density = 120.0f;
    body.shapes[0].filter.group = person.group;
    scene.bodies.push_back(body);
  }
  return first;
}

static void add_steps(Scene& scene) {
  scene.bodies.push_back(ground());
  for (int i = 0; i < 6; ++i) {
    const float height = 0.5f * static_cast<float>(6 - i);
    SceneBody step = body_at("", {-5.0f + 1.2f * static_cast<float>(i), 0.5f * height, 0.0f},
                             box_shape(0.6f, 0.5f * height));
    step.kind = solver::BodyKind::kStatic;
    scene.bodies.push_back(step);
  }
}

Scene ragdolls(int count) {
  Scene scene = planar_scene("ragdolls", "People of eleven capsules fall down a flight of steps.");
  if (count != 6) scene.name += "-" + std::to_string(count);
  scene.materials[0].friction = 0.5f;
  add_steps(scene);
  for (int i = 0; i < count; ++i) {
    const float place = static_cast<float>(i);
    const Triple hips = {-5.0f + 0.9f * static_cast<float>(i % 6), 5.0f + 1.2f * place, 0.0f};
    add_person(
        scene,
        {"p" + std::to_string(i) + "-", hips, {1.5f, 0.0f, 0.0f}, 0.7f * place, -1 - i, false});
  }
  add_thrower(scene, {-12.0f, 5.0f, 0.0f}, {9.0f, 2.0f, 0.0f});
  scene.prefabs[0].shapes[0].density = 40.0f;
  Seat& seat = scene.seats[0];
  seat.controls.push_back(force_control(0, "p0-torso", {300.0f, 0.0f, 0.0f}));
  seat.controls.push_back(impulse_control(1, "p0-hips", {20.0f, 40.0f, 0.0f}));
  seat.script.push_back({180, 0, 240, 40, {1.0f, 0.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({300, 0, 240, 3, {}, 2});
  return scene;
}

/// Turns the friction of a joint into a servo: it holds `target` with at most `torque`.
static void hold(SceneJoint& joint, float target, float torque) {
  joint.motor = MotorKind::kPosition;
  joint.motor_max = torque;
  joint.target = target;
}

static void swing(SceneJoint& joint, float amplitude, float hertz) {
  joint.drive_amplitude = amplitude;
  joint.drive_hertz = hertz;
}

Scene ragdoll_motors() {
  Scene scene =
      planar_scene("ragdoll-motors", "A person on servos stands on one leg, kicks and waves.");
  scene.materials[0].friction = 0.9f;
  scene.bodies.push_back(ground());
  const std::size_t first = add_person(scene, {"", {0.0f, 0.86f, 0.0f}, {}, 0.0f, -1, true});
  const float torques[kParts - 1] = {200.0f, 40.0f,  40.0f,  20.0f,  40.0f,
                                     20.0f,  150.0f, 100.0f, 250.0f, 200.0f};
  for (std::size_t i = 0; i < 10; ++i) hold(scene.joints[first + i], 0.0f, torques[i]);
  // Left arm and leg swing, the right leg carries: its foot is long enough to balance on.
  scene.joints[first + 2].target = 1.2f;
  swing(scene.joints[first + 2], 0.6f, 0.8f);
  scene.joints[first + 3].target = 1.2f;
  scene.joints[first + 6].target = 0.5f;
  swing(scene.joints[first + 6], 0.5f, 0.5f);
  scene.joints[first + 7].target = -0.8f;
  swing(scene.joints[first + 7], 0.6f, 0.5f);
  SceneShape foot = capsule_shape({-0.2f, -0.42f, 0.0f}, {0.3f, -0.42f, 0.0f}, 0.04f);
  foot.density = 120.0f;
  foot.filter.group = -1;
  scene.bodies[11].shapes.push_back(foot);
  SceneBody ball = body_at("ball", {0.75f, 0.2f, 0.0f}, ball_shape(0.2f));
  ball.shapes[0].density = 4.0f;
  scene.bodies.push_back(ball);
  add_thrower(scene, {-6.0f, 1.5f, 0.0f}, {5.0f, 2.0f, 0.0f});
  scene.prefabs[0].shapes[0].radius = 0.2f;
  Seat& seat = scene.seats[0];
  seat.script[0].from = 330;
  seat.controls.push_back(force_control(0, "torso", {60.0f, 0.0f, 0.0f}));
  seat.script.push_back({120, 0, 120, 10, {0.5f, 0.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({180, 0, 120, 10, {-0.5f, 0.0f, 0.0f, 0.0f}, 0});
  return scene;
}

}  // namespace cycloid::scenes
