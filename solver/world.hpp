#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "solver/arithmetic.hpp"
#include "solver/definitions.hpp"
#include "solver/result.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

class Workers;
template <int D>
struct KeptByWorld;
template <int D>
struct StepMemory;
struct StepTrace;
template <int D>
struct JointFrame;
template <int D>
struct JointRows;
/// See constraints/rows.hpp.
template <int D>
using RowsFunction = void (*)(const JointFrame<D>& frame, JointRows<D>& rows);

/// What the last step did; not part of the state.
struct Statistics {
  std::uint32_t bodies = 0;
  std::uint32_t pairs = 0;     ///< Pairs whose bounds overlap.
  std::uint32_t contacts = 0;  ///< Pairs with at least one contact point.
  std::uint32_t colors = 0;
  std::uint32_t substeps = 0;  ///< Taken: fewer than asked for where islands at once have all.
  std::uint32_t rows_per_sweep = 0;
  std::uint32_t turning_rows_per_sweep = 0;  ///< Contact rows with an angular part.
  std::uint32_t direct_rows = 0;             ///< Joint rows that the tree solver solves at once.
  std::uint32_t asleep = 0;                  ///< Bodies that were left alone.
  std::uint64_t rows = 0;  ///< Rows solved in the step, all sweeps together; with the products
                           ///< of blocks where islands are solved at once.
  std::uint32_t lots = 1;  ///< Groups of islands that were solved apart. Depends on what a step is
                           ///< asked for and has done before, and so on more than the state.
  std::uint32_t flying = 0;  ///< Bodies that were moved at once for all substeps, because nothing
                             ///< touched or held them; 0 where they are few, or someone looks on.
};

/// A body as a user sees it: the pose of its frame, not of its centre of mass.
template <int D>
struct BodyView {
  BodyId id;
  BodyKind kind = BodyKind::kFree;
  Vec<D> position = Vec<D>::zero();  ///< m, world.
  Rotation<D> rotation = identity_rotation<D>();
  Vec<D> velocity = Vec<D>::zero();  ///< Of the centre of mass, m/s.
  Spin<D> spin = Spin<D>::zero();
  float mass = 0.0f;
  std::uint64_t tag = 0;
};

/// A rigid-body world: a pure function of its definition and of the calls made on it.
///
/// SI units (m, kg, s, rad); world frame unless a name says otherwise. The same definition and
/// the same calls in the same order give the same bits on every supported target; worker count
/// and lane width are invisible. docs/determinism.md says how, and which test proves it. Calls
/// that fail return an `Error` that names the field, and have changed nothing. Not thread-safe.
template <int D>
class World {
 public:
  /// Fails with kInvalid or kCapacity on a bad definition; with field "floating_point_mode" where
  /// the thread rounds other than to nearest or flushes subnormals; and with "floating_point_flags"
  /// where the caller or the solver was compiled with flags that fuse or reorder operations.
  /// Inlined, so that it is the caller's own flags that are looked at.
  [[gnu::always_inline]] static Result<World> create(const WorldDef<D>& def) {
    return create(def, rounds_as_written());
  }
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  /// How many threads take part in a step, this one included: 1 to 64. Changes no bit. New threads
  /// inherit the mode of this one: kInvalid "floating_point_mode" as for `create`.
  Error set_workers(int workers);
  /// Lets steps be taken by the calling thread alone while the others of `set_workers` rest, or by
  /// all again. Changes no bit. @pre no step runs.
  void rest_workers(bool rests);
  /// Lets steps work in this memory, which many worlds may share, on any threads: each step takes
  /// a piece of it for its time, or makes one. So idle worlds have none. Changes no bit.
  /// @pre `memory` is of make_step_memory, and no step runs.
  void use_step_memory(std::shared_ptr<StepMemory<D>> memory) { step_memory_ = std::move(memory); }
  /// Gives back the memory that the state does not fill. Changes no bit.
  void trim();
  /// How many contacts one instruction solves: 1, 4, 8 or 16, or the most below that for which the
  /// processor has vectors, of 8 with AVX2, of 16 with AVX-512; 0, as at first, leaves the choice
  /// to each step, by the contacts that there are. Else kInvalid "lanes". Changes no bit.
  Error set_lanes(int lanes);
  /// Of how many contacts are solved together, from the first substep of a step to the last, before
  /// or beside others that they do not touch: 1 and more; 0, as at first, leaves the choice to each
  /// step. Changes no bit.
  void set_lot_contacts(std::uint32_t contacts) { lot_contacts_ = contacts; }

