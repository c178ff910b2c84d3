#include "client/replica/interpolator.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace cycloid::client {
namespace {

using scenes::Pose;

auto id_of(const Pose& pose) {
  return std::tie(pose.index, pose.generation);
}

/// Along the great arc from a to b at constant rate, the shorter way round; t may be over 1.
/// Source: Shoemake, "Animating rotation with quaternion curves", 1985.
std::array<float, 4> slerp(const std::array<float, 4>& a, std::array<float, 4> b, double t) {
  double cosine = 0.0;
  for (std::size_t i = 0; i < 4; ++i) cosine += double{a[i]} * double{b[i]};
  if (cosine < 0.0) {  // b and -b are one rotation; this one is nearer.
    cosine = -cosine;
    for (float& value : b) value = -value;
  }
  // The library's functions, which round otherwise on each platform: poses to be drawn never come
  // back into a state, an input or a digest.
  double of_a = 1.0 - t;
  double of_b = t;
  if (cosine < 0.9999) {
    const double angle = std::acos(cosine);
    of_a = std::sin((1.0 - t) * angle) / std::sin(angle);
    of_b = std::sin(t * angle) / std::sin(angle);
  }
  std::array<double, 4> mixed{};
  double squares = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    mixed[i] = of_a * double{a[i]} + of_b * double{b[i]};
    squares += mixed[i] * mixed[i];
  }
  std::array<float, 4> result{};
  for (std::size_t i = 0; i < 4; ++i) result[i] = static_cast<float>(mixed[i] / std::sqrt(squares));
  return result;
}

Pose mix(const Pose& a, const Pose& b, double t) {
  Pose pose = b;
  for (std::size_t i = 0; i < 3; ++i) {
    pose.position[i] = static_cast<float>(double{a.position[i]} +
                                          t * (double{b.position[i]} - double{a.position[i]}));
  }
  pose.rotation = slerp(a.rotation, b.rotation, t);
  return pose;
}

}  // namespace

Interpolator::Interpolator(InterpolatorOptions options) : options_(options) {
  options_.states_max = std::max<std::size_t>(2, options_.states_max);
}

void Interpolator::add(std::uint64_t tick, std::span<const Pose> poses) {
  while (!states_.empty() && states_.back().tick >= tick) states_.pop_back();
  State& state = states_.emplace_back();
  state.tick = tick;
  state.poses.assign(poses.begin(), poses.end());
  std::sort(state.poses.begin(), state.poses.end(),
            [](const Pose& a, const Pose& b) { return id_of(a) < id_of(b); });
  if (states_.size() > options_.states_max) states_.pop_front();
}

std::vector<Pose> Interpolator::at(double tick) const {
  if (states_.empty()) return {};
  const State& newest = states_.back();
  if (std::isnan(tick)) return newest.poses;
  const auto tick_of = [](const State& state) { return static_cast<double>(state.tick); };
  if (tick >= tick_of(newest)) {
    if (states_.size() == 1) return newest.poses;
    const State& before = states_[states_.size() - 2];
    const double ahead = std::min(tick - tick_of(newest), options_.extrapolation_ticks);
    return between(before, newest, 1.0 + ahead / (tick_of(newest) - tick_of(before)));
  }
  const auto later =
      std::upper_bound(states_.begin(), states_.end(), tick,
                       [&](double time, const State& state) { return time < tick_of(state); });
  if (later == states_.begin()) return states_.front().poses;
  const State& from = *(later - 1);
  return between(from, *later, (tick - tick_of(from)) / (tick_of(*later) - tick_of(from)));
}

bool Interpolator::teleports(const State& from, const State& to, const Pose& a,
                             const Pose& b) const {
  double squares = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double way = double{b.position[i]} - double{a.position[i]};
    squares += way * way;
  }
  const double most = double{options_.teleport_m} * static_cast<double>(to.tick - from.tick);
  return squares > most * most;
}

std::vector<Pose> Interpolator::between(const State& from, const State& to, double part) const {
  std::vector<Pose> poses;
  const bool arrived = part >= 1.0;
  auto a = from.poses.begin();
  auto b = to.poses.begin();
  while (a != from.poses.end() || b != to.poses.end()) {
    const bool only_a = b == to.poses.end() || (a != from.poses.end() && id_of(*a) < id_of(*b));
    const bool only_b = !only_a && (a == from.poses.end() || id_of(*b) < id_of(*a));
    if (only_a) {
      if (!arrived) poses.push_back(*a);
      ++a;
    } else if (only_b) {
      if (arrived) poses.push_back(*b);
      ++b;
    } else {
      const bool jumps = teleports(from, to, *a, *b);
      poses.push_back(jumps ? (arrived ? *b : *a) : mix(*a, *b, part));
      ++a;
      ++b;
    }
  }
  return poses;
}

TickEvents& EventFeed::of(std::uint64_t tick) {
  const auto at = std::lower_bound(
      waiting_.begin(), waiting_.end(), tick,
      [](const TickEvents& events, std::uint64_t wanted) { return events.tick < wanted; });
  if (at != waiting_.end() && at->tick == tick) return *at;
  TickEvents events;
  events.tick = tick;
  return *waiting_.insert(at, std::move(events));
}

void EventFeed::add(const protocol::InputFrame& frame) {
  if (frame.events.empty()) return;
  TickEvents& events = of(frame.tick);
  events.seats.insert(events.seats.end(), frame.events.begin(), frame.events.end());
  for (; waiting_.size() > kTicksMax; ++lost_) waiting_.pop_front();
}

void EventFeed::add(std::uint64_t tick, std::span<const Pose> poses) {
  const std::vector<BodyChange> changes = changes_.compare(poses);
  if (changes.empty()) return;
  TickEvents& events = of(tick);
  events.bodies.insert(events.bodies.end(), changes.begin(), changes.end());
  for (; waiting_.size() > kTicksMax; ++lost_) waiting_.pop_front();
}

std::vector<TickEvents> EventFeed::take_until(double tick) {
  std::vector<TickEvents> taken;
  while (!waiting_.empty() && static_cast<double>(waiting_.front().tick) <= tick) {
    taken.push_back(std::move(waiting_.front()));
    waiting_.pop_front();
  }
  return taken;
}

}  // namespace cycloid::client
