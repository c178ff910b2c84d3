#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "solver/coloring.hpp"
#include "solver/direct/body_matrix.hpp"
#include "solver/motion.hpp"

namespace cycloid::solver {

/// One scalar row of an island: Cdot = a . v_a + b . v_b, of nodes instead of bodies. A row of a
/// point has but its direction, the first D of `b`; that of a joint's point is an axis of the
/// world, and is not written down at all.
template <int D>
struct IslandRow {
  static constexpr int kFreedoms = Dim<D>::kFreedoms;
  Wide a[kFreedoms];  ///< Linear, then angular; 0 where the node is -1 or cannot turn.
  Wide b[kFreedoms];
  Wide missing;  ///< What the row wants gone of Cdot, m/s or rad/s.
  Wide impulse;  ///< Accumulated, N s or N m s.
  Wide change;   ///< Of the impulse, by the solve under way.
  Wide answer;   ///< Of Cdot, by the same.
  Wide closing;  ///< Speed at which its error of position is to go, m/s or rad/s: overlap below 0.
  Wide mass;     ///< Of the row alone, as the sweeps use it.
  Wide stiffness;  ///< Momentum per speed that it holds with: the island's, or its inertia.
  bool holds;      ///< Of a contact: it is an equality of the present solve. Joints' always are.
};

/// Rows that are bounded together: of a contact point its normal, then its tangents, whose length
/// is held to friction times the normal; of a joint its equalities.
template <int D>
struct IslandRows {
  int node_a;  ///< -1: a body that does not move.
  int node_b;
  int pair;  ///< BodyMatrix::beside of the two; -1 where one does not move.
  int first;
  int count;
  bool is_contact;
  Wide friction;
  Vec<D, Wide> arm_a;  ///< Of a point from the node; 0 where it cannot turn, or there is no point.
  Vec<D, Wide> arm_b;
  int points = 0;  ///< Of the rows, the first ones.
};

/// A contact or a rigid joint between the bodies of two slots.
struct HeldPair {
  std::uint32_t a;
  std::uint32_t b;
  int place;  ///< Block of contacts, or row of joints.
  int lane;   ///< Of the block; -1: it is a joint.
  int points;
  bool a_moves;
  bool b_moves;
};

/// Torque by which the force of a joint answers to a turn of a body, as an impulse: what makes it
/// swing, taken implicitly. Acts about all axes but `along`.
template <int D>
struct IslandTension {
  int node;
  float stiffness;  ///< kg m^2, above 0.
  Vec<D> along;     ///< Unit; in the plane the only axis is across it.
};

/// Velocity and spin of a node, and what stands behind them in its motion.
template <int D>
struct alignas(16) VelocityQuads {
  float numbers[4 * kVelocityQuads<D>];
};

/// What a solve has to know of the step.
struct IslandStep {
  Wide h;               ///< Of the substep, s.
  Wide push_speed_max;  ///< Nothing is moved out of overlap faster, m/s.
};

/// Counts of what `IslandSolver` has done since the tick began, the same on every machine.
struct IslandWork {
  std::uint64_t factors = 0;
  std::uint64_t products = 0;  ///< Of blocks, in those.
  std::uint64_t rests = 0;     ///< Islands that the warm start had brought to rest.
};

/// Slots or places sorted by their island, those of one ascending. Made when it is asked for.
struct ByIsland {
  std::vector<std::uint32_t> numbers;
  std::vector<std::uint32_t> first;  ///< By island, into `numbers`; that of the next is its end.

  std::span<const std::uint32_t> of(std::size_t island) const {
    return std::span(numbers).subspan(first[island], first[island + 1] - first[island]);
  }
};

/// How much of a guess is worth having, from 0 to 1: with so much of it the energy of the bodies is
/// least, and less than a tenth off is as good as it gets between substeps.
/// @param work    What the impulses of the guess do at the speeds that it has led to, J.
/// @param energy  What they do at those that they alone make, J.
Wide share_worth_having(Wide work, Wide energy);

/// What came of an island's solve.
enum class Solved {
  kWhole,
  kPartly,  ///< What was guessed to hold does not; sweeps have the rest to do.
};

/// Solves all contacts and joints of an island at once: of what pushes and sticks it makes
/// equalities, solves them with the stiffness of springs that the island's heaviest body can stand
/// on, and lets go of what would pull or slide.
///
/// A Newton method on the natural map: a normal row holds where impulse - mass * missing > 0, its
/// tangents where their natural impulse is inside the cone. The solve is
///   (M + J^T W J) dv = -J^T W missing,  dlambda = -W (missing + J dv),
/// proximal in dlambda, so that no load sags; what comes out is held to its bounds and taken as far
/// as it lessens 1/2 lambda^T A lambda + b^T lambda. No step makes that grow, so it adds no energy,
/// whatever the guess was. Sweeps go on from there. Which contacts hold is found in passes, and
/// only bodies that touch something, which are eliminated last, are factored anew in each.
///
/// Source: Silcowitz-Hansen, Niebe, Erleben, "Projected Gauss-Seidel Subspace Minimization Method
/// for Interactive Rigid Body Dynamics" (GRAPP 2010); tension: Tournier et al., "Stable Constrained
/// Dynamics" (SIGGRAPH 2015).
template <int D>
class IslandSolver {
 public:
  static constexpr int kFreedoms = Dim<D>::kFreedoms;
  using Vector = typename BodyMatrix<D>::Vector;
  using VectorPair = typename BodyMatrix<D>::VectorPair;

