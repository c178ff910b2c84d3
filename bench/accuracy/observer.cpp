#include "bench/accuracy/observer.hpp"

#include <algorithm>
#include <cmath>

#include "bench/peers/accuracy.hpp"

namespace cycloid::accuracy {

using solver::Body;
using solver::Joint;
using solver::JointKind;
using solver::Vec;
using solver::WorldState;

/// So far all bodies may rise without that being much, m: what overlap is resolved by, and more.
static constexpr double kLift_m = 0.1;

Spread spread_of(std::vector<double>& sizes) {
  Spread spread;
  if (sizes.empty()) return spread;
  double squares = 0.0;
  for (const double size : sizes) {
    spread.max = std::max(spread.max, size);
    squares += size * size;
  }
  spread.rms = std::sqrt(squares / static_cast<double>(sizes.size()));
  const std::size_t rank = (sizes.size() * 95 + 99) / 100 - 1;
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(rank), sizes.end());
  spread.p95 = sizes[rank];
  return spread;
}

static void take_worst(double value, std::optional<double>& worst) {
  worst = std::max(value, worst.value_or(0.0));
}

/// Whether a joint pushes its bodies from a point of the world or along an axis of it, or may,
/// since nobody knows its rows here.
template <int D>
static bool pushes_from_outside(const Joint<D>& joint) {
  const bool is_rack = joint.kind == JointKind::kGear && dot(joint.axis, joint.axis) > 0.0f;
  return is_rack || joint.kind == JointKind::kPulley || joint.kind == JointKind::kUser;
}

/// Whether the bodies are on their own: what they do to each other leaves their momentum alone.
template <int D>
static bool keeps_momentum(const WorldState<D>& state) {
  for (const Body<D>& body : state.bodies) {
    if (body.kind == solver::BodyKind::kFree) continue;
    if (!trials::responds(body) || body.linear_damping > 0.0f || body.angular_damping > 0.0f)
      return false;
  }
  return std::none_of(state.joints.begin(), state.joints.end(), pushes_from_outside<D>);
}

/// Whether each body answers to what turns it, and nothing that turns it stands on the world.
template <int D>
static bool turns_freely(const WorldState<D>& state) {
  for (const Body<D>& body : state.bodies)
    if (body.kind == solver::BodyKind::kParticle || body.fixed_rotation != 0) return false;
  for (const Joint<D>& joint : state.joints)
    if (joint.kind == JointKind::kGear) return false;
  return true;
}

/// Whether a joint may bring energy in.
template <int D>
static bool may_bring_energy(const Joint<D>& joint) {
  if (joint.kind == JointKind::kFree) return false;
  return joint.motor != solver::MotorKind::kOff || joint.hertz > 0.0f ||
         joint.angular_hertz > 0.0f || joint.kind == JointKind::kMotor ||
         joint.kind == JointKind::kTarget || joint.kind == JointKind::kUser;
}

/// Whether a body or a joint may bring energy in, besides gravity.
template <int D>
static bool is_driven(const WorldState<D>& state) {
  for (const Body<D>& body : state.bodies)
    if (body.kind == solver::BodyKind::kKinematic) return true;
  return std::any_of(state.joints.begin(), state.joints.end(), may_bring_energy<D>);
}

template <int D>
static bool falls_alike(const WorldState<D>& state) {
  if (dot(state.header.gravity, state.header.gravity) == 0.0f) return true;
  float scale = -1.0f;
  for (const Body<D>& body : state.bodies) {
    if (!trials::responds(body)) continue;
    if (scale >= 0.0f && body.gravity_scale != scale) return false;
    scale = body.gravity_scale;
  }
  return true;
}

template <int D>
static Vec<D> weight_of(const WorldState<D>& state) {
  Vec<D> weight = Vec<D>::zero();
  for (const Body<D>& body : state.bodies)
    if (trials::responds(body)) weight += (body.mass * body.gravity_scale) * state.header.gravity;
  return weight;
}

template <int D>
Observer<D>::Observer(const WorldState<D>& start, std::uint32_t ticks, bool acted_on,
                      const MeasureOptions& options)
    : options_(options), ticks_(ticks) {
  const auto second =
      static_cast<std::uint32_t>(std::lround(1.0 / static_cast<double>(start.header.tick_s)));
  steady_from_ = ticks - std::min(second, ticks - ticks / 2);
  has_impulses_ =
      options.impulses && start.header.tuning.stabilisation != solver::Stabilisation::kXpbd;
  keeps_momentum_ = !acted_on && keeps_momentum(start);
  keeps_angular_ = keeps_momentum_ && turns_freely(start) && falls_alike(start);
  is_driven_ = acted_on || is_driven(start);
  energy_start_j_ = trials::motions_of(start).energy_j;
  momenta_start_ = momenta_of(start);
  weight_ = weight_of(start);
  for (const Body<D>& body : start.bodies) positions_start_.push_back(body.position);
  look_at_momenta(start, 0);
}

