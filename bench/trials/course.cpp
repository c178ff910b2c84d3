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
static BodyAt body_at(const solver::Body<D>& from) {
  const solver::Vec<D> position = from.position - solver::rotate(from.rotation, from.local_center);
  BodyAt body;
  for (std::size_t i = 0; i < D; ++i) {
    body.position[i] = static_cast<double>(position[static_cast<int>(i)]);
    body.velocity[i] = static_cast<double>(from.velocity[static_cast<int>(i)]);
  }
  for (int i = 0; i < solver::Dim<D>::kSpin; ++i)
    body.spin[static_cast<std::size_t>(i)] = static_cast<double>(from.spin[i]);
  body.angle = angle_of(from.rotation);
  body.mass = static_cast<double>(from.mass);
  return body;
}

template <int D>
static std::vector<BodyAt> bodies_of(const solver::WorldState<D>& state) {
  std::vector<BodyAt> bodies;
  for (const solver::Body<D>& body : state.bodies)
    if (body.kind != solver::BodyKind::kFree) bodies.push_back(body_at(body));
  return bodies;
}

template <int D>
static const solver::Body<D>& last_body(const solver::WorldState<D>& state) {
  std::size_t last = state.bodies.size() - 1;
  while (last > 0 && state.bodies[last].kind == solver::BodyKind::kFree) --last;
  return state.bodies[last];
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
  course.gaps_m.push_back(static_cast<double>(accuracy.gap_m));
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

static void take_turn(const solver::Body<2>& first, const solver::Body<2>& last, Course& course) {
  course.turn_max_rad = std::max(course.turn_max_rad, std::abs(angle_of(last.rotation)));
  course.turned_over = course.turned_over || first.spin[0] * last.spin[0] < 0.0f;
}
static void take_turn(const solver::Body<3>& first, const solver::Body<3>& last, Course& course) {
  const solver::Vec<3> before = solver::rotate_back(first.rotation, first.spin);
  const solver::Vec<3> now = solver::rotate_back(last.rotation, last.spin);
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(before[i]) > std::abs(before[axis])) axis = i;
  course.turned_over = course.turned_over || before[axis] * now[axis] < 0.0f;
}

template <int D>
CourseWatch<D>::CourseWatch(const solver::WorldState<D>& start, std::uint32_t ticks)
    : ticks_(ticks), first_(last_body(start)), before_(motions_of(start)), now_(before_) {
  course_.start = bodies_of(start);
  course_.energy_start_j = course_.energy_end_j = before_.energy_j;
}

template <int D>
bool CourseWatch<D>::look(const solver::WorldState<D>& state, std::uint32_t tick) {
  now_ = motions_of(state);
  take_motions(now_, 2 * tick > ticks_, course_);
  take_turn(first_, last_body(state), course_);
  if (now_.finite && tick % kTicksPerMeasure == 0)
    take_accuracy(state, tick + kTicksOfEnd > ticks_, course_);
  return now_.finite;
}

template <int D>
Course CourseWatch<D>::finish(const solver::WorldState<D>& end, bool ended) {
  course_.ended = ended;
  course_.end = bodies_of(end);
  const double size = distance(before_.momentum, {});
  if (size > 0.0) course_.momentum_error = distance(now_.momentum, before_.momentum) / size;
  return course_;
}

template class CourseWatch<2>;
template class CourseWatch<3>;

template <int D>
static Course run(const scenes::Scene& scene, std::uint32_t ticks, Act<D> act) {
  std::vector<scenes::Mistake> mistakes;
  const auto built = scenes::build<D>(scene, mistakes);
  if (built == nullptr) throw std::logic_error(scene.name + ": " + mistakes.front().reason);
  solver::World<D>& world = built->world;
  CourseWatch<D> watch(world.state(), ticks);
  bool ended = true;
  for (std::uint32_t tick = 1; tick <= ticks && ended; ++tick) {
    if (act != nullptr) act(world, tick);
    ended = world.step().ok();
    ended = watch.look(world.state(), tick) && ended;
  }
  return watch.finish(world.state(), ended);
}

Course run_scene(scenes::Scene scene, std::uint32_t ticks, const solver::Tuning& method,
                 Act<2> act) {
  scene.tuning = with_method(scene.tuning, method);
  if (scene.dimension == 3) return run<3>(scene, ticks, nullptr);
  return run<2>(scene, ticks, act);
}

Course run_trial(const scenes::Trial& trial, const solver::Tuning& method, Act<2> act) {
  return run_scene(trial.make(), trial.ticks, method, act);
}

}  // namespace cycloid::trials