  /// Advances one tick: `tuning.substeps` substeps of tick_s / substeps; under kLoadedIsland half
  /// or a quarter as many where islands are solved at once that have all that moves.
  ///
  /// Forces and torques apply for this tick and are cleared. When a value would leave the finite,
  /// bounded range, nothing is committed: the world keeps the state of the tick before, enters the
  /// fault state (`fault()`), and this and every later step returns kFaulted. On a thread that
  /// rounds otherwise or flushes subnormals: kInvalid "floating_point_mode", and nothing changes.
  Error step();
  /// `step`, and to `trace.phases` what each phase has left: up to where it failed, if it does.
  /// Changes no bit of the step. See trace.hpp.
  Error step_traced(StepTrace& trace);
  /// Adds the state as it is now, as one phase kState.
  void trace_state(StepTrace& trace) const;

  Result<BodyId> create_body(const BodyDef<D>& def, std::span<const ShapeDef<D>> shapes);
  /// Also removes the joints and pins of the body; its contacts end with the next step.
  Error destroy_body(BodyId id);
  Result<JointId> create_joint(const JointDef<D>& def);
  Error destroy_joint(JointId id);
  /// Makes kUser joints of this number possible. Not part of the state: register the same functions
  /// in every process, before the first joint, restore or step; a step with a kind that is missing
  /// returns kInvalid "user_kind" and changes nothing.
  void register_constraint(std::uint32_t user_kind, RowsFunction<D> function);

  Result<ParticleId> create_particle(const ParticleDef<D>& def);
  /// Also removes its links and pins.
  Error destroy_particle(ParticleId id);
  Result<LinkId> create_link(const LinkDef& def);
  Error destroy_link(LinkId id);
  Result<PinId> create_pin(const PinDef<D>& def);
  Error destroy_pin(PinId id);

  /// At the centre of mass, in the coming tick. A body without mass does not answer.
  Error apply_force(BodyId id, const Vec<D>& force_n);
  Error apply_torque(BodyId id, const Spin<D>& torque_n_m);
  Error apply_impulse(BodyId id, const Vec<D>& impulse_n_s);
  Error apply_angular_impulse(BodyId id, const Spin<D>& impulse_n_m_s);
  Error set_velocity(BodyId id, const Vec<D>& velocity, const Spin<D>& spin);
  Error set_pose(BodyId id, const Vec<D>& position, const Rotation<D>& rotation);
  Error set_gravity(const Vec<D>& gravity);
  Error set_gravity_scale(BodyId id, float scale);
  Error set_damping(BodyId id, float linear, float angular);
  Error set_mass(BodyId id, float mass_kg);  ///< Scales the inertia with it.
  Error set_material(std::uint32_t material, const Material& values);
  Error set_filter(BodyId id, std::uint32_t shape, const Filter& filter);
  /// @param max  N m or N.
  Error set_motor(JointId id, bool enabled, float speed, float max);
  /// A position motor: holds the coordinate at `target` [rad or m] with at most `max`; an angle by
  /// the shorter way round, as MotorKind says.
  Error set_target(JointId id, float target, float max);
  /// The angle [rad, |.| <= 1.6] by which a wheel in space is turned about its suspension.
  Error set_steering(JointId id, float angle);
  /// Where on body a the joint holds on, in the frame of that body; moves the point of a mouse.
  Error set_anchor(JointId id, const Vec<D>& anchor_a);
  Error set_limits(JointId id, bool enabled, float lower, float upper);
  Error set_spring(JointId id, float length, float hertz, float damping_ratio);
  Error set_tuning(const Tuning& tuning);

