#include <algorithm>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

using namespace solver;

static const char* const kTalkOf2009 = "Catto 2009, motors";

/// A wheel of `inertia` (kg m^2) on a fixed axle, without gravity.
struct Wheel {
  World<2> world;
  BodyId wheel;
  JointId axle;

  Wheel(double inertia, const JointDef<2>& motor, double tick_s, const Tuning& tuning)
      : world(make_world(tuning, {0.0f}, 0.0, tick_s)) {
    JointDef<2> joint = motor;
    joint.kind = JointKind::kRevolute;
    joint.body_a = add_point(world, 0.0, 0.0);
    // A disc of radius 1 m has m / 2.
    joint.body_b = wheel = add(world, ball(1.0), 0.0, 0.0, 2.0 * inertia);
    axle = require(world.create_joint(joint));
  }
  double speed() const { return static_cast<double>(view(world, wheel).spin[0]); }
  double angle() const { return static_cast<double>(require(world.joint_angle(axle))); }
  const Joint<2>& joint() const { return world.state().joints[0]; }
};

static JointDef<2> speed_motor(double speed, double torque) {
  JointDef<2> joint;
  joint.motor = MotorKind::kSpeed;
  joint.motor_speed = static_cast<float>(speed);
  joint.motor_max = static_cast<float>(torque);
  return joint;
}

/// A position motor that follows amplitude sin(t).
static JointDef<2> sine_motor(double amplitude, double torque) {
  JointDef<2> joint;
  joint.motor = MotorKind::kPosition;
  joint.drive_amplitude = static_cast<float>(amplitude);
  joint.drive_hertz = static_cast<float>(0.5 / kPi);
  joint.motor_max = static_cast<float>(torque);
  return joint;
}

static void check_speed_motor(Report& report) {
  for (const double tick_s : {1.0 / 60.0, 1.0 / 120.0}) {
    Wheel wheel(1.0, speed_motor(2.0, 5.0), tick_s, Tuning::soft_step());
    const int ticks = static_cast<int>(0.4 / tick_s + 0.5);
    const std::string at = ", " + std::to_string(static_cast<int>(1.0 / tick_s + 0.5)) + " Hz";
    step(wheel.world, ticks - 1);
    report.expect("speed a tick before 0.4 s, 5 N m on 1 kg m^2, rad/s" + at, kTalkOf2009,
                  5.0 * (0.4 - tick_s), wheel.speed(), 1.0e-5);
    step(wheel.world);
    report.expect("speed at 0.4 s, rad/s" + at, kTalkOf2009, 2.0, wheel.speed(), 1.0e-5);
    step(wheel.world, ticks);
    report.expect("speed at 0.8 s, rad/s" + at, kTalkOf2009, 2.0, wheel.speed(), 1.0e-5);
    report.expect("torque once the speed is reached, N m" + at, kTalkOf2009, 0.0,
                  static_cast<double>(wheel.joint().motor_impulse) * 4.0 / tick_s, 1.0e-3);
  }
}

/// A saturated motor does not feel the step: impulses are limited to h times the torque.
static void check_halving(Report& report) {
  const auto run = [](double tick_s, const Tuning& tuning) {
    Wheel wheel(1.0, speed_motor(100.0, 5.0), tick_s, tuning);
    step(wheel.world, static_cast<int>(0.5 / tick_s + 0.5));
    return std::pair{wheel.speed(), wheel.angle()};
  };
  Tuning once = Tuning::soft_step();
  once.substeps = 1;
  for (const double hertz : {60.0, 120.0, 240.0, 480.0}) {
    const auto [speed, angle] = run(1.0 / hertz, once);
    const std::string at = " at " + std::to_string(static_cast<int>(hertz)) + " Hz";
    report.expect("speed of a saturated motor after 0.5 s, rad/s" + at, "torque t / I", 2.5, speed,
                  2.0e-5);
    report.expect("its angle, rad" + at, "torque t (t + h) / 2 I, symplectic Euler",
                  2.5 * 0.5 * (0.5 + 1.0 / hertz), angle, 2.0e-5);
  }
  for (const std::uint32_t substeps : {1u, 2u, 8u})
    report.expect("its speed in " + std::to_string(substeps) + " substeps, rad/s", "torque t / I",
                  2.5, run(kTick, Tuning::soft_step().in_substeps(substeps)).first, 2.0e-5);
}

