#pragma once

#include <cstdint>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <vector>

#include "solver/active_bodies.hpp"
#include "solver/collision/bounds_tree.hpp"
#include "solver/collision/held_pairs.hpp"
#include "solver/collision/manifold.hpp"
#include "solver/collision/pair_cache.hpp"
#include "solver/coloring.hpp"
#include "solver/constraints/contact.hpp"
#include "solver/constraints/joint_row.hpp"
#include "solver/constraints/live_contact.hpp"
#include "solver/constraints/pin_block.hpp"
#include "solver/direct/island_solver.hpp"
#include "solver/direct/tree_solver.hpp"
#include "solver/lane_widths.hpp"
#include "solver/motion.hpp"
#include "solver/particles/move_particles.hpp"
#include "solver/queries/time_of_impact.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

struct StepTrace;

/// The contact blocks of one lane width. Those of a colour are independent of one another; the
/// overflow has a block per contact (only lane 0 used), solved in order.
template <int D, int W>
struct ContactBlocks {
  std::vector<ContactBlock<D, W>> blocks;
  std::vector<ContactExtra<D, W>> extras;  ///< By block; of use only where the block has one.
  std::vector<Range> colors;
  Range overflow;
  std::vector<Range> members;  ///< By block: its contacts, in the order of the colouring.

  /// Which blocks the contacts of a lot lie in.
  Range blocks_of(const Lot& lot) const {
    if (lot.colors.begin == lot.colors.end) return lot.overflow;
    const bool overflows = lot.overflow.begin != lot.overflow.end;
    return {
        colors[static_cast<std::size_t>(lot.colors.begin)].begin,
        overflows ? lot.overflow.end : colors[static_cast<std::size_t>(lot.colors.end) - 1].end};
  }

  /// The extra of a block, which it has from now on: all 0, and points that turn.
  ContactExtra<D, W>& extra_of(std::size_t block) {
    ContactExtra<D, W>*& extra = blocks[block].extra;
    if (extra != nullptr) return *extra;
    extra = &extras[block];
    static_assert(std::is_trivially_copyable_v<ContactExtra<D, W>>);
    std::memset(extra, 0, sizeof *extra);
    extra->turns_a = extra->turns_b = Lanes<W>(1.0f);
    return *extra;
  }
};

/// A registered kind of constraint.
template <int D>
struct UserRows {
  std::uint32_t user_kind;
  RowsFunction<D> function;
};

/// The function of a kind, or null where none was registered.
template <int D>
RowsFunction<D> find_rows_function(const std::vector<UserRows<D>>& registered,
                                   std::uint32_t user_kind) {
  for (const UserRows<D>& rows : registered)
    if (rows.user_kind == user_kind) return rows.function;
  return nullptr;
}

/// A body that moves so far in a tick that it could pass through something.
struct FastBody {
  std::uint32_t slot;
  bool is_pushed = false;  ///< Something behind it moves it on.
  float stop = 1.0f;       ///< The fraction of the tick at which it stops.
};

/// A body that ends its way before the tick does.
struct Stop {
  std::uint32_t slot;
  float fraction;  ///< Of the tick.

  bool operator<(const Stop& other) const {
    return fraction != other.fraction ? fraction < other.fraction : slot < other.slot;
  }
};

/// How what a shape of a fast body may meet is found.
enum class WayIs : std::uint8_t {
  kUnknown,   ///< It is of no fast body, or its way is not needed.
  kListed,    ///< Among pairs or candidates that are listed already.
  kSearched,  ///< It looks for all of it itself.
};

/// Which contacts of the state have a body that takes part in the coming tick by itself. A function
/// of the state, kept because there may be very many others.
struct ActiveContacts {
  std::vector<std::uint32_t> places;  ///< Ascending; none where all of them have.
  bool are_all = true;
  bool is_known = false;
};

/// What a world keeps from one step to the next beside its state: what it was told, and caches that
/// are functions of the state alone and change no result.
template <int D>
struct KeptByWorld {
  BoundsTree<D> static_tree;             ///< Of the shapes that cannot move: maybe a landscape.
  std::vector<std::uint32_t> unbounded;  ///< Half-spaces.
  PairCache<D> pair_cache;     ///< Whoever changes a pose, filter, shape or joint makes it forget.
  ActiveBodies active_bodies;  ///< Whoever changes a velocity, force or sleep touches it.
  ActiveContacts active_contacts;
  ContactColors contact_colors;  ///< Of the last tick: at rest they are those of the next.
  HeldPairs<D> held_pairs;  ///< Of the last tick; whoever changes a shape makes it forget them.
  std::vector<UserRows<D>> user_rows;  ///< Registered by the user; not state.
  StepTrace* trace = nullptr;          ///< Of World::step_traced, while it runs.
};

