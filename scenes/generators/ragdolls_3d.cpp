#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

using solver::JointKind;

/// One capsule of a body that stands upright and looks along x, its left side at negative z. Its
/// frame lies in the joint to its parent and is not turned.
struct SolidPart {
  const char* name;
  int parent;
  Triple joint;  ///< m, from the parent's frame.
  Triple end;    ///< m, of the capsule, which begins in the joint.
  float radius;  ///< m
  float cone;    ///< rad that it may swing; 0: a hinge about z, from `lower` to `upper`.
  float lower;   ///< rad, of the twist or the hinge.
  float upper;
  float friction;  ///< N m
};

static constexpr int kParts = 11;
static constexpr SolidPart kPerson[kParts] = {
    {"hips", -1, {}, {0.0f, 0.1f, 0.0f}, 0.13f, 0.0f, 0.0f, 0.0f, 0.0f},
    {"torso", 0, {0, 0.14f, 0}, {0.0f, 0.36f, 0.0f}, 0.14f, 0.4f, -0.4f, 0.4f, 4.0f},
    {"head", 1, {0, 0.55f, 0}, {0.0f, 0.14f, 0.0f}, 0.11f, 0.5f, -0.8f, 0.8f, 1.0f},
    {"left-upper-arm", 1, {0, 0.36f, -0.2f}, {0, -0.26f, 0}, 0.05f, 1.6f, -0.6f, 0.6f, 1.0f},
    {"left-lower-arm", 3, {0, -0.27f, 0}, {0, -0.24f, 0}, 0.045f, 0.0f, 0.0f, 2.4f, 0.5f},
    {"right-upper-arm", 1, {0, 0.36f, 0.2f}, {0, -0.26f, 0}, 0.05f, 1.6f, -0.6f, 0.6f, 1.0f},
    {"right-lower-arm", 5, {0, -0.27f, 0}, {0, -0.24f, 0}, 0.045f, 0.0f, 0.0f, 2.4f, 0.5f},
    {"left-upper-leg", 0, {0, -0.05f, -0.1f}, {0, -0.38f, 0}, 0.08f, 0.9f, -0.3f, 0.3f, 4.0f},
    {"left-lower-leg", 7, {0, -0.42f, 0}, {0, -0.4f, 0}, 0.06f, 0.0f, -2.3f, 0.0f, 2.0f},
    {"right-upper-leg", 0, {0, -0.05f, 0.1f}, {0, -0.38f, 0}, 0.08f, 0.9f, -0.3f, 0.3f, 4.0f},
    {"right-lower-leg", 9, {0, -0.42f, 0}, {0, -0.4f, 0}, 0.06f, 0.0f, -2.3f, 0.0f, 2.0f},
};

struct SolidPerson {
  std::string prefix;
  Triple hips;
  Triple velocity;
  float turn;          ///< rad about y.
  std::int32_t group;  ///< Negative: its parts do not collide with each other.
};

static SceneJoint joint_of(const SolidPerson& person, const SolidPart& part) {
  const bool hinge = part.cone == 0.0f;
  SceneJoint joint = joint_between(hinge ? JointKind::kHinge : JointKind::kConeTwist,
                                   person.prefix + kPerson[part.parent].name, part.joint,
                                   person.prefix + part.name, {});
  joint.name = joint.body_b;
  joint.axis = hinge ? Triple{0.0f, 0.0f, 1.0f} : Triple{0.0f, 1.0f, 0.0f};
  joint.limit_enabled = true;
  joint.lower = part.lower;
  joint.upper = part.upper;
  joint.cone = part.cone;
  if (hinge) {
    joint.motor = solver::MotorKind::kSpeed;
    joint.motor_max = part.friction;
  } else {
    joint.torque_max = part.friction;
  }
  return joint;
}

/// Eleven capsules on six cones and four hinges with limits and friction.
static void add_person(Scene& scene, const SolidPerson& person) {
  float sine = 0.0f;
  float cosine = 0.0f;
  solver::sin_cos(person.turn, sine, cosine);
  float half_sine = 0.0f;
  float half_cosine = 0.0f;
  solver::sin_cos(0.5f * person.turn, half_sine, half_cosine);
  Triple places[kParts];
  for (int i = 0; i < kParts; ++i) {
    const SolidPart& part = kPerson[i];
    places[i] = person.hips;
    if (part.parent >= 0) {
      const Triple& from = places[part.parent];
      places[i] = {from[0] + cosine * part.joint[0] + sine * part.joint[2], from[1] + part.joint[1],
                   from[2] - sine * part.joint[0] + cosine * part.joint[2]};
      scene.joints.push_back(joint_of(person, part));
    }
    SceneBody body =
        body_at(person.prefix + part.name, places[i], capsule_shape({}, part.end, part.radius));
    body.rotation = {0.0f, half_sine, 0.0f, half_cosine};
    body.velocity = person.velocity;
    body.shapes[0].density = 800.0f;
    body.shapes[0].filter.group = person.group;
    scene.bodies.push_back(body);
  }
}

Scene ragdolls_3d(int count) {
  Scene scene = spatial_scene("ragdolls-3d", "People of eleven capsules fall down broad steps.");
  if (count != 6) scene.name += "-" + std::to_string(count);
  scene.materials[0].friction = 0.5f;
  scene.bodies.push_back(ground());
  for (int i = 0; i < 6; ++i) {
    const float height = 0.5f * static_cast<float>(6 - i);
    SceneBody step = body_at("", {-5.0f + 1.2f * static_cast<float>(i), 0.5f * height, 0.0f},
                             solid_box({0.6f, 0.5f * height, 4.0f}));
    step.kind = solver::BodyKind::kStatic;
    scene.bodies.push_back(step);
  }
  for (int i = 0; i < count; ++i) {
    const auto place = static_cast<float>(i);
    const Triple hips = {-5.0f + 0.6f * static_cast<float>(i % 3), 4.2f + 2.0f * (place / 3.0f),
                         1.2f * static_cast<float>(i % 3) - 1.2f};
    add_person(scene,
               {"p" + std::to_string(i) + "-", hips, {1.5f, 0.0f, 0.0f}, 0.9f * place, -1 - i});
  }
  add_thrower(scene, {-12.0f, 5.0f, 0.2f}, {9.0f, 2.0f, 0.0f});
  scene.prefabs[0].shapes[0].density = 200.0f;
  Seat& seat = scene.seats[0];
  seat.controls.push_back(force_control(0, "p0-torso", {300.0f, 0.0f, 0.0f}));
  seat.controls.push_back(impulse_control(1, "p0-hips", {20.0f, 60.0f, 10.0f}));
  seat.script.push_back({180, 0, 240, 40, {1.0f, 0.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({300, 0, 240, 3, {}, 2});
  return scene;
}

}  // namespace cycloid::scenes