  /// A group of bodies, joined by rows, that is solved by itself.
  struct Island {
    Range nodes;
    Range steps;
    Range contact_steps;  ///< The last ones of those: of nodes that touch something.
    Range groups;
    Range joints;  ///< The last ones of those.
    Range tensions;
    int products;                ///< Of blocks, that factoring takes.
    int contact_products;        ///< Of those, in the steps of contacts.
    std::int64_t products_left;  ///< In this tick, before it is left to the sweeps.
    int bodies;                  ///< That move.
    int pairs;                   ///< Contacts and joints.
    float mass;                  ///< Of the heaviest body, kg.
    float inertia;               ///< The greatest, kg m^2.
    int joint_count;             ///< Of those.
    bool wanted;                 ///< In this tick it is to be solved, or weighed.
    bool planned;                ///< It is known whether and how to, as long as the same holds.
    bool numbered;               ///< It was looked at closely: it has nodes from the start.
    bool solvable;               ///< It costs little enough.
    bool taken;                  ///< Solved at once in this tick; else the sweeps have it.
    bool weighed;                ///< They have it, but a guess that has gone wrong is weakened.
    bool wild;                   ///< In this substep that guess is to be weighed.
    bool swept;     ///< Something acts on it that only sweeps know, so none passes it by.
    bool stands;    ///< Of contacts alone: it touches ground, and
    bool lands;     ///< it is not at rest (find_landing).
    bool stirred;   ///< The substep before had to solve it.
    bool calm;      ///< Of contacts alone, and the substep began with all its bodies slow,
    bool sways;     ///< but one of them not at rest.
    bool corrects;  ///< `correction` of its nodes is not 0.
    bool closes;    ///< Its joints were closed by velocities, which are still to lose that.
  };

  /// Where the rows of a group come from.
  struct Source {
    int place;  ///< Block of contacts, or row of joints.
    int lane;   ///< Of the block; -1: it is a joint.
    int point;
  };

  /// How a numbered island is solved; as long as the pairs of nodes stay as they are.
  struct Plan {
    bool solvable = false;  ///< Else it would cost too much, and is left to the sweeps.
    Range steps{0, 0};
    Range contact_steps{0, 0};
    int products = 0;
    int contact_products = 0;
  };

  BodyMatrix<D> matrix;
  std::vector<MovingPair> found_of;        ///< Contacts that islands were found of.
  bool joints_as_found = false;            ///< They are as when islands were found.
  std::vector<std::uint32_t> held_words;   ///< What `held` was made of, but for the joints.
  bool joints_as_listed = false;           ///< They, and their places, are as when `held` was made.
  std::vector<HeldPair> held;              ///< Contacts in the order of the colouring, then joints.
  std::vector<int> held_in;                ///< By held pair, its island; -1: neither moves.
  std::vector<std::pair<int, int>> pairs;  ///< Nodes that hold each other; -1 does not move.
  std::vector<std::pair<int, int>> pairs_before;
  int contact_pairs = 0;    ///< The first ones of those; joints follow.
  std::vector<int> beside;  ///< By pair of nodes: BodyMatrix::beside.
  std::vector<Plan> plans;  ///< By numbered island.
  std::vector<Island> islands;
  std::vector<IslandRows<D>> groups;       ///< Island by island.
  std::vector<IslandRow<D>> rows;          ///< Those of a group beside one another.
  std::vector<IslandTension<D>> tensions;  ///< Island by island.
  std::vector<Source> sources;             ///< By group.
  std::vector<std::uint32_t> body_of;      ///< By node, the slot.
  std::vector<std::uint32_t> tree;         ///< By slot: union-find of those that hold each other.
  std::vector<std::uint32_t> pairs_of;     ///< By slot: how many of those it is the first of.
  std::vector<int> node_of;                ///< By slot; -1: in no island that has nodes.
  std::vector<int> island_of;              ///< By slot; -1: nothing holds it.
  std::vector<Vector> change;              ///< By node: of the velocity, m/s and rad/s.
  std::vector<Vector> correction;          ///< By node: speed for positions alone.
  std::vector<VelocityQuads<D>> before;    ///< By node: that the substep began with.
  ByIsland slots_of;                       ///< By island, if is_sorted.
  ByIsland held_of;                        ///< Places in `held`, the same.
  std::vector<Vec<D>> mean_velocity;       ///< By island, of its bodies, m/s; find_landing.
  bool is_sorted = false;                  ///< Since islands were last found.
  std::vector<Motion<D>> guess;       ///< By slot: what the warm start has added (weigh_guesses).
  std::vector<std::uint32_t> loaded;  ///< Slots of bodies whose load calls for this solver.
  bool acts = false;                  ///< In this tick, on some island.
  bool has_all = false;               ///< All that moves, in fewer and longer substeps.
  bool only_thin = false;             ///< What was planned holds for thin islands alone.
  IslandWork work;