/// Places among all contacts of a tick, for as many as a chunk of its pairs had in the tick before.
template <int D>
struct ContactRoom {
  Contact<D>* contacts = nullptr;
  LiveContact<D>* live = nullptr;
  std::uint32_t first = 0;  ///< Place of the first among all.
  std::uint32_t size = 0;
  std::uint32_t used = 0;
};

/// A contact whose shapes were apart as the tick began: it touches where they push each other.
struct ApartContact {
  std::uint32_t contact = kNone;  ///< Place among those of the tick.
  std::uint32_t touched = kNone;  ///< Place in the state if it touched in the tick before.
};

/// The contacts of a tick in the order of their shapes, or those of one chunk of its pairs.
template <int D>
struct ContactList {
  std::vector<Contact<D>> contacts;  ///< Of a tick, but for those that rest: become the state's.
  std::vector<LiveContact<D>> live;  ///< Those with a manifold, in their order.
  std::vector<std::uint32_t> began;  ///< Contacts that touch and did not.
  std::vector<std::uint32_t> ended;  ///< Contacts of the state that no longer touch.
  std::vector<ApartContact> apart;   ///< Of which list_touches says whether they are in those.
  std::vector<ContactEvent> events;  ///< Of both, to be told once the tick is made.
  std::vector<Manifold<D>> found;    ///< Of a batch of pairs; empty where shapes are apart.
  HeldPairs<D> held_pairs;           ///< For the next tick.
  ContactRoom<D> room;               ///< Of a chunk: the first contacts are there, and in no list.
};

/// Candidates whose keys lie in one range, for merge_candidates to work in.
struct CandidateRange {
  std::vector<ShapePair> kept;   ///< Old ones, sorted.
  std::vector<ShapePair> fresh;  ///< New ones, sorted.
  std::vector<ShapePair> room;   ///< For sort_pairs.
  std::size_t begin = 0;         ///< Where they begin in the list of all.
  Range places{0, 0};            ///< Of the old ones among all.
  std::uint64_t least = 0;       ///< Key from which on, and below which, they are.
  std::uint64_t above = 0;

  bool has(const ShapePair& pair) const { return pair.key() >= least && pair.key() < above; }
};

/// Everything a step computes and throws away: nothing in here that shows outlives a tick, so
/// nothing in here is state. Lent for a step (step_memory.hpp): what is left in it may be another
/// world's.
template <int D>
struct StepScratch : ContactList<D> {
  KeptByWorld<D>* kept = nullptr;  ///< Of the world whose step it is lent for.
  std::vector<typename BoundsTree<D>::Leaf> leaves;
  std::vector<std::uint32_t> looking;  ///< Shapes that look for their candidates anew.
  std::vector<typename BoundsTree<D>::Leaf> leaving;  ///< Fat boxes of shapes that left theirs.
  std::vector<std::vector<typename BoundsTree<D>::Leaf>> leaving_chunks;
  std::vector<std::vector<std::uint32_t>> slot_chunks;  ///< For whoever lists slots.
  std::vector<std::vector<ShapePair>> pair_chunks;
  std::vector<ShapePair> fresh_candidates;  ///< Of those that look, where one thread merges them.
  std::vector<CandidateRange> candidate_ranges;
  std::size_t used_ranges = 1;                      ///< So many of those.
  std::vector<std::vector<ShapePair>> fresh_parts;  ///< What a chunk found for a range, by both.
  std::size_t fresh_chunks = 0;
  TreeRoom<D> tree_room;
  std::vector<ShapePair> pairs;  ///< Sorted by key.
  std::vector<ContactList<D>> contact_chunks;
  bool contacts_are_all = true;               ///< With those that rest.
  std::vector<Contact<D>> merged_contacts;    ///< For take_in_resting and chunks to work in.
  std::vector<std::uint32_t> contact_places;  ///< By what take_in_resting was given: its new one.
  std::vector<LiveContact<D>> live_before;    ///< Before any woke; and for chunks.

