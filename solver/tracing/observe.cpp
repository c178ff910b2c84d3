#include "solver/step_memory.hpp"
#include "solver/tracing/digest_writer.hpp"
#include "solver/tracing/named_words.hpp"
#include "solver/tracing/tracer.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

const char* phase_name(Phase phase) {
  static constexpr const char* kNames[kPhases] = {
      "forces", "pairs", "collide",  "islands", "colors",    "prepare", "evaluate", "velocities",
      "bounce", "warm",  "sweep",    "pseudo",  "positions", "correct", "relax",    "project",
      "store",  "stop",  "finalize", "rest",    "particles", "state"};
  const auto index = static_cast<std::uint32_t>(phase);
  return index < kPhases ? kNames[index] : "unknown";
}

/// Adds one phase to a trace, object by object.
class PhaseWriter {
 public:
  PhaseWriter(const TracePoint& at, StepTrace& trace)
      : trace_(trace), phase_(trace.phases.emplace_back()) {
    phase_.at = at;
  }

  template <class R>
  void object(const char* kind, std::size_t index, const R& record) {
    DigestWriter write;
    visit_words(record, write);
    const std::uint64_t digest = write.digest();
    all_(static_cast<std::uint64_t>(index));
    all_(digest);
    if (!trace_.wants_objects && trace_.wants_fields.empty()) return;
    std::string name = std::string(kind) + " " + std::to_string(index);
    if (name == trace_.wants_fields)
      for (NamedWord& word : words_of(record))
        phase_.fields.push_back({name, std::move(word.name), std::move(word.text)});
    if (trace_.wants_objects) phase_.objects.push_back({std::move(name), digest});
  }

  void finish() { phase_.digest = all_.digest(); }

 private:
  StepTrace& trace_;
  TracedPhase& phase_;
  DigestWriter all_;
};

template <int D>
static void write_state(const WorldState<D>& state, PhaseWriter& writer) {
  writer.object("world", 0, state.header);
  visit_arrays(state, [&](const char* kind, const auto& array) {
    for (std::size_t i = 0; i < array.size(); ++i) writer.object(kind, i, array[i]);
  });
}

template <int D>
static void write_contacts(const StepScratch<D>& scratch, PhaseWriter& writer) {
  auto live = scratch.live.begin();
  for (std::size_t i = 0; i < scratch.contacts.size(); ++i) {
    ContactFound<D> found;
    found.contact = scratch.contacts[i];
    if (live != scratch.live.end() && live->contact == i) {
      const Manifold<D>& manifold = live->manifold;
      found.normal = manifold.normal;
      for (std::uint32_t p = 0; p < manifold.point_count; ++p) {
        const ManifoldPoint<D>& point = manifold.points[p];
        found.manifold[p] = {point.feature, point.anchor_a, anchor_b_of(point, live->between),
                             point.separation};
      }
      ++live;
    }
    writer.object("contact", i, found);
  }
}

template <int D>
static void write_islands(const StepScratch<D>& scratch, PhaseWriter& writer) {
  for (std::size_t i = 0; i < scratch.islands.size(); ++i)
    writer.object("body", i,
                  BodyIsland{scratch.islands[i], scratch.awake[i], scratch.kept_awake[i]});
}

/// @param slot_of  What an entry of the order stands for.
template <class SlotOf>
static void write_coloring(const char* kind, const Coloring& coloring, SlotOf&& slot_of,
                           PhaseWriter& writer) {
  std::vector<ColorPlace> places;
  const auto write_range = [&](Range range, std::uint32_t color) {
    for (int place = range.begin; place < range.end; ++place) {
      const std::size_t slot =
          slot_of(static_cast<std::size_t>(coloring.order[static_cast<std::size_t>(place)]));
      if (slot >= places.size()) places.resize(slot + 1);
      places[slot] = {color, static_cast<std::uint32_t>(place)};
    }
  };
  for (std::size_t color = 0; color < coloring.colors.size(); ++color)
    write_range(coloring.colors[color], static_cast<std::uint32_t>(color));
  write_range(coloring.overflow, static_cast<std::uint32_t>(coloring.colors.size()));
  for (std::size_t slot = 0; slot < places.size(); ++slot)
    if (places[slot].color != kNone) writer.object(kind, slot, places[slot]);
}

template <int D>
static RowWork<D> work_of(const Row<D>& row) {
  return {row.linear_a, row.angular_a, row.linear_b, row.angular_b, row.error, row.rate};
}

