#include "bench/trials/course.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/peers/accuracy.hpp"
#include "bench/trials/methods.hpp"
#include "bench/trials/motions.hpp"
#include "scenes/build.hpp"
#include "solver/trig.hpp"

namespace cycloid::trials {

static constexpr std::uint32_t kTicksPerMeasure = 5;
static constexpr std::uint32_t kTicksOfEnd = 60;

static double angle_of(const solver::Rotation<2>& rotation) {
  return static_cast<double>(solver::atan2(rotation[1], rotation[0]));
}
static double angle_of(const solver::Rotation<3>&) {
  return 0.0;
}

template <int D>
static BodyAt body_at(const solver::BodyView<D>& view) {
  BodyAt body;
  for (std::size_t i = 0; i < D; ++i) {
    body.position[i] = static_cast<double>(view.position[static_cast<int>(i)]);
    body.velocity[i] = static_cast<double>(view.velocity[static_cast<int>(i)]);
  }
  for (int i = 0; i < solver::Dim<D>::kSpin; ++i)
    body.spin[static_cast<std::size_t>(i)] = static_cast<double>(view.spin[i]);
  body.angle = angle_of(view.rotation);
  body.mass = static_cast<double>(view.mass);
  return body;
}

template <int D>
static std::vector<BodyAt> bodies_of(const solver::World<D>& world) {
  std::vector<BodyAt> bodies;
  for (const solver::BodyView<D>& view : world.bodies()) bodies.push_back(body_at(view));
  return bodies;
}

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  double square = 0.0;
  for (std::size_t i = 0; i < 3; ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(square);
}

template <int D>
static void take_accuracy(const solver::WorldState<D>& state, bool late, Course& course) {
  const peers::Poses<D> poses = [&](std::uint32_t body) {
    return solver::Pose<D>{state.bodies[body].position, state.bodies[body].rotation};
  };
  const peers::Accuracy accuracy = peers::measure_accuracy<D>(state, poses);
  const auto overlap = static_cast<double>(accuracy.overlap_m);
  course.overlap_max_m = std::max(course.overlap_max_m, overlap);
  if (!late) return;
  course.overlap_end_m = std::max(course.overlap_end_m, overlap);
  course.gap_end_m = std::max(course.gap_end_m, static_cast<double>(accuracy.gap_m));
}

static void take_motions(const Motions& motions, bool late, Course& course) {
  course.energy_end_j = motions.energy_j;
  course.speed_max_m_s = std::max(course.speed_max_m_s, motions.speed_m_s);
  if (!late) return;
  course.speed_late_m_s = std::max(course.speed_late_m_s, motions.speed_m_s);
  course.highest_late_m = std::max(course.highest_late_m, motions.highest_m);
}

static void take_turn(const solver::BodyView<2>& first, const solver::BodyView<2>& last,
                      Course& course) {
  course.turn_max_rad = std::max(course.turn_max_rad, std::abs(angle_of(last.rotation)));
  course.turned_over = course.turned_over || first.spin[0] * last.spin[0] < 0.0f;
}
static void take_turn(const solver::BodyView<3>& first, const solver::BodyView<3>& last,
                      Course& course) {
  const solver::Vec<3> before = solver::rotate_back(first.rotation, first.spin);
  const solver::Vec<3> now = solver::rotate_back(last.rotation, last.spin);
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(before[i]) > std::abs(before[axis])) axis = i;
  course.turned_over = course.turned_over || before[axis] * now[axis] < 0.0f;
}

template <int D>
static Course run(const scenes::Scene& scene, std::uint32_t ticks, Act<D> act) {
  std::vector<scenes::Mistake> mistakes;
  const auto built = scenes::build<D>(scene, mistakes);
  if (built == nullptr) throw std::logic_error(scene.name + ": " + mistakes.front().reason);
  solver::World<D>& world = built->world;
  Course course;
  course.start = bodies_of(world);
  const solver::BodyView<D> first = world.bodies().back();
  const Motions before = motions_of(world.state());
  course.energy_start_j = course.energy_end_j = before.energy_j;
  Motions now = before;
  for (std::uint32_t tick = 1; tick <= ticks && course.ended; ++tick) {
    if (act != nullptr) act(world, tick);
    course.ended = world.step().ok();
    now = motions_of(world.state());
    course.ended = course.ended && now.finite;
    take_motions(now, 2 * tick > ticks, course);
    take_turn(first, world.bodies().back(), course);
    if (tick % kTicksPerMeasure == 0)
      take_accuracy(world.state(), tick + kTicksOfEnd > ticks, course);
  }
  course.end = bodies_of(world);
  const double size = distance(before.momentum, {});
  if (size > 0.0) course.momentum_error = distance(now.momentum, before.momentum) / size;
  return course;
}

Course run_trial(const scenes::Trial& trial, const solver::Tuning& method, Act<2> act) {
  scenes::Scene scene = trial.make();
  scene.tuning = with_method(scene.tuning, method);
  if (scene.dimension == 3) return run<3>(scene, trial.ticks, nullptr);
  return run<2>(scene, trial.ticks, act);
}

}  // namespace cycloid::trials