/// Largest torque and largest error of a wheel that follows sin t for 2 pi s.
struct Following {
  double torque = 0.0;
  double error = 0.0;
  Curve angle{"wheel", {}};
  Curve target{"sin t", {}};
};

static Following follow(double inertia, double torque, double tick_s) {
  Wheel wheel(inertia, sine_motor(1.0, torque), tick_s, Tuning::soft_step());
  Following result;
  for (int tick = 1; tick * tick_s < 2.0 * kPi; ++tick) {
    step(wheel.world);
    const double t = tick * tick_s;
    result.torque = std::max(
        result.torque, std::abs(static_cast<double>(wheel.joint().motor_impulse)) * 4.0 / tick_s);
    // The first second is spent on catching up with the speed of the target.
    if (t > 1.0) result.error = std::max(result.error, std::abs(wheel.angle() - std::sin(t)));
    result.angle.points.emplace_back(t, wheel.angle());
    result.target.points.emplace_back(t, std::sin(t));
  }
  return result;
}

static void check_position_motor(Report& report) {
  const Following light = follow(1.0, 10.0, kTick);
  const Following finer = follow(1.0, 10.0, kTick / 4.0);
  report.expect("largest error of a wheel that follows sin t with 10 N m, rad", "O(h)", 0.0,
                light.error, 0.01);
  report.expect("the same at a quarter of the tick, rad", "O(h)", 0.0, finer.error, 0.0025);
  const Following heavy = follow(40.0, 10.0, kTick);
  report.expect("largest torque where 40 N m were needed, N m", "Catto 2009: |lambda| <= 10", 10.0,
                heavy.torque, 1.0e-4);
  report.expect("whether it then lags (1: yes)", "10 N m are too few", 1.0,
                heavy.error > 0.3 ? 1.0 : 0.0, 0.0);
  Curve lagging = heavy.angle;
  lagging.name = "40 kg m^2";
  Curve following = light.angle;
  following.name = "1 kg m^2";
  report.figures.push_back({"motor-follows-sine",
                            "Position motors with 10 N m",
                            "s",
                            "rad",
                            false,
                            false,
                            {light.target, following, lagging}});
}

/// A motor that pushes into a limit: the limit wins, and both know with how much.
static void check_limit(Report& report) {
  JointDef<2> joint = speed_motor(2.0, 5.0);
  joint.limit_enabled = true;
  joint.lower = -0.5f;
  joint.upper = 0.5f;
  Wheel wheel(1.0, joint, kTick, Tuning::soft_step());
  step(wheel.world, 300);
  const double rate = 4.0 / kTick;
  report.expect("angle of a motor against its limit, rad", "the limit wins", 0.5, wheel.angle(),
                0.005);
  report.expect("its speed, rad/s", "0", 0.0, wheel.speed(), 1.0e-5);
  report.expect("torque of the motor, N m", "at its bound", 5.0,
                static_cast<double>(wheel.joint().motor_impulse) * rate, 1.0e-4);
  report.expect("torque of the limit, N m", "that of the motor", 5.0,
                static_cast<double>(wheel.joint().upper_impulse) * rate, 1.0e-3);
  report.expect("torque of the other limit, N m", "0", 0.0,
                static_cast<double>(wheel.joint().lower_impulse) * rate, 0.0);
}

/// A motor of speed remembers no angle: what a push has turned stays turned.
static void check_memory(Report& report) {
  Wheel wheel(1.0, speed_motor(0.0, 5.0), kTick, Tuning::soft_step());
  require(wheel.world.apply_angular_impulse(wheel.wheel, {{1.0f}}));
  step(wheel.world, 120);
  report.expect("speed of a wheel braked with 5 N m, rad/s", "0", 0.0, wheel.speed(), 1.0e-6);
  // From 1 rad/s at 5 rad/s^2, each substep after its braking.
  report.expect("angle at which it stays, rad", "w^2 / 2 a - w h / 2, symplectic Euler",
                0.1 - 0.5 * kTick / 4.0, wheel.angle(), 1.0e-4);
}

Report motors() {
  Report report{"motors", {}, {}};
  check_speed_motor(report);
  check_position_motor(report);
  check_halving(report);
  check_limit(report);
  check_memory(report);
  return report;
}

}  // namespace cycloid::experiments
