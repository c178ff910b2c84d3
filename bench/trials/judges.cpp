#include "bench/trials/judges.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <stdexcept>

namespace cycloid::trials {

/// Beyond this nothing of the scene is left, whatever else it measures.
static constexpr double kSpeedOfNothing_m_s = 2000.0;

static double moved(const Course& course, std::size_t body) {
  return distance(course.start[body].position, course.end[body].position);
}

/// How many bodies of less than `mass_max` kg end farther than `far` m from where they began.
static double count_moved(const Course& course, double far, double mass_max = 1e30) {
  double count = 0.0;
  for (std::size_t i = 0; i < course.start.size(); ++i)
    if (course.start[i].mass > 0.0 && course.start[i].mass < mass_max && moved(course, i) > far)
      ++count;
  return count;
}

static double sunk(const Course& course) {
  return std::abs(course.start.back().position[1] - course.end.back().position[1]);
}
static double sunk_from_11(const Course& course) {
  return std::abs(11.0 - course.end.back().position[1]);
}
static double sunk_from_1(const Course& course) {
  return std::abs(1.0 - course.end.back().position[1]);
}
static double boxes_moved(const Course& course) {
  return count_moved(course, 0.25);
}
static double light_boxes_moved(const Course& course) {
  return count_moved(course, 0.5, 50.0);
}
static double cards_moved(const Course& course) {
  return count_moved(course, 0.1);
}
static double lean(const Course& course) {
  return std::abs(course.end.back().angle);
}
static double keystone_sunk(const Course& course) {
  const double sunk_m = course.start[9].position[1] - course.end[9].position[1];
  return std::abs(sunk_m) + std::abs(course.end[9].angle);
}
static double gap(const Course& course) {
  return course.gap_end_m;
}
/// Of what is thrown about to the end, where the gap of the last second is that of a blow or of a
/// flight, as it falls out.
static double median_gap(const Course& course) {
  std::vector<double> gaps = course.gaps_m;
  if (gaps.empty()) return 0.0;
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return *middle;
}
static double overlap_at_end(const Course& course) {
  return course.overlap_end_m;
}
static double deepest(const Course& course) {
  return course.overlap_max_m;
}
static double speed_reached(const Course& course) {
  return course.speed_max_m_s;
}
static double speed_late(const Course& course) {
  return course.speed_late_m_s;
}
static double risen(const Course& course) {
  return std::max(course.highest_late_m - 1.5, 0.0);
}
/// Along a slope of 0.25 in ten seconds; that a contact gives way is another matter.
static double drift_mm_per_min(const Course& course) {
  const std::array<double, 3>& from = course.start[1].position;
  const std::array<double, 3>& to = course.end[1].position;
  const double along = (4.0 * (to[0] - from[0]) + (to[1] - from[1])) / std::sqrt(17.0);
  return 1000.0 * std::abs(along) * 60.0 / 10.0;
}
/// On a slope of 0.25: against (sin - mu cos) g over two seconds from rest, %.
static double slide_error(const Course& course) {
  const double way = 0.5 * 10.0 * ((0.25 - 0.1) / std::sqrt(1.0 + 0.25 * 0.25)) * 4.0;
  return 100.0 * std::abs(moved(course, 1) - way) / way;
}
static double dominoes_standing(const Course& course) {
  double count = 0.0;
  for (const BodyAt& body : course.end)
    if (body.mass > 0.0 && std::abs(body.angle) < 0.5) ++count;
  return count;
}
static double beyond_limit(const Course& course) {
  return std::max(course.turn_max_rad - 0.5, 0.0);
}
static double spin_at_end(const Course& course) {
  double most = 0.0;
  for (const BodyAt& body : course.end) most = std::max(most, std::abs(body.spin[0]));
  return most;
}
static double balls_through(const Course& course) {
  double count = 0.0;
  for (const BodyAt& body : course.end)
    if (body.mass > 0.0 && body.position[0] > 10.0) ++count;
  return count;
}
static double rods_that_missed(const Course& course) {
  double count = 0.0;
  for (const BodyAt& body : course.end)
    if (body.mass > 0.0 && std::abs(body.spin[0] - 50.0) < 0.5) ++count;
  return count;
}
static double top_moved(const Course& course) {
  return moved(course, course.end.size() - 1);
}
static double overlap_over_radius(const Course& course) {
  return course.overlap_end_m / 0.001;
}
static double overlap_over_pebble(const Course& course) {
  return course.overlap_end_m / 0.1;
}
static double slip(const Course& course) {
  return std::abs(50.0 - course.end.back().velocity[0]);
}
/// Of a scene that is its own mirror image.
static double middle_aside(const Course& course) {
  double sum = 0.0;
  for (const BodyAt& body : course.end) sum += body.mass * body.position[0];
  double mass = 0.0;
  for (const BodyAt& body : course.end) mass += body.mass;
  return std::abs(sum / mass);
}
static double energy_error(const Course& course) {
  return 100.0 * std::abs(course.energy_end_j - course.energy_start_j) /
         std::abs(course.energy_start_j);
}
static double momentum_error(const Course& course) {
  return std::max(100.0 * course.momentum_error, energy_error(course));
}
/// What never turns over keeps both by doing nothing.
static double flip_error(const Course& course) {
  return course.turned_over ? momentum_error(course) : 100.0;
}

/// The heavy disc goes when the second half begins.
static void take_heavy_away(solver::World<2>& world, std::uint32_t tick) {
  if (tick != 151) return;
  if (!world.destroy_body(world.bodies().back().id).ok())
    throw std::logic_error("the heavy disc is gone already");
}

static void draw_to_middle(solver::World<2>& world, std::uint32_t) {
  for (const solver::BodyView<2>& body : world.bodies()) {
    const double x = static_cast<double>(body.position[0]);
    const double y = static_cast<double>(body.position[1]);
    const double far = std::max(distance({x, y, 0.0}, {}), 1.0e-3);
    const auto force_x = static_cast<float>(-1000.0 * x / far);
    const auto force_y = static_cast<float>(-1000.0 * y / far);
    if (!world.apply_force(body.id, {{force_x, force_y}}).ok())
      throw std::logic_error("a disc takes no force");
  }
}

/// Four become three, and one becomes two, when the second half begins.
static void lessen_substeps(solver::World<2>& world, std::uint32_t tick) {
  if (tick != 201) return;
  solver::Tuning tuning = world.tuning();
  tuning.substeps = tuning.substeps > 1 ? tuning.substeps * 3 / 4 : 2;
  if (!world.set_tuning(tuning).ok()) throw std::logic_error("substeps cannot be changed");
}

static constexpr Judge kJudges[] = {
    {"trial-heavy-on-light-10", "sunk, m", sunk, 0.02, 0.25},
    {"trial-heavy-on-light-100", "sunk, m", sunk, 0.02, 0.25},
    {"trial-heavy-on-light-1000", "sunk, m", sunk, 0.02, 0.25},
    {"trial-stack-10", "sunk, m", sunk, 0.1, 1.0},
    {"trial-stack-20", "sunk, m", sunk, 0.2, 1.0},
    {"trial-stack-30", "sunk, m", sunk, 0.3, 1.0},
    {"trial-pyramid-20", "boxes moved by 0.25 m", boxes_moved, 0.0, 10.0},
    {"trial-heavy-apexes", "boxes moved by 0.5 m", light_boxes_moved, 0.0, 5.0},
    {"trial-400-on-thin-ground", "sunk, m", sunk_from_11, 0.02, 0.2},
    {"trial-400-on-thick-ground", "sunk, m", sunk_from_11, 0.02, 0.2},
    {"trial-box-on-pole-25", "sunk, m", sunk_from_1, 0.02, 0.5},
    {"trial-box-on-pole-5", "sunk, m", sunk_from_1, 0.02, 0.5},
    {"trial-tall-box", "lean, rad", lean, 0.001, 0.5},
    {"trial-card-house", "cards moved by 0.1 m", cards_moved, 0.0, 4.0},
    {"trial-arch", "keystone sunk, m, and turned, rad", keystone_sunk, 0.05, 0.5},
    {"trial-ball-and-chain", "gap, m", gap, 0.005, 0.5},
    {"trial-chain-100", "gap, m", gap, 0.005, 0.5},
    {"trial-chain-1000", "gap, m", gap, 0.005, 0.5},
    {"trial-chain-50000", "gap, m", gap, 0.005, 0.5},
    {"trial-bridge", "median gap, m", median_gap, 0.005, 0.5},
    {"trial-joint-grid-30", "gap, m", gap, 0.005, 0.5},
    {"trial-joint-grid-100", "gap, m", gap, 0.005, 0.5},
    {"trial-stretched-chain", "gap, m", gap, 0.005, 0.5},
    {"trial-overlap", "speed reached, m/s", speed_reached, 1.0, 4.0},
    {"trial-confined", "speed reached, m/s", speed_reached, 3.5, 10.0},
    {"trial-warm-start-removal", "risen, m", risen, 0.01, 0.2, take_heavy_away},
    {"trial-sliding-rod-forwards", "overlap, m", deepest, 0.02, 0.1},
    {"trial-sliding-rod-backwards", "overlap, m", deepest, 0.02, 0.1},
    {"trial-ramp-sticks", "drift, mm/min", drift_mm_per_min, 10.0, 1000.0},
    {"trial-ramp-slides", "error of the way, %", slide_error, 2.0, 20.0},
    {"trial-double-domino", "dominoes left standing", dominoes_standing, 0.0, 3.0},
    {"trial-motor-at-limit", "beyond the limit, rad", beyond_limit, 0.01, 0.2},
    {"trial-fighting-motors", "spin, rad/s", spin_at_end, 0.05, 1.0},
    {"trial-gear-loop", "spin, rad/s", spin_at_end, 0.05, 1.0},
    {"trial-projectile-200", "balls behind the wall", balls_through, 0.0, 0.0},
    {"trial-projectile-1000", "balls behind the wall", balls_through, 0.0, 0.0},
    {"trial-spinning-rod", "pegs missed", rods_that_missed, 0.0, 0.0},
    {"trial-corner-30", "overlap, m", overlap_at_end, 0.02, 0.1},
    {"trial-corner-5", "overlap, m", overlap_at_end, 0.02, 0.1},
    {"trial-far-stack", "top moved, m", top_moved, 0.05, 0.5},
    {"trial-marble", "overlap over radius", overlap_over_radius, 0.1, 1.0},
    {"trial-pebble", "overlap over the pebble", overlap_over_pebble, 0.1, 0.5},
    {"trial-substeps-change", "speed after it, m/s", speed_late, 0.02, 0.5, lessen_substeps},
    {"trial-rolling-wheel", "slowed, m/s", slip, 0.05, 5.0},
    {"trial-rush", "overlap, m", overlap_at_end, 0.1, 0.5, draw_to_middle},
    {"trial-order", "middle aside, m", middle_aside, 0.001, 0.1},
    {"trial-cradle", "energy error, %", energy_error, 1.0, 10.0},
    {"trial-elastic-balls", "energy error, %", energy_error, 1.0, 10.0},
    {"trial-dzhanibekov", "error of momentum and energy, %", flip_error, 0.1, 2.0},
    {"trial-needle", "error of momentum and energy, %", momentum_error, 0.1, 2.0},
    {"trial-duplicate-points", "overlap, m", overlap_at_end, 0.02, 0.1},
    {"trial-ragdoll-stress", "median gap, m", median_gap, 0.05, 0.5},
};

const Judge& judge_of(const scenes::Trial& trial) {
  for (const Judge& each : kJudges)
    if (std::string(each.trial) == trial.name) return each;
  throw std::logic_error(std::string("nobody judges ") + trial.name);
}

Outcome judge(const scenes::Trial& trial, const solver::Tuning& method) {
  const Judge& by = judge_of(trial);
  return judged(by, run_trial(trial, method, by.act));
}

Outcome judged(const Judge& by, const Course& course) {
  Outcome outcome;
  outcome.ended = course.ended && course.end.size() > 0;
  if (!outcome.ended) return outcome;
  outcome.value = by.measure(course);
  const bool there = std::isfinite(outcome.value) && course.speed_late_m_s < kSpeedOfNothing_m_s;
  if (there && outcome.value <= by.sags) outcome.verdict = Verdict::kSags;
  if (there && outcome.value <= by.stands) outcome.verdict = Verdict::kStands;
  return outcome;
}

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kStands:
      return "stands";
    case Verdict::kSags:
      return "sags";
    case Verdict::kFails:
      break;
  }
  return "fails";
}

std::string outcome_text(const Outcome& outcome) {
  if (!outcome.ended) return verdict_name(outcome.verdict);
  char text[32];
  std::snprintf(text, sizeof text, "%s %.3g", verdict_name(outcome.verdict), outcome.value);
  return text;
}

}  // namespace cycloid::trials
