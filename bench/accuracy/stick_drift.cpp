#include <algorithm>
#include <set>

#include "bench/accuracy/observer.hpp"
#include "solver/collision/collide.hpp"

namespace cycloid::accuracy {

using solver::Body;
using solver::Pose;
using solver::Vec;
using solver::WorldState;

/// A contact slips from this share of what friction can hold on.
static constexpr double kHeld = 0.999;

using BodyPair = std::pair<std::uint32_t, std::uint32_t>;

/// Bodies of which every point that pushes is held, and some point pushes.
template <int D>
static std::set<BodyPair> held_pairs(const ContactProblem<D>& problem) {
  constexpr std::size_t kTangents = solver::Dim<D>::kTangents;
  std::set<BodyPair> held;
  std::set<BodyPair> slipping;
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const ProblemRow<D>& row = problem.rows[i];
    if (row.kind != RowKind::kFriction) continue;
    double square = 0.0;
    for (std::size_t t = 0; t < kTangents; ++t)
      square += problem.rows[i + t].impulse * problem.rows[i + t].impulse;
    const double bound = kHeld * row.friction * std::max(problem.rows[row.normal].impulse, 0.0);
    if (bound > 0.0) (square < bound * bound ? held : slipping).insert({row.body_a, row.body_b});
    i += kTangents - 1;
  }
  for (const BodyPair& pair : slipping) held.erase(pair);
  return held;
}

/// A point of a body, world, m.
template <int D>
static Vec<D> point_of(const Body<D>& body, const Vec<D>& local) {
  return body.position + rotate(body.rotation, local);
}

template <int D>
void StickDrift<D>::look(const WorldState<D>& state, const ContactProblem<D>& problem) {
  const std::set<BodyPair> held = held_pairs(problem);
  if (looks_++ == 0)
    for (const solver::Contact<D>& contact : state.contacts)
      sticking_.push_back({contact.shape_a, contact.shape_b, {}, {}, {}, Vec<D>::zero()});
  std::vector<Sticking> still;
  for (Sticking each : sticking_) {
    const solver::Shape<D>& shape_a = state.shapes[each.shape_a];
    const solver::Shape<D>& shape_b = state.shapes[each.shape_b];
    if (!held.contains({shape_a.body, shape_b.body})) continue;
    const Body<D>& a = state.bodies[shape_a.body];
    const Body<D>& b = state.bodies[shape_b.body];
    if (looks_ > 1) {
      const Vec<D> apart = point_of(b, each.at_b) - point_of(a, each.at_a);
      each.crept += apart - dot(apart, each.normal) * each.normal;
    }
    const auto manifold =
        collide(shape_a, Pose<D>{a.position, a.rotation}, shape_b, Pose<D>{b.position, b.rotation},
                state.header.tuning.speculative_distance, state.polyhedra);
    if (manifold.point_count == 0) continue;
    // One material point of both bodies, midway between the surfaces; so they start as one.
    const Vec<D> at = a.position + manifold.points[0].anchor_a;
    each.at_a = rotate_back(a.rotation, manifold.points[0].anchor_a);
    each.at_b = rotate_back(b.rotation, at - b.position);
    each.normal = manifold.normal;
    still.push_back(each);
  }
  sticking_ = std::move(still);
}

template <int D>
std::optional<double> StickDrift<D>::farthest_m_per_tick() const {
  if (sticking_.empty() || looks_ < 2) return {};
  float farthest = 0.0f;
  for (const Sticking& each : sticking_) farthest = std::max(farthest, length(each.crept));
  return static_cast<double>(farthest) / (looks_ - 1);
}

template class StickDrift<2>;
template class StickDrift<3>;

}  // namespace cycloid::accuracy