/// The farthest that a body is from where it was; nothing without bodies that forces move.
template <int D>
static std::optional<double> farthest_from(const std::vector<Vec<D>>& start,
                                           const WorldState<D>& now) {
  std::optional<double> farthest;
  for (std::size_t i = 0; i < std::min(start.size(), now.bodies.size()); ++i)
    if (trials::responds(now.bodies[i]))
      take_worst(static_cast<double>(length(now.bodies[i].position - start[i])), farthest);
  return farthest;
}

template <int D>
bool Observer<D>::look(const WorldState<D>& state, std::uint32_t tick) {
  const trials::Motions motions = trials::motions_of(state);
  if (!motions.finite) return false;
  take_worst(motions.energy_j - energy_start_j_, metrics_.energy_gained_j);
  kinetic_max_j_ = std::max(kinetic_max_j_, motions.kinetic_j);
  metrics_.moved_m = farthest_from(positions_start_, state);
  const bool steady = tick > steady_from_;
  const bool measured = (ticks_ - tick) % options_.every == 0;
  if (keeps_momentum_) look_at_momenta(state, tick);
  if (measured) look_at_poses(state, steady);
  if (has_impulses_ && steady) look_at_impulses(state, measured);
  if (!steady) return true;
  for (const Body<D>& body : state.bodies) {
    if (!trials::responds(body)) continue;
    speed_squares_ += static_cast<double>(dot(body.velocity, body.velocity));
    ++speeds_;
  }
  return true;
}

template <int D>
void Observer<D>::look_at_momenta(const WorldState<D>& state, std::uint32_t tick) {
  const Momenta now = momenta_of(state);
  std::array<double, 3> linear = now.linear;
  const double time_s = static_cast<double>(state.header.tick_s) * tick;
  for (int i = 0; i < D; ++i)
    linear[static_cast<std::size_t>(i)] -= time_s * static_cast<double>(weight_[i]);
  linear_drift_ = std::max(linear_drift_, trials::distance(linear, momenta_start_.linear));
  angular_drift_ = std::max(angular_drift_, trials::distance(now.angular, momenta_start_.angular));
  linear_size_ = std::max(linear_size_, now.linear_size);
  angular_size_ = std::max(angular_size_, now.angular_size);
}

template <int D>
void Observer<D>::look_at_poses(const WorldState<D>& state, bool steady) {
  const peers::Poses<D> poses = [&](std::uint32_t body) {
    return solver::Pose<D>{state.bodies[body].position, state.bodies[body].rotation};
  };
  const std::size_t time = steady ? 1 : 0;
  has_looked_[time] = true;
  for (const float depth : peers::overlaps_of<D>(state, poses))
    depths_[time].push_back(static_cast<double>(depth));
  for (const float gap : peers::gaps_of<D>(state, poses))
    gaps_[time].push_back(static_cast<double>(gap));
}

template <int D>
void Observer<D>::look_at_impulses(const WorldState<D>& state, bool measured) {
  const ContactProblem<D> problem = contact_problem(state);
  stick_.look(state, problem);
  if (!measured || problem.rows.empty()) return;
  const reference::Residual residual = residual_of(problem);
  take_worst(residual.relative, metrics_.natural_map);
  take_worst(residual.complementarity, metrics_.complementarity_j);
  take_worst(cone_excess(problem), metrics_.cone_excess);
}

/// Drift over size; where nothing ever moved there is none.
static double share(double drift, double size) {
  return size > 0.0 ? drift / size : 0.0;
}

template <int D>
Metrics Observer<D>::finish(const WorldState<D>& end) {
  if (!metrics_.energy_gained_j) return metrics_;  // There was no tick to look at.
  if (has_looked_[0]) metrics_.penetration_transient_m = spread_of(depths_[0]);
  if (has_looked_[1]) metrics_.penetration_steady_m = spread_of(depths_[1]);
  if (!gaps_[0].empty()) metrics_.gap_transient_m = spread_of(gaps_[0]);
  if (!gaps_[1].empty()) metrics_.gap_steady_m = spread_of(gaps_[1]);
  if (keeps_momentum_) metrics_.momentum_drift = share(linear_drift_, linear_size_);
  if (keeps_angular_) metrics_.angular_momentum_drift = share(angular_drift_, angular_size_);
  const double lifting_j = kLift_m * static_cast<double>(length(weight_));
  if (!is_driven_)
    metrics_.energy_gained_share = share(*metrics_.energy_gained_j, kinetic_max_j_ + lifting_j);
  if (speeds_ > 0) metrics_.jitter_m_s = std::sqrt(speed_squares_ / static_cast<double>(speeds_));
  if (const std::optional<double> crept = stick_.farthest_m_per_tick())
    metrics_.stick_drift_mm_min = *crept * 1000.0 / static_cast<double>(end.header.tick_s) * 60.0;
  if (!has_impulses_) return metrics_;
  const auto errors = direct_errors(contact_problem(end), end, options_.direct_rows_max);
  if (!errors) return metrics_;
  metrics_.impulse_error = errors->impulse;
  metrics_.wrench_error = errors->wrench;
  metrics_.velocity_error = errors->velocity;
  return metrics_;
}

template class Observer<2>;
template class Observer<3>;

}  // namespace cycloid::accuracy
