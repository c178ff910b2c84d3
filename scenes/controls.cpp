#include "scenes/controls.hpp"

#include "scenes/characters.hpp"

namespace cycloid::scenes {

/// Whether a refused call may be passed over: the world is full, or the target is gone. Both are
/// part of the state, so every machine passes over the same calls.
static void allow(const solver::Error&) {}

/// -1 to 1; the one value without a counterpart counts as its neighbour.
static float axis_value(const SeatInput& input, std::uint32_t index) {
  const std::int16_t raw = input.axes[index];
  const std::int16_t symmetric = raw == -32768 ? std::int16_t{-32767} : raw;
  return static_cast<float>(symmetric) / 32767.0f;
}

static float level(const Control& control, const SeatInput& input) {
  if (control.source == Source::kAxis) return axis_value(input, control.index);
  return (input.buttons >> control.index & 1u) != 0 ? 1.0f : 0.0f;
}

template <int D>
static solver::Vec<D> scaled(const Triple& value, float by) {
  solver::Vec<D> result;
  for (int i = 0; i < D; ++i) result[i] = by * value[static_cast<std::size_t>(i)];
  return result;
}

template <int D>
static solver::Vec<D> directed(const solver::World<D>& world, const BoundControl& bound, float by) {
  const solver::Vec<D> value = scaled<D>(bound.control.value, by);
  if (bound.control.frame == Frame::kWorld) return value;
  const solver::Result<solver::BodyView<D>> body = world.body(bound.body);
  return body.ok() ? solver::rotate(body.value().rotation, value) : value;
}

template <int D>
static solver::Spin<D> turning(const Triple& value, float by) {
  solver::Spin<D> result;
  for (int i = 0; i < solver::Dim<D>::kSpin; ++i)
    result[i] = by * value[static_cast<std::size_t>(i)];
  return result;
}

/// The spawn list of a control: a ring of `limit` places, each the id of a body or empty. The body
/// in the next place is the oldest; it makes room.
template <int D>
static void spawn(Built<D>& built, const BoundControl& bound) {
  solver::World<D>& world = built.world;
  const std::uint32_t first = bound.first_register;
  const std::uint32_t place = world.registers()[first];
  const std::uint32_t at = first + 1 + 2 * place;
  const solver::BodyId oldest{world.registers()[at] - 1, world.registers()[at + 1]};
  if (world.registers()[at] != 0) allow(world.destroy_body(oldest));

  const Prefab<D>& prefab = built.prefabs[bound.prefab];
  solver::BodyDef<D> def = prefab.body;
  def.position = scaled<D>(bound.control.position, 1.0f);
  def.velocity = scaled<D>(bound.control.velocity, 1.0f);
  const solver::Result<solver::BodyId> id = world.create_body(def, prefab.shapes);
  allow(world.set_register(at, id.ok() ? id.value().index + 1 : 0));
  allow(world.set_register(at + 1, id.ok() ? id.value().generation : 0));
  allow(world.set_register(first, (place + 1) % bound.control.limit));
}

template <int D>
static void apply(Built<D>& built, const BoundControl& bound, float amount, bool pressed,
                  std::vector<CharacterWish<D>>& wishes) {
  solver::World<D>& world = built.world;
  switch (bound.control.effect) {
    case Effect::kForce:
      if (amount != 0.0f) allow(world.apply_force(bound.body, directed(world, bound, amount)));
      break;
    case Effect::kTorque:
      if (amount != 0.0f)
        allow(world.apply_torque(bound.body, turning<D>(bound.control.value, amount)));
      break;
    case Effect::kMotorSpeed:
      allow(world.set_motor(bound.joint, true, amount * bound.control.value[0], bound.motor_max));
      break;
    case Effect::kSteering:
      allow(world.set_steering(bound.joint, amount * bound.control.value[0]));
      break;
    case Effect::kImpulse:
      if (pressed) allow(world.apply_impulse(bound.body, directed(world, bound, 1.0f)));
      break;
    case Effect::kSpawn:
      if (pressed) spawn(built, bound);
      break;
    case Effect::kWalk:
      wishes[bound.character].walk += scaled<D>(bound.control.value, amount);
      break;
    case Effect::kJump:
      if (pressed) wishes[bound.character].jump = true;
      break;
    default:
      break;
  }
}

template <int D>
void apply_controls(Built<D>& built, std::span<const SeatInput> inputs) {
  std::vector<CharacterWish<D>> wishes(built.characters.size());
  for (std::uint32_t seat = 0; seat < inputs.size(); ++seat) {
    const std::uint32_t before = built.world.registers()[seat];
    const std::uint32_t now = inputs[seat].buttons;
    for (const BoundControl& bound : built.seats[seat].controls) {
      const std::uint32_t bit = 1u << (bound.control.index & 15u);
      const bool pressed = bound.control.source == Source::kButton && (now & ~before & bit) != 0;
      apply(built, bound, level(bound.control, inputs[seat]), pressed, wishes);
    }
    allow(built.world.set_register(seat, now));
  }
  move_characters<D>(built, wishes);
}

template void apply_controls(Built<2>&, std::span<const SeatInput>);
template void apply_controls(Built<3>&, std::span<const SeatInput>);

}  // namespace cycloid::scenes
