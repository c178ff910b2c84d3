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

/// Finds the islands that sweeps act on in any case, and the lanes of no island.
template <int D, int W>
static void find_swept(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  const auto sweep = [&](std::uint32_t slot) {
    if (solver.island_of[slot] >= 0)
      solver.islands[static_cast<std::size_t>(solver.island_of[slot])].swept = true;
  };
  for (const JointRow<D>& row : scratch.joint_rows) {
    if (!is_swept(row)) continue;
    sweep(row.body_a);
    sweep(row.body_b);
  }
  for (std::size_t i = 0; i < solver.held.size(); ++i) {
    const HeldPair& pair = solver.held[i];
    if (pair.lane < 0) break;
    auto& block = blocks[static_cast<std::size_t>(pair.place)];
    const int at = solver.held_in[i];
    if (at < 0 || !solver.islands[static_cast<std::size_t>(at)].taken) {
      block.left |= LaneBits{1} << pair.lane;
      continue;
    }
    block.taken |= LaneBits{1} << pair.lane;
    if (is_swept(block, pair.lane)) solver.islands[static_cast<std::size_t>(at)].swept = true;
  }
}

/// The gap of a contact that counts as none. What bounces has to come all the way.
template <int D, int W>
static void set_touch(float touch, int lane, std::size_t place, ContactBlocks<D, W>& contacts) {
  ContactBlock<D, W>& block = contacts.blocks[place];
  if (block.bounces && block.extra->restitution.raw[lane] > 0.0f) return;
  contacts.extra_of(place).touch.raw[lane] = touch;
  block.touches = true;
}

/// Takes what islands hold from the soft sweeps.
template <int D, int W>
static void take_rows(const StepContext<D>& context, StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  auto& contacts = std::get<ContactBlocks<D, W>>(scratch.contact_blocks);
  const float touch = kTouchOfSlop * context.tuning.slop;
  for (std::size_t i = 0; i < solver.held.size(); ++i) {
    const int at = solver.held_in[i];
    if (at < 0 || !solver.islands[static_cast<std::size_t>(at)].taken) continue;
    const HeldPair& pair = solver.held[i];
    const auto place = static_cast<std::size_t>(pair.place);
    if (pair.lane >= 0) {
      set_touch(touch, pair.lane, place, contacts);
      continue;
    }
    scratch.joint_rows[place].in_island = true;
    scratch.joint_rows[place].solved_directly = true;
  }
}

/// Sorts what touches or is jointed into islands, and takes what can be solved at once from the
/// soft sweeps.
///
/// Reads contact blocks, joint rows and masses; writes the island solver, and which contacts and
/// joint rows it takes. Serial.
template <int D, int W>
void prepare_islands(const StepContext<D>& context, Workers& workers, StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  solver.work = {};
  find_loaded<D, W>(context, workers, scratch);
  if (!solver.acts) return;
  solver.matrix.use_lanes(widest_lanes(context.lanes));
  group_islands<D, W>(context, workers, scratch);
  if (!solver.acts) return;
  find_swept<D, W>(scratch);
  take_rows<D, W>(context, scratch);
}

template <int D, int W>
struct InstantiatePlans {
  decltype(&prepare_islands<D, W>) prepare = &prepare_islands<D, W>;
};
template struct AtEveryWidth<InstantiatePlans>;

}  // namespace cycloid::solver