template <int D>
static JointWork<D> work_of(const JointRow<D>& row) {
  JointWork<D> work;
  work.body_a = row.body_a;
  work.body_b = row.body_b;
  for (int i = 0; i < row.rows.count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const int split = row.rows.split;
    work.rows[at] = work_of(row.rows.rows[at]);
    work.inverse_pivot[at] =
        i < split ? row.blocks[0].inverse_pivot[i] : row.blocks[1].inverse_pivot[i - split];
  }
  for (std::size_t i = 0; i < work.impulse.size(); ++i) work.impulse[i] = row.impulse[i];
  if (row.rows.has_axis) {
    work.axis[0] = work_of(row.rows.axis);
    work.axis_mass = row.axis.mass;
    work.motor_mass = row.motor.mass;
  }
  work.spring_impulse = row.spring_impulse;
  work.motor_impulse = row.motor_impulse;
  work.lower_impulse = row.lower_impulse;
  work.upper_impulse = row.upper_impulse;
  Joint<D> joint{};
  store_cone_impulse(row, joint);
  work.cone_impulse = joint.cone_impulse;
  return work;
}

/// Impulses before the velocities that they make, so that the first object that differs is the
/// cause.
template <int D>
static void write_work(const StepScratch<D>& scratch, ReadBlocks<D> read, PhaseWriter& writer) {
  std::vector<JointWork<D>> joints;
  for (const JointRow<D>& row : scratch.joint_rows) {
    if (row.joint >= joints.size()) joints.resize(row.joint + 1);
    joints[row.joint] = work_of(row);
  }
  read_pins(scratch, joints);
  for (std::size_t slot = 0; slot < joints.size(); ++slot)
    if (joints[slot].body_a != kNone) writer.object("joint", slot, joints[slot]);
  std::vector<ContactWork<D>> contacts(scratch.contacts.size());
  read(scratch, contacts);
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (contacts[i].body_a != kNone) writer.object("contact", i, contacts[i]);
  for (std::size_t i = 0; i + 1 < scratch.motions.size(); ++i) {
    const Motion<D>& motion = scratch.motions[i];
    writer.object("body", i,
                  BodyWork<D>{motion.velocity, motion.spin, motion.delta_position,
                              motion.delta_rotation, scratch.masses[i].inverse_inertia});
  }
}

template <int D>
static void write_phase(Phase phase, const WorldState<D>& state, const StepScratch<D>& scratch,
                        ReadBlocks<D> read, PhaseWriter& writer) {
  switch (phase) {
    case Phase::kForces:
    case Phase::kFinalize:
    case Phase::kRest:
    case Phase::kParticles:
    case Phase::kState:
      return write_state(state, writer);
    case Phase::kPairs:
      for (std::size_t i = 0; i < scratch.pairs.size(); ++i)
        writer.object("pair", i, PairFound{scratch.pairs[i].shape_a, scratch.pairs[i].shape_b});
      return;
    case Phase::kIslands:
      write_islands(scratch, writer);
      return write_contacts(scratch, writer);
    case Phase::kCollide:
    case Phase::kStore:
      return write_contacts(scratch, writer);
    case Phase::kColors:
      write_coloring(
          "joint", scratch.joint_coloring, [](std::size_t joint) { return joint; }, writer);
      return write_coloring(
          "contact", scratch.contact_coloring,
          [&](std::size_t place) { return std::size_t{scratch.live[place].contact}; }, writer);
    default:
      return write_work(scratch, read, writer);
  }
}

template <int D>
void observe(const TracePoint& at, const WorldState<D>& state, const StepScratch<D>& scratch,
             ReadBlocks<D> read) {
  if (scratch.kept->trace->listener != nullptr)
    return scratch.kept->trace->listener(scratch.kept->trace->listener_user, at);
  PhaseWriter writer(at, *scratch.kept->trace);
  write_phase(at.phase, state, scratch, read, writer);
  writer.finish();
}

template <int D>
Error World<D>::step_traced(StepTrace& trace) {
  kept_->trace = &trace;
  const Error error = step();
  kept_->trace = nullptr;
  return error;
}

template <int D>
void World<D>::trace_state(StepTrace& trace) const {
  PhaseWriter writer({Phase::kState, kNone, kNone}, trace);
  write_state(state_, writer);
  writer.finish();
}

template void observe(const TracePoint&, const WorldState<2>&, const StepScratch<2>&,
                      ReadBlocks<2>);
template void observe(const TracePoint&, const WorldState<3>&, const StepScratch<3>&,
                      ReadBlocks<3>);
template Error World<2>::step_traced(StepTrace&);
template Error World<3>::step_traced(StepTrace&);
template void World<2>::trace_state(StepTrace&) const;
template void World<3>::trace_state(StepTrace&) const;

}  // namespace cycloid::solver