  /// Words of the host that belong to the state: saved, encoded and hashed with it. What a host
  /// decides from tick to tick (the last buttons of a seat, a spawn queue) lives here, or a
  /// restored world would go another way.
  std::span<const std::uint32_t> registers() const { return state_.registers; }
  Error resize_registers(std::uint32_t count);
  Error set_register(std::uint32_t index, std::uint32_t value);

  std::uint64_t tick() const { return state_.header.tick; }
  float tick_s() const { return state_.header.tick_s; }
  const Tuning& tuning() const { return state_.header.tuning; }
  std::optional<Fault> fault() const;

  bool contains(BodyId id) const;
  std::uint32_t body_count() const;
  Result<BodyView<D>> body(BodyId id) const;
  /// Live bodies in the order of their slots.
  std::vector<BodyView<D>> bodies() const;
  /// Angle of b relative to a since creation, rad in (-pi, pi]. 2D: revolute joints, 3D: hinges.
  Result<float> joint_angle(JointId id) const;
  /// Distance between the two anchors, m.
  Result<float> joint_separation(JointId id) const;

  /// Of the last step: first all that ended, then all that began, each in the order of the shapes'
  /// slots; before them what calls have ended since the step before, in the order of the calls.
  /// Events are no part of the state: who restores it hears of nothing that came before.
  std::span<const ContactEvent> contact_events() const { return events_; }
  const Statistics& statistics() const { return statistics_; }

  /// 64 bits over all that the future depends on: XXH3 of the canonical encoding with -0 and every
  /// NaN made one. Unequal digests prove unequal worlds.
  std::uint64_t digest() const;

  /// The whole state; a copy of flat arrays. `restore` brings back every bit.
  const WorldState<D>& state() const { return state_; }
  void save(WorldState<D>& into) const { into = state_; }
  /// @pre `from` was saved from a world of this dimension. Events and statistics are cleared.
  void restore(const WorldState<D>& from);

  /// The exact state as little-endian bytes, independent of layout and platform.
  void encode(std::vector<std::byte>& into) const;
  /// Replaces the state. kCorrupt, and nothing has changed, unless the bytes are such an encoding:
  /// sizes are checked before anything is allocated, and every index, number and list is verified.
  Error decode(std::span<const std::byte> bytes);

 private:
  World();
  static Result<World> create(const WorldDef<D>& def, bool caller_rounds_as_written);
  Error step_in_lanes();
  Error step_in_one_lane();
  Error check(BodyId id) const;
  /// The body, of which the next step asks whether it takes part. @pre check(id).
  BodyMotion<D>& touched(BodyId id);
  Error check(JointId id) const;

  WorldState<D> state_;
  std::vector<ContactEvent> events_;
  std::vector<ContactEvent> ended_;  ///< By destroy_body since the last step; reported by the next.
  Statistics statistics_;
  int lanes_ = 0;
  std::uint32_t lot_contacts_ = 0;
  std::unique_ptr<Workers> workers_;
  std::unique_ptr<KeptByWorld<D>> kept_;
  std::shared_ptr<StepMemory<D>> step_memory_;
};

/// What `use_step_memory` takes. It grows to what the largest world on it needs, once for each
/// thread that steps at the same time, and goes with the last of them.
template <int D>
std::shared_ptr<StepMemory<D>> make_step_memory();

/// One value that differs between two states.
struct Difference {
  std::string object;   ///< "body 3", "joint 0", "contact 7", "shape 2", "world", ...
  std::string field;    ///< "velocity[1]"
  std::string value_a;  ///< Decimal, and the bits in hexadecimal.
  std::string value_b;
};

/// The first `limit` differing fields of two states, in canonical order; empty when equal to the
/// bit.
template <int D>
std::vector<Difference> differences(const WorldState<D>& a, const WorldState<D>& b,
                                    std::size_t limit);

}  // namespace cycloid::solver
