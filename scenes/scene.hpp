#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/simulation.hpp"
#include "solver/definitions.hpp"

namespace cycloid::scenes {

/// A scene is data: what a world is made of, and what the seats can do to it. The same description
/// for both dimensions; in the plane the third number of a vector is 0. scene.fbs is its binary
/// form, JSON with the same names its human form.

using Triple = std::array<float, 3>;

struct SceneMaterial {
  std::string name;
  float friction = 0.6f;
  float restitution = 0.0f;
  float rolling_resistance = 0.0f;
};

struct SceneShape {
  solver::ShapeKind kind = solver::ShapeKind::kBall;
  std::vector<Triple> points;
  float radius = 0.0f;
  Triple normal{};
  float offset = 0.0f;
  bool loop = false;
  Triple half{};                                          ///< Box: half extents, m.
  std::array<float, 4> rotation{0, 0, 0, 1.0f};           ///< Box: quaternion x, y, z, w.
  std::vector<std::array<std::uint32_t, 3>> triangles{};  ///< Mesh: indices into points.
  std::vector<float> heights{};                           ///< Height field: row by row, m.
  std::uint32_t columns = 0;                              ///< Height field.
  std::array<float, 2> cell{};                            ///< Height field: m along x and z.
  float density = 1.0f;
  std::string material;  ///< "": the first of the scene.
  solver::Filter filter;
};

struct SceneBody {
  std::string name;  ///< Needed only where a joint or a control refers to it.
  solver::BodyKind kind = solver::BodyKind::kDynamic;
  Triple position{};
  float angle = 0.0f;                            ///< rad, in the plane.
  std::array<float, 4> rotation{0, 0, 0, 1.0f};  ///< Quaternion x, y, z, w, in space.
  Triple velocity{};
  Triple spin{};  ///< rad/s; in the plane the first number.
  float mass = 0.0f;
  float linear_damping = 0.0f;
  float angular_damping = 0.0f;
  float gravity_scale = 1.0f;
  bool fixed_rotation = false;
  std::uint64_t tag = 0;
  std::vector<SceneShape> shapes;
};

/// Fields as in solver::JointDef, which says what each kind makes of them.
struct SceneJoint {
  std::string name;
  solver::JointKind kind = solver::JointKind::kRevolute;
  std::string body_a;
  std::string body_b;
  Triple anchor_a{};
  Triple anchor_b{};
  Triple axis{};
  float length = 0.0f;
  float ratio = 1.0f;
  float hertz = 0.0f;
  float damping_ratio = 0.0f;
  float angular_hertz = 0.0f;
  float angular_damping_ratio = 0.0f;
  bool limit_enabled = false;
  float lower = 0.0f;
  float upper = 0.0f;
  solver::MotorKind motor = solver::MotorKind::kOff;
  float motor_speed = 0.0f;
  float motor_max = 0.0f;
  float target = 0.0f;
  float drive_amplitude = 0.0f;
  float drive_hertz = 0.0f;
  float force_max = 0.0f;
  float torque_max = 0.0f;
  Triple ground_a{};
  Triple ground_b{};
  solver::CurveKind curve = solver::CurveKind::kCircle;
  std::array<float, 2> size{};
  bool collide_connected = false;
};

/// A corner or any other point of a cloth that something holds.
struct ClothPin {
  std::uint32_t column = 0;
  std::uint32_t row = 0;
  std::string body;  ///< "": where it is in the world.
};

/// A grid of particles with links along both ways and across each cell; one row is a rope.
struct Cloth {
  std::string name;
  Triple origin{};  ///< Particle (0, 0), world, m.
  Triple across{};  ///< From a column to the next, m.
  Triple down{};    ///< From a row to the next, m.
  std::uint32_t columns = 1;
  std::uint32_t rows = 1;
  float mass = 0.01f;  ///< Of each particle, kg.
  float radius = 0.01f;
  float compliance = 0.0f;        ///< Of links along columns and rows, m/N.
  float shear_compliance = 0.0f;  ///< Of links across a cell, m/N; below 0: there are none.
  std::string material;
  solver::Filter filter;
  std::vector<ClothPin> pins;
};

enum class Source : std::uint32_t { kUnknown = 0, kAxis, kButton };
enum class Effect : std::uint32_t { kUnknown = 0, kForce, kTorque, kMotorSpeed, kImpulse, kSpawn };
enum class Frame : std::uint32_t { kUnknown = 0, kWorld, kBody };

/// What one axis or button of a seat does. An axis of 32767 counts as 1, a held button as 1.
///
///   force        value [N] times the axis, while held; on `target`'s centre of mass.
///   torque       value[0] [N m] in the plane, value in space, times the axis.
///   motor_speed  value[0] [rad/s] times the axis becomes the speed of joint `target`.
///   impulse      value [N s], once when the button goes down. Buttons only.
///   spawn        a body of prefab `target` at `position` with `velocity`, once when the button
///                goes down; at most `limit` alive: the oldest makes room. Buttons only.
struct Control {
  Source source = Source::kAxis;
  std::uint32_t index = 0;  ///< Axis 0 to 3, button 0 to 15.
  Effect effect = Effect::kForce;
  std::string target;  ///< Name of a body, joint or prefab.
  Triple value{};
  Frame frame = Frame::kWorld;  ///< Of `value`, for force and impulse.
  Triple position{};            ///< m, world.
  Triple velocity{};            ///< m/s.
  std::uint32_t limit = 16;     ///< 1 to 256.
};

/// What a seat's script says from tick `from` to before tick `until` (0: for ever): all of the
/// time, or the first `hold` of every `every` ticks.
struct ScriptEntry {
  std::uint32_t from = 1;
  std::uint32_t until = 0;
  std::uint32_t every = 0;
  std::uint32_t hold = 1;
  std::array<float, kAxes> axes{};  ///< -1 to 1.
  std::uint32_t buttons = 0;        ///< Bit b is button b.
};

struct Seat {
  std::string name;
  std::vector<Control> controls;
  std::vector<ScriptEntry> script;  ///< Of two entries that speak at once the later one is heard.
};

struct Scene {
  std::string name;
  std::string summary;
  std::uint32_t dimension = 2;
  Triple gravity{};
  float tick_hz = 60.0f;
  solver::Tuning tuning;
  solver::Limits limits;
  std::vector<SceneMaterial> materials;
  std::vector<SceneBody> bodies;
  std::vector<SceneJoint> joints;
  std::vector<Cloth> cloths;
  std::vector<SceneBody> prefabs;
  std::vector<Seat> seats;
};

}  // namespace cycloid::scenes
