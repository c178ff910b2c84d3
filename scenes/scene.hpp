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
  float twist_resistance = 0.0f;
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
  Triple axle{};
  float steering = 0.0f;
  float cone = 0.0f;
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

/// A ball or a capsule that a seat walks and jumps: solver::move with a will. It does not turn, is
/// no body, meets no other character, and pushes dynamic bodies. What it carries from tick to tick
/// lies in the world's registers.
struct SceneCharacter {
  std::string name;                   ///< Needed only where a control refers to it.
  Triple position{};                  ///< At tick 0, world, m.
  Triple lower{0.0f, 0.3f, 0.0f};     ///< End of the capsule's segment, from the position, m.
  Triple upper{0.0f, 1.5f, 0.0f};     ///< The other; equal to `lower`: a ball.
  float radius = 0.3f;                ///< m.
  float skin = 0.01f;                 ///< m of distance kept; at most half of the radius.
  Triple up{0.0f, 1.0f, 0.0f};        ///< Unit.
  float slope_cos_min = 0.70710678f;  ///< Walkable where dot(normal, up) is at least this.
  float step_height = 0.35f;          ///< m, climbed and followed downwards at most.
  float push_mass = 80.0f;            ///< kg with which dynamic bodies are pushed.
  float push_force_max = 1000.0f;     ///< N, per contact.
  float gravity_scale = 1.0f;
  float speed = 4.0f;              ///< m/s, of a walk at full axis.
  float acceleration = 40.0f;      ///< m/s^2 towards the wanted velocity, on the ground.
  float air_acceleration = 10.0f;  ///< m/s^2, off it.
  float jump_speed = 5.0f;         ///< m/s along `up`.
  solver::Filter filter;
};

enum class Source : std::uint32_t { kUnknown = 0, kAxis, kButton };
enum class Effect : std::uint32_t {
  kUnknown = 0,
  kForce,
  kTorque,
  kMotorSpeed,
  kImpulse,
  kSpawn,
  kWalk,
  kJump,
  kSteering
};
enum class Frame : std::uint32_t { kUnknown = 0, kWorld, kBody };

/// What one axis or button of a seat does. An axis of 32767 counts as 1, a held button as 1.
///
///   force        value [N] times the axis, while held; on `target`'s centre of mass.
///   torque       value[0] [N m] in the plane, value in space, times the axis.
///   motor_speed  value[0] [rad/s] times the axis becomes the speed of joint `target`.
///   steering     value[0] [rad] times the axis becomes the steering of wheel `target`. Space.
///   impulse      value [N s], once when the button goes down. Buttons only.
///   spawn        a body of prefab `target` at `position` with `velocity`, once when the button
///                goes down; at most `limit` alive: the oldest makes room. Buttons only.
///   walk         value times the axis is added to where character `target` wants to go, of which
///                the part across its `up` counts; a length of 1 or more is its full speed.
///   jump         character `target` leaves the ground it stands on, once when the button goes
///                down. Buttons only.
struct Control {
  Source source = Source::kAxis;
  std::uint32_t index = 0;  ///< Axis 0 to 3, button 0 to 15.
  Effect effect = Effect::kForce;
  std::string target;  ///< Name of a body, joint, prefab or character.
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

/// What `cycloid tune` has chosen for a scene that asks for an accuracy. Of `tuning` the fields of
/// a method count (is_of_method); the others are stated in the scene's own.
struct TunedChoice {
  std::uint32_t solver_version = 0;  ///< Whose measurements it rests on; 0: nothing is chosen.
  solver::Tuning tuning;
};

/// How wrong a scene may be, stated instead of a method. docs/tuning.md says what is measured. The
/// choice is made offline and stored, so that no match depends on a clock.
struct SceneAccuracy {
  float error_m = 0.0f;  ///< Of overlap and of gaps in joints, m; 0: not stated.
  float error_percent =
      0.0f;  ///< The same as a share of the size of a typical body; 0: not stated.
  TunedChoice tuned;
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
  std::vector<SceneCharacter> characters;
  std::vector<SceneBody> prefabs;
  std::vector<Seat> seats;
  SceneAccuracy accuracy;
};

}  // namespace cycloid::scenes
