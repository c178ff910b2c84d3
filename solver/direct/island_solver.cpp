#include <algorithm>

#include "solver/direct/island_parts.hpp"

namespace cycloid::solver {

/// How long a solve looks for what holds.
struct Effort {
  int passes;  ///< Solves more after which what would pull or slide is let go.
  int rounds;  ///< Times that it is tried while its step falls short, from where the last one led.
};
static constexpr Effort kThorough{4, 3};
/// Where soft sweeps can go on from what it leaves: they have a say then in which contacts slide.
/// An arch that is settled here sinks by four times as much; joints, which sweeps do not close,
/// would part.
static constexpr Effort kBrief{1, 1};
/// A step this near to the whole is one.
static constexpr Wide kWholeStep = 0.999;

/// Whether the tangents' natural impulses are within what the friction of the normal's holds.
template <int D>
static bool would_stick(Wide friction, const IslandRow<D>* normal) {
  Wide square = 0.0;
  for (int t = 1; t <= Dim<D>::kTangents; ++t) {
    const Wide natural = normal[t].impulse - normal[t].mass * normal[t].missing;
    square += natural * natural;
  }
  const Wide bound = friction * normal->impulse;
  return square < bound * bound;
}

template <int D>
bool IslandSolver<D>::leaves_for_sweeps(const Island& island, Wide tolerance) const {
  for (const IslandRows<D>& group : contacts_of(island)) {
    const IslandRow<D>* row = first_row(group);
    if (row[0].missing < -tolerance) return true;
    if (row[0].impulse == 0.0) continue;
    if (std::min(row[0].missing, row[0].impulse / row[0].mass) > tolerance) return true;
    for (int t = 1; t < group.count; ++t)
      if (magnitude(row[t].missing) > tolerance) return true;
  }
  return false;
}

Wide share_worth_having(Wide work, Wide energy) {
  constexpr Wide kMuch = 0.1;
  if (!(work > kMuch * energy) || !(energy > 0.0)) return 1.0;
  return std::clamp(1.0 - work / energy, 0.0, 1.0);
}

/// What all impulses of an island come to on each body, into `momentum_`.
template <int D>
void IslandSolver<D>::add_up_impulses(const Island& island) {
  set_zero(island, momentum_);
  for (const IslandRows<D>& group : groups_of(island)) {
    const IslandRow<D>* row = first_row(group);
    push_rows<D, Wide>(group, row, momentum_, [](const IslandRow<D>& of) { return of.impulse; });
  }
}

/// How much of the first guess is worth having, from 0 to 1: after a blow the impulses of the
/// substep before are those of the blow; and what is wedged between a joint and its contacts keeps
/// a stress that holds no load, grows with every solve that cannot meet it, and throws all about
/// once it turns a little. Leaves in `momentum_` the velocities that the guess is of.
template <int D>
Wide IslandSolver<D>::worth_of_guess(const Island& island, std::span<const BodyMass<D>> masses) {
  add_up_impulses(island);
  Wide work_done = 0.0;
  for (const IslandRows<D>& group : groups_of(island))
    for (const IslandRow<D>& row : rows_of(group)) work_done += row.impulse * row.missing;
  Wide energy = 0.0;
  for (int n = island.nodes.begin; n < island.nodes.end; ++n) {
    Vector& momentum = momentum_[static_cast<std::size_t>(n)];
    const Vector velocity = answer_to<D>(momentum, masses[body_of[static_cast<std::size_t>(n)]]);
    energy += dot(momentum, velocity);
    momentum = guessed_[static_cast<std::size_t>(n)] = velocity;
  }
  return share_worth_having(work_done, energy);
}

/// Takes the rest of the first guess back.
template <int D>
void IslandSolver<D>::keep_of_guess(const Island& island, Wide share) {
  for (int n = island.nodes.begin; n < island.nodes.end; ++n) {
    Vector& velocity = momentum_[static_cast<std::size_t>(n)];
    for (int i = 0; i < kFreedoms; ++i) {
      velocity[i] = (share - 1.0) * velocity[i];
      change[static_cast<std::size_t>(n)][i] += velocity[i];
    }
  }
  for (const IslandRows<D>& group : groups_of(island)) {
    IslandRow<D>* row = first_row(group);
    for_each_speed<D>(group, row, momentum_, [&](IslandRow<D>& of, Wide speed) {
      of.missing += speed;
      of.impulse = share * of.impulse;
    });
  }
}

/// What is shared with soft sweeps is left to them the sooner; others are solved to the end.
template <int D>
static Effort effort_of(const IslandSolver<D>& solver,
                        const typename IslandSolver<D>::Island& island) {
  return solver.is_shared(island) ? kBrief : kThorough;
}

/// Which rows of contacts are equalities, by the natural map.
template <int D>
void IslandSolver<D>::choose(const Island& island) {
  for (const IslandRows<D>& group : contacts_of(island)) {
    IslandRow<D>* row = first_row(group);
    row[0].holds = row[0].impulse - row[0].mass * row[0].missing > 0.0;
    const bool rubs = row[0].holds && group.friction > 0.0;
    // What has not pushed yet has no bound to compare with: it may well stick.
    const bool sticks = rubs && (row[0].impulse == 0.0 || would_stick<D>(group.friction, row));
    for (int t = 1; t < group.count; ++t) row[t].holds = sticks;
  }
}

/// Lets go of what would pull or slide after this solve. @returns whether there was any.
template <int D>
bool IslandSolver<D>::let_go(const Island& island) {
  constexpr Wide kSlack = 1.0001;
  bool any = false;
  for (const IslandRows<D>& group : contacts_of(island)) {
    IslandRow<D>* row = first_row(group);
    for_each_speed<D>(group, row, solution_, [](IslandRow<D>& of, Wide speed) {
      of.answer = speed;
      of.change = of.holds ? -of.stiffness * (of.missing + of.answer) : 0.0;
    });
    if (!row[0].holds) continue;
    const Wide normal = row[0].impulse + row[0].change;
    const Wide square = square_of_tangents(group, row);
    const Wide bound = kSlack * group.friction * std::max(normal, 0.0);
    if (normal < 0.0) row[0].holds = false;
    const bool slides = group.count > 1 && row[1].holds && square > bound * bound;
    if (normal < 0.0 || slides)
      for (int t = 1; t < group.count; ++t) row[t].holds = false;
    any = any || normal < 0.0 || slides;
  }
  return any;
}

/// What comes of the solve for the joints.
template <int D>
void IslandSolver<D>::answer_joints(const Island& island) {
  for (const IslandRows<D>& group : joints_of(island)) {
    IslandRow<D>* row = first_row(group);
    for_each_speed<D>(group, row, solution_, [](IslandRow<D>& of, Wide speed) {
      of.answer = speed;
      of.change = -of.stiffness * (of.missing + of.answer);
    });
  }
}

/// The share of a correction, at most 1, with which no body and no point of contact moves faster
/// than `speed`: points tell of turns, and bodies of what no row looks along.
template <int D>
Wide IslandSolver<D>::share_of_correction(const Island& island, Wide speed) const {
  Wide most = speed;
  for (int n = island.nodes.begin; n < island.nodes.end; ++n) {
    Wide of_node = 0.0;
    for (int i = 0; i < D; ++i)
      of_node = std::max(of_node, magnitude(correction[static_cast<std::size_t>(n)][i]));
    most = std::max(most, of_node);
  }
  for (const IslandRows<D>& group : contacts_of(island)) {
    const IslandRow<D>* row = first_row(group);
    for_each_speed<D>(group, row, correction, [&](const IslandRow<D>&, Wide corrected) {
      most = std::max(most, magnitude(corrected));
    });
  }
  return speed / most;
}

/// Speeds that take overlap away from positions and stay in no velocity; what holds stays together.
/// What is wedged between contacts that are nearly parallel would go a metre for a millimetre of
/// overlap, through all that does not hold it: then the whole island is corrected more slowly.
template <int D>
void IslandSolver<D>::correct_positions(Island& island, Wide push_speed_max) {
  island.corrects = false;
  set_zero(island, correction);
  for (const IslandRows<D>& group : contacts_of(island)) {  // Joints close by velocities.
    const IslandRow<D>* row = first_row(group);
    if (!row->holds || row->closing == 0.0) continue;
    island.corrects = true;
    push_row<D>(group, row, 0, -row->stiffness * row->closing, correction);
  }
  if (!island.corrects) return;
  matrix.solve_lower(island.contact_steps, correction);  // Before them there is nothing.
  matrix.solve_upper(island.steps, correction);
  const Wide share = share_of_correction(island, push_speed_max);
  for (int n = island.nodes.begin; n < island.nodes.end && share < 1.0; ++n)
    for (int i = 0; i < kFreedoms; ++i) correction[static_cast<std::size_t>(n)][i] *= share;
}

/// Lessens impulses that are many times what they do to bodies, as in a chain that lies jammed
/// between its contacts: they hold no load, grow with every solve that cannot meet its rows, and
/// throw all about once the rows have turned a little. Velocities stay as they were solved.
template <int D>
void IslandSolver<D>::relieve_stress(const Island& island, std::span<const BodyMass<D>> masses) {
  // In stacks and arches it is 1. With 30, once in three million ticks of rooms, a body leaves at
  // 2 km/s; with 10 the straight bridge parts.
  constexpr Wide kStress = 15.0;
  Wide load = 0.0;
  for (int n = island.nodes.begin; n < island.nodes.end; ++n) {
    const auto node = static_cast<std::size_t>(n);
    Wide speed = 0.0;
    for (int i = 0; i < D; ++i) speed += magnitude(guessed_[node][i] + change[node][i]);
    load += speed / static_cast<Wide>(masses[body_of[node]].inverse_mass);
  }
  Wide most = 0.0;
  for (const IslandRows<D>& group : groups_of(island)) {
    const IslandRow<D>* row = first_row(group);
    const int forces = std::min(group.count, D);  // Rows after those may be of torques.
    Wide of_group = 0.0;
    for (int r = 0; r < forces; ++r) of_group = std::max(of_group, magnitude(row[r].impulse));
    most = std::max(most, of_group);
  }
  if (most <= kStress * load) return;
  const Wide share = kStress * load / most;
  for (const IslandRows<D>& group : groups_of(island))
    for (IslandRow<D>& row : rows_of(group)) row.impulse *= share;
}

/// Joints that miss what they hold, after a solve, contradict each other or the contacts; their
/// impulses would grow with every substep, so the next one starts without any.
template <int D>
void IslandSolver<D>::forget_conflict(const Island& island) {
  // m/s or rad/s. What is solvable misses a thousandth; a chain that is all but straight and takes
  // a blow a tenth, for that is what its impulses change by: with 0.1 a bridge is let go then.
  constexpr Wide kConflict = 0.5;
  Wide most = 0.0;
  for (const IslandRows<D>& group : joints_of(island)) {
    const IslandRow<D>* row = first_row(group);
    Wide of_group = 0.0;
    for (int r = 0; r < group.count; ++r) of_group = std::max(of_group, magnitude(row[r].missing));
    most = std::max(most, of_group);
  }
  if (!(most > kConflict)) return;
  for (const IslandRows<D>& group : groups_of(island))
    for (IslandRow<D>& row : rows_of(group)) row.impulse = 0.0;
}

template <int D>
void IslandSolver<D>::count_factor(int products, Island& island) {
  ++work.factors;
  work.products += static_cast<std::uint64_t>(products);
  island.products_left -= products;
}

/// Finds the contacts that hold, and solves with them, in one round. The first pass of the first
/// round, whose joints close, solves for all nodes at once.
template <int D>
void IslandSolver<D>::solve_round(Island& island, std::span<const BodyMass<D>> masses,
                                  std::span<const Motion<D>> motions, bool is_first_round) {
  const Range inner{island.steps.begin, island.contact_steps.begin};
  const int passes = effort_of(*this, island).passes;
  choose(island);
  for (int pass = 0; pass <= passes; ++pass) {
    const bool is_first = is_first_round && pass == 0;
    if (is_first)
      assemble_joints(island, masses);
    else
      matrix.restore(island.contact_steps);
    assemble_contacts(island);
    const Wide fastest = is_first ? closing_speed(island) : 0.0;
    const bool solves_both = is_first && island.closes;
    if (solves_both) {
      solve_and_close(island, motions, fastest);
    } else {
      if (pass == 0) load_joints(island, motions);
      solve_contacts(island);
    }
    count_factor(is_first ? island.products : island.contact_products, island);
    if (let_go(island) && pass < passes) continue;
    if (!solves_both) matrix.solve_upper(inner, solution_);
    return answer_joints(island);
  }
}

template <int D>
Solved IslandSolver<D>::solve(Island& island, std::span<const BodyMass<D>> masses,
                              std::span<const Motion<D>> motions, const IslandStep& step) {
  solution_.resize(body_of.size());
  kept_.resize(body_of.size());
  both_.resize(body_of.size());
  kept_both_.resize(body_of.size());
  momentum_.resize(body_of.size());
  guessed_.resize(body_of.size());
  set_zero(island, change);
  const Wide share = worth_of_guess(island, masses);
  foresee_turns(island, motions, step.h);
  if (share < 1.0) keep_of_guess(island, share);
  const int rounds = effort_of(*this, island).rounds;
  Wide taken = 0.0;
  for (int round = 0; round < rounds && taken < kWholeStep; ++round) {
    if (round > 0 && island.products_left <= 0) break;
    solve_round(island, masses, motions, round == 0);
    taken = take(island, masses);
    if (round == 0 && taken == 1.0 && island.calm) keep_load(island, motions);
  }
  correct_positions(island, step.push_speed_max);
  relieve_stress(island, masses);
  forget_conflict(island);
  return taken < kWholeStep ? Solved::kPartly : Solved::kWhole;
}

template bool IslandSolver<2>::leaves_for_sweeps(const Island&, Wide) const;
template bool IslandSolver<3>::leaves_for_sweeps(const Island&, Wide) const;
template Solved IslandSolver<2>::solve(Island&, std::span<const BodyMass<2>>,
                                       std::span<const Motion<2>>, const IslandStep&);
template Solved IslandSolver<3>::solve(Island&, std::span<const BodyMass<3>>,
                                       std::span<const Motion<3>>, const IslandStep&);

}  // namespace cycloid::solver
