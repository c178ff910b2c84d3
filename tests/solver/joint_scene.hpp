#pragma once

#include <array>
#include <vector>

#include "solver/constraints/rows.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

inline constexpr float kPi2 = 6.28318530718f;

/// A named setting, with sleeping off.
struct Method {
  const char* name;
  Tuning tuning;
};

inline std::vector<Method> methods() {
  std::vector<Method> all = {{"soft_step", Tuning::soft_step()},
                             {"pgs", Tuning::pgs()},
                             {"pgs_ngs", Tuning::pgs_ngs()},
                             {"xpbd", Tuning::xpbd()}};
  for (Method& method : all) method.tuning.sleep_s = 0.0f;
  return all;
}

/// A world with one static body at the origin, `anchor`, and no shapes on it.
template <int D>
struct Scene {
  explicit Scene(const Tuning& tuning, bool gravity = true) : world(make_world(def(tuning))) {
    const Vec<D> none = Vec<D>::zero();
    EXPECT_TRUE(world.set_gravity(gravity ? -10.0f * up<D>() : none).ok());
    BodyDef<D> fixed;
    fixed.kind = BodyKind::kStatic;
    anchor = world.create_body(fixed, {}).value();
  }
  static WorldDef<D> def(const Tuning& tuning) {
    WorldDef<D> def = with_gravity<D>();
    def.tuning = tuning;
    return def;
  }
  BodyId add_ball(Vec<D> position, float mass, float radius = 0.25f) {
    BodyDef<D> body;
    body.position = position;
    body.mass = mass;
    return add(world, body, ball<D>(radius));
  }
  JointDef<D> joint(JointKind kind, BodyId a, BodyId b) {
    JointDef<D> def;
    def.kind = kind;
    def.body_a = a;
    def.body_b = b;
    def.length = 1.0f;
    return def;
  }
  JointId create(const JointDef<D>& def) {
    const Result<JointId> id = world.create_joint(def);
    EXPECT_TRUE(id.ok()) << id.error().field;
    return id.ok() ? id.value() : JointId{};
  }
  const Joint<D>& state_of(JointId id) const { return world.state().joints[id.index]; }
  JointRows<D> rows(JointId id) const {
    const Joint<D>& joint = state_of(id);
    const Body<D>& a = world.state().bodies[joint.body_a];
    const Body<D>& b = world.state().bodies[joint.body_b];
    JointRows<D> rows;
    rows_of(make_frame(world.state(), joint, a.position, b.position - a.position, a.rotation,
                       b.rotation, 0.0f),
            rows);
    return rows;
  }
  /// The largest error of an equality, m or rad.
  float error(JointId id) const {
    const JointRows<D> of = rows(id);
    float worst = 0.0f;
    for (int i = 0; i < of.count; ++i)
      worst = std::max(worst, std::abs(of.rows[static_cast<std::size_t>(i)].error));
    return worst;
  }
  World<D> world;
  BodyId anchor;
};

/// Steps with a constant force on one body.
template <int D>
void push(World<D>& world, BodyId id, Vec<D> force, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    ASSERT_TRUE(world.apply_force(id, force).ok());
    step(world, 1);
  }
}
template <int D>
void twist(World<D>& world, BodyId id, float torque, int ticks) {
  Spin<D> about_z = Spin<D>::zero();
  about_z[Dim<D>::kSpin - 1] = torque;
  for (int i = 0; i < ticks; ++i) {
    ASSERT_TRUE(world.apply_torque(id, about_z).ok());
    step(world, 1);
  }
}
/// Moment of inertia of the ball of add_ball.
template <int D>
float ball_inertia(float mass, float radius) {
  return (D == 2 ? 0.5f : 0.4f) * mass * radius * radius;
}

/// Momentum, and angular momentum about the origin along the last axis of spin.
template <int D>
std::array<double, 3> momenta(const World<D>& world, float radius) {
  std::array<double, 3> sum{};
  for (const BodyView<D>& body : world.bodies()) {
    const double m = body.mass;
    sum[0] += m * body.velocity[0];
    sum[1] += m * body.velocity[1];
    sum[2] += m * (body.position[0] * body.velocity[1] - body.position[1] * body.velocity[0]) +
              ball_inertia<D>(body.mass, radius) * body.spin[Dim<D>::kSpin - 1];
  }
  return sum;
}

}  // namespace cycloid::solver