  /// Whether the pair at this place in `held` is of an island that has nodes.
  bool is_numbered(std::size_t place) const {
    const int at = held_in[place];
    return at >= 0 && islands[static_cast<std::size_t>(at)].numbered;
  }

  /// Whether soft sweeps go on from what a solve of this island leaves: where it is a loaded one of
  /// contacts alone. Joints, which they do not close, would part.
  bool is_shared(const Island& island) const { return only_thin && island.joint_count == 0; }

  /// The groups of an island: of its contacts, of its joints, of both; and the rows of a group.
  std::span<const IslandRows<D>> contacts_of(const Island& island) const {
    return groups_in({island.groups.begin, island.joints.begin});
  }
  std::span<const IslandRows<D>> joints_of(const Island& island) const {
    return groups_in(island.joints);
  }
  std::span<const IslandRows<D>> groups_of(const Island& island) const {
    return groups_in(island.groups);
  }
  IslandRow<D>* first_row(const IslandRows<D>& group) { return rows.data() + group.first; }
  const IslandRow<D>* first_row(const IslandRows<D>& group) const {
    return rows.data() + group.first;
  }
  std::span<IslandRow<D>> rows_of(const IslandRows<D>& group) {
    return {first_row(group), static_cast<std::size_t>(group.count)};
  }
  std::span<const IslandRow<D>> rows_of(const IslandRows<D>& group) const {
    return {first_row(group), static_cast<std::size_t>(group.count)};
  }

  /// One island: reads its rows and tensions, the motions and `before`; writes impulses, `change`
  /// and `correction`.
  Solved solve(Island& island, std::span<const BodyMass<D>> masses,
               std::span<const Motion<D>> motions, const IslandStep& step);
  /// Whether a contact of a solved island still approaches, pulls or slides by more than this, m/s.
  bool leaves_for_sweeps(const Island& island, Wide tolerance) const;

 private:
  std::span<const IslandRows<D>> groups_in(Range range) const {
    return {groups.data() + range.begin, groups.data() + range.end};
  }

  std::span<const IslandTension<D>> tensions_of(const Island& island) const {
    return {tensions.data() + island.tensions.begin, tensions.data() + island.tensions.end};
  }
  /// What is kept by node, of one island.
  template <class T>
  static void set_zero(const Island& island, std::vector<T>& by_node) {
    const auto begin = by_node.begin();
    std::fill(begin + island.nodes.begin, begin + island.nodes.end, T::zero());
  }
  template <class T>
  static void copy(const Island& island, const std::vector<T>& from, std::vector<T>& to) {
    const auto begin = from.begin();
    std::copy(begin + island.nodes.begin, begin + island.nodes.end,
              to.begin() + island.nodes.begin);
  }

  void add_up_impulses(const Island& island);
  Wide worth_of_guess(const Island& island, std::span<const BodyMass<D>> masses);
  void keep_of_guess(const Island& island, Wide share);
  void foresee_turns(const Island& island, std::span<const Motion<D>> motions, Wide h);
  Wide closing_speed(Island& island) const;
  void load_both(const Island& island, std::span<const Motion<D>> motions);
  void solve_and_close(const Island& island, std::span<const Motion<D>> motions, Wide fastest);
  void choose(const Island& island);
  bool let_go(const Island& island);
  void solve_round(Island& island, std::span<const BodyMass<D>> masses,
                   std::span<const Motion<D>> motions, bool is_first_round);
  void count_factor(int products, Island& island);
  void answer_joints(const Island& island);
  void assemble_joints(const Island& island, std::span<const BodyMass<D>> masses);
  void assemble_contacts(const Island& island);
  void load_joints(const Island& island, std::span<const Motion<D>> motions);
  Spin<D, Wide> pull_of(const IslandTension<D>& tension, std::span<const Motion<D>> motions) const;
  void solve_contacts(const Island& island);
  void assemble_point(const IslandRows<D>& group, Wide stiffness);
  void assemble_row(const IslandRows<D>& group, const IslandRow<D>& row);
  bool hold_to_bounds(const Island& island, std::span<const BodyMass<D>> masses);
  Wide best_step(const Island& island) const;
  Wide take(const Island& island, std::span<const BodyMass<D>> masses);
  Wide share_of_correction(const Island& island, Wide speed) const;
  void correct_positions(Island& island, Wide push_speed_max);
  void keep_load(const Island& island, std::span<const Motion<D>> motions);
  void relieve_stress(const Island& island, std::span<const BodyMass<D>> masses);
  void forget_conflict(const Island& island);

  std::vector<Vector> solution_;  ///< By node.
  std::vector<Vector> kept_;      ///< By node: what a solve of the contacts begins with.
  std::vector<Vector> momentum_;
  std::vector<Vector> guessed_;   ///< By node: velocity that the first guess is of.
  std::vector<VectorPair> both_;  ///< By node: of what is missed, and of closing.
  std::vector<VectorPair> kept_both_;
};

}  // namespace cycloid::solver
