#include "solver/lane_widths.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Over the slop, the gap that counts as none. Without it every solve closes gaps of a rounding of
/// the positions, a millimetre per second of noise in each row of a stack, and the next one has to
/// stop what that set going: the pyramids under heavy apexes then cost seven times as much.
static constexpr float kTouchOfSlop = 0.1f;

/// Whether a joint has rows that only sweeps solve.
template <int D>
static bool is_swept(const JointRow<D>& row) {
  return !is_held(row) || row.spring_enabled || row.motor_enabled || row.limit_enabled ||
         has_cone(row);
}

/// Whether a contact has: it bounces, or resists rolling.
template <int D, int W>
static bool is_swept(const ContactBlock<D, W>& block, int lane) {
  return (block.bounces && block.extra->restitution.raw[lane] > 0.0f) ||
         (block.rolls &&
          (block.extra->rolling.raw[lane] > 0.0f || block.extra->twist.raw[lane] > 0.0f));
}

/// The gap of a contact that counts as none. What bounces has to come all the way.
template <int D, int W>
static void set_touch(float touch, int lane, std::size_t place, ContactBlocks<D, W>& contacts) {
  ContactBlock<D, W>& block = contacts.blocks[place];
  if (block.bounces && block.extra->restitution.raw[lane] > 0.0f) return;
  contacts.extra_of(place).touch.raw[lane] = touch;
  block.touches = true;
}

/// Finds the islands whose joints sweeps act on in any case.
template <int D>
static void find_swept_joints(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  const auto sweep = [&](std::uint32_t slot) {
    if (solver.island_of[slot] >= 0)
      solver.islands[static_cast<std::size_t>(solver.island_of[slot])].swept = true;
  };
  for (const JointRow<D>& row : scratch.joint_rows) {
    if (!is_swept(row)) continue;
    sweep(row.body_a);
    sweep(row.body_b);
  }
}

/// Takes what islands hold from the soft sweeps, and says which of their contacts sweeps act on all
/// the same, and which lanes are of no island.
template <int D, int W>
static void take_held(const StepContext<D>& context, StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  auto& contacts = std::get<ContactBlocks<D, W>>(scratch.contact_blocks);
  const float touch = kTouchOfSlop * context.tuning.slop;
  for (std::size_t i = 0; i < solver.held.size(); ++i) {
    const HeldPair& pair = solver.held[i];
    const auto place = static_cast<std::size_t>(pair.place);
    const int at = solver.held_in[i];
    auto* island = at < 0 ? nullptr : &solver.islands[static_cast<std::size_t>(at)];
    const bool is_taken = island != nullptr && island->taken;
    if (pair.lane < 0) {
      JointRow<D>& row = scratch.joint_rows[place];
      if (is_taken) row.in_island = row.solved_directly = true;
      continue;
    }
    ContactBlock<D, W>& block = contacts.blocks[place];
    const LaneBits bit = LaneBits{1} << pair.lane;
    (is_taken ? block.taken : block.left) |= bit;
    if (!is_taken) continue;
    if (is_swept(block, pair.lane)) island->swept = true;
    set_touch(touch, pair.lane, place, contacts);
  }
}

/// Sorts what touches or is jointed into islands, and takes what can be solved at once from the
/// soft sweeps.
///
/// Reads contact blocks, joint rows, masses and motions; writes the island solver, and which
/// contacts and joint rows it takes. Serial.
template <int D, int W>
void prepare_islands(const StepContext<D>& context, Workers& workers, StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  solver.work = {};
  find_loaded<D, W>(context, workers, scratch);
  if (!solver.acts) return;
  solver.matrix.use_lanes(widest_lanes(context.lanes));
  group_islands<D, W>(context, workers, scratch);
  if (!solver.acts) return;
  find_swept_joints(scratch);
  take_held<D, W>(context, scratch);
}

template <int D, int W>
struct InstantiatePlans {
  decltype(&prepare_islands<D, W>) prepare = &prepare_islands<D, W>;
};
template struct AtEveryWidth<InstantiatePlans>;

}  // namespace cycloid::solver
