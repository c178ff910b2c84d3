#include "bench/tuning/passage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "bench/accuracy/measure.hpp"
#include "scenes/accuracy.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::tuning {

static constexpr std::uint64_t kTicksPerLook = 5;

template <int D>
static std::vector<MovingBody> moving_bodies(const solver::World<D>& world) {
  std::vector<MovingBody> found;
  const solver::Vec<D> pull = world.state().header.gravity;
  const double gravity = std::sqrt(static_cast<double>(dot(pull, pull)));
  for (const solver::BodyView<D>& view : world.bodies()) {
    const bool particle = view.kind == solver::BodyKind::kParticle;
    if (view.kind != solver::BodyKind::kDynamic && !particle) continue;
    const solver::Body<D>& body = world.state().bodies[view.id.index];
    found.push_back({view.id.index, view.id.generation, static_cast<double>(body.extent),
                     static_cast<double>(body.thickness),
                     gravity * static_cast<double>(body.mass * std::abs(body.gravity_scale)),
                     !particle && body.fixed_rotation == 0});
  }
  return found;
}

static std::vector<MovingBody> moving_bodies(const scenes::Simulation& simulation) {
  return simulation.planar() != nullptr ? moving_bodies<2>(*simulation.planar())
                                        : moving_bodies<3>(*simulation.spatial());
}

/// What a scene is looked at without: what it asks for needs no choice to be built.
static scenes::Simulation started(scenes::Scene scene) {
  return std::move(scenes::Simulation::create(scene).value());
}

std::vector<MovingBody> moving_bodies(const scenes::Scene& scene) {
  scenes::Scene without = scene;
  without.accuracy = {};
  return moving_bodies(started(std::move(without)));
}

static std::vector<BodyPlace> places_of(const scenes::Simulation& simulation,
                                        const std::vector<MovingBody>& bodies) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, scenes::Pose> poses;
  for (const scenes::Pose& pose : simulation.poses())
    poses.emplace(std::pair(pose.index, pose.generation), pose);
  std::vector<BodyPlace> places(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto found = poses.find({bodies[i].index, bodies[i].generation});
    if (found == poses.end()) continue;
    places[i].there = true;
    std::copy_n(found->second.position.begin(), 3, places[i].position.begin());
    std::copy_n(found->second.rotation.begin(), 4, places[i].rotation.begin());
  }
  return places;
}

Passage run_passage(const scenes::Scene& scene, std::uint32_t ticks) {
  scenes::Simulation simulation = started(scene);
  const solver::Tuning tuning = scenes::tuning_of(scene);
  const std::int64_t second_begin = std::int64_t{ticks} - std::lround(scene.tick_hz);
  Passage passage;
  passage.bodies = moving_bodies(simulation);
  const auto look = [&](std::int64_t tick) {
    passage.looks.push_back(places_of(simulation, passage.bodies));
    if (tick > second_begin) ++passage.late_looks;
  };
  look(0);
  std::vector<scenes::SeatInput> inputs(static_cast<std::size_t>(simulation.seats()));
  for (std::uint32_t tick = 1; tick <= ticks && passage.ended; ++tick) {
    for (std::size_t seat = 0; seat < inputs.size(); ++seat)
      inputs[seat] = scenes::scripted_input(scene, static_cast<int>(seat), tick);
    passage.ended = simulation.step(inputs).ok();
    if (!passage.ended) break;
    const solver::Statistics statistics = simulation.statistics();
    ++passage.ticks;
    passage.rows_per_tick += accuracy::rows_of_tick(statistics, tuning);
    passage.contact_rows_per_tick += statistics.turning_rows_per_sweep;
    passage.asleep_per_tick += statistics.asleep;
    if (tick % kTicksPerLook == 0 || tick == ticks) look(tick);
  }
  const double made = std::max(1.0, static_cast<double>(passage.ticks));
  passage.rows_per_tick /= made;
  passage.contact_rows_per_tick /= made;
  passage.asleep_per_tick /= made;
  passage.state_bytes = simulation.encoded_bytes();
  passage.digest = simulation.digest();
  return passage;
}

/// The mean place in the last second; false where the body was taken away by then.
static bool mean_place(const Passage& passage, std::size_t body, std::array<double, 3>& mean) {
  mean = {};
  const std::size_t count = passage.late_looks;
  for (std::size_t i = passage.looks.size() - count; i < passage.looks.size(); ++i) {
    const BodyPlace& place = passage.looks[i][body];
    if (!place.there) return false;
    for (std::size_t k = 0; k < 3; ++k) mean[k] += place.position[k] / static_cast<double>(count);
  }
  return true;
}

static double squared_distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

double distance_at_end_m(const Passage& a, const Passage& b) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t body = 0; body < a.bodies.size(); ++body) {
    std::array<double, 3> place_a;
    std::array<double, 3> place_b;
    if (!mean_place(a, body, place_a) || !mean_place(b, body, place_b)) continue;
    sum += squared_distance(place_a, place_b);
    count += 1.0;
  }
  return count == 0.0 ? 0.0 : std::sqrt(sum / count);
}

/// How far apart two rotations bring a point at distance 1: 2 sin(t/2) of their angle t. From the
/// distance 2 sin(t/4) of the quaternions, which keeps small angles exact.
static double turn_between(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  double same = 0.0;
  double opposite = 0.0;  // A quaternion and its negative are one rotation.
  for (std::size_t k = 0; k < 4; ++k) {
    same += (a[k] - b[k]) * (a[k] - b[k]);
    opposite += (a[k] + b[k]) * (a[k] + b[k]);
  }
  const double squared = std::min(same, opposite);
  return 2.0 * std::sqrt(squared * std::max(0.0, 1.0 - 0.25 * squared));
}

double distance_max_m(const Passage& a, const Passage& b) {
  double largest = 0.0;
  for (std::size_t look = 0; look < std::min(a.looks.size(), b.looks.size()); ++look) {
    for (std::size_t body = 0; body < a.bodies.size(); ++body) {
      const BodyPlace& in_a = a.looks[look][body];
      const BodyPlace& in_b = b.looks[look][body];
      if (in_a.there != in_b.there) return std::numeric_limits<double>::infinity();
      if (!in_a.there) continue;
      largest = std::max(largest,
                         std::sqrt(squared_distance(in_a.position, in_b.position)) +
                             a.bodies[body].extent_m * turn_between(in_a.rotation, in_b.rotation));
    }
  }
  return largest;
}

double turned_max_m(const Passage& passage, std::size_t body) {
  double largest = 0.0;
  for (const std::vector<BodyPlace>& look : passage.looks)
    if (look[body].there)
      largest =
          std::max(largest, turn_between(look[body].rotation, passage.looks[0][body].rotation));
  return largest * passage.bodies[body].extent_m;
}

}  // namespace cycloid::tuning