  std::uint32_t bodies_asleep = 0;  ///< Those that took no part as the tick began, and have mass;
                                    ///< later, that do not.

  std::vector<std::uint32_t> islands;    ///< Parent of each body; the root is its lowest slot.
  std::vector<std::uint8_t> kept_awake;  ///< By body: something drives it.
  std::vector<std::uint8_t> island_flags;
  std::vector<std::uint8_t> awake;          ///< By body, and 0 for the resting one of unused lanes.
  std::vector<std::uint32_t> awake_bodies;  ///< Their slots, ascending: alone they move.
  Lots lots;
  std::vector<std::uint32_t> moving_bodies;  ///< Who is awake, lot after lot; who flies is last.
  int flying = 0;                            ///< So many that nothing touches or holds.
  std::vector<std::uint8_t> is_met;          ///< By body, for part_flying, which leaves it 0.

  std::vector<Motion<D>> motions;  ///< By body slot, and one more at rest for unused lanes.
  std::vector<BodyMass<D>> masses;
  std::vector<std::uint32_t> met;            ///< Slots that may not be at rest, or have mass; ...
  bool met_many = false;                     ///< ... not listed: they are a good part of all.
  std::vector<std::uint8_t> inertia_turned;  ///< By body: its mass is of this substep's rotation.
  std::vector<std::uint32_t> used_colors;    ///< Bit set by body slot.
  Colors joint_colors;                       ///< Of live joints.
  std::vector<LiveJoint> live_joints;
  bool colored_joints = false;               ///< joint_coloring is of these, by colour.
  Coloring joint_coloring;                   ///< `order` holds joint slots.
  Coloring contact_coloring;                 ///< `order` holds places of live contacts.
  std::vector<std::uint8_t> sorted_by;       ///< The colours that gave contact_coloring; else none.
  std::vector<JointRow<D>> joint_rows;       ///< In the order of joint_coloring.
  Pins<D> pins;                              ///< Joints that are solved in lanes.
  Coloring single_rows;                      ///< `order` holds the places of all other joint rows.
  std::vector<Motion<D>> saved_motions;      ///< Of pseudo-velocity sweeps and of XPBD's substep.
  std::vector<Motion<D>> predicted_motions;  ///< Of XPBD's substep, before it projects.
  std::vector<JointRow<D>> saved_rows;
  std::vector<JointBlock<D>> tree_blocks;  ///< Of joint_rows, for the tree solver.
  TreeSolver<D> trees;
  IslandSolver<D> islands_solved;
  std::vector<float> tree_wanted;
  std::vector<float> tree_impulses;
  std::vector<FastBody> fast_bodies;  ///< In slot order.
  std::vector<std::vector<FastBody>> fast_chunks;
  std::vector<std::uint32_t> fast_of_shape;  ///< By shape: place in fast_bodies + 1, or 0.
  std::vector<Bounds<D>> ways;               ///< By shape, of those that have one.
  std::vector<WayIs> way_is;                 ///< By shape.
  std::vector<std::uint32_t> straying;       ///< Shapes whose way leaves but the narrow box.
  std::vector<std::uint32_t> searching;      ///< Shapes whose way leaves what their lists are of.
  std::vector<ShapePair> some_pairs;         ///< For list_meetings to work in.
  std::vector<ShapePair> meetings;           ///< Which may meet on the way of a fast body.
  std::vector<float> fractions;              ///< Of meetings: of the tick, at which they do.
  std::vector<Stop> stops;                   ///< Of fast bodies and what is jointed to them.
  std::vector<Stop> coming_stops;            ///< For spread_stops: a line (least_first.hpp).
  std::vector<std::uint32_t> rows_of;        ///< Places of joint rows, by body; the same ...
  std::vector<int> rows_of_ends;             ///< ... and of counting_sort.
  std::vector<std::uint8_t> is_stopped;      ///< By body, for spread_stops, which leaves it 0.
  ParticleScratch<D> particles;
  WorldState<D> before;  ///< Of worlds with particles, to undo a tick that faults.
  ByWidth<ContactBlocks, D> contact_blocks;    ///< Only that of the chosen width is filled.
  std::vector<Acceleration<D>> accelerations;  ///< Of moving_bodies.
  std::uint32_t substeps = 0;                  ///< Of this tick.
  bool slides_far = false;  ///< Some body moves by more than a metre in this tick.
};

}  // namespace cycloid::solver
